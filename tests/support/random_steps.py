"""Random steps of a model: statements over floats, whole numbers, truth values, tuples and a list."""

from __future__ import annotations

import random

ABOVE = """
TABLE = (0.5, -1.0, 2.0)


class Pair(NamedTuple):
    a: float
    b: float


def first(x, y):
    if x > y:
        return x - y
    return x * 0.5


def divided(x, y):
    return x / y


def counted(n, x):
    s = 0.0
    for i in range(n % 4):
        s += x * i
    return s


def pair(x, n):
    return Pair(x * 0.5, x - n)


def changed(m, x):
    m[1] = x
    return m[0]
"""

FLOATS, WHOLE, TRUTHS = ("a", "b", "c"), ("i", "j"), ("on",)


class Writer:
    """A step that is being written."""

    def __init__(self, seed: int) -> None:
        self.draw = random.Random(seed)
        self.lines: list[str] = []
        self.loops = 0

    def text(self) -> str:
        """Return the step."""
        self.lines = [
            "a, b, c = u.u, u.v, x.x",
            "i, j, on = u.k, p.n, u.flag",
            "m = [u.u, 1.0, u.v, 0.5]",
            "q = pair(a, j)",
        ]
        for _ in range(self.draw.randint(4, 10)):
            self.statement(0)
        self.lines.append("return Small.State(bounded(a + b * 0.25 - c), bounded_whole(i - j), on)")
        return "\n".join(self.lines)

    def put(self, depth: int, line: str) -> None:
        """Write a line."""
        self.lines.append("    " * depth + line)

    def statement(self, depth: int) -> None:
        """Write a statement."""
        kind = self.draw.random()
        if kind < 0.35 or depth > 2:
            self.assignment(depth)
        elif kind < 0.55:
            self.put(depth, f"if {self.truth()}:")
            self.block(depth + 1)
            if self.draw.random() < 0.6:
                self.put(depth, f"elif {self.truth()}:" if self.draw.random() < 0.3 else "else:")
                self.block(depth + 1)
        elif kind < 0.7:
            bounds = self.draw.choice(["3", "1, 4", "2, -1, -1", f"{self.draw.choice(WHOLE)} % 4"])
            self.loops += 1
            self.put(depth, f"for k{self.loops} in range({bounds}):")
            self.in_loop(depth + 1, f"k{self.loops}")
        elif kind < 0.78:
            self.loops += 1
            self.put(depth, f"n{self.loops} = 0")
            self.put(depth, f"while n{self.loops} < 4 and {self.truth()}:")
            self.put(depth + 1, f"n{self.loops} += 1")
            self.in_loop(depth + 1, f"n{self.loops}")
        else:
            self.special(depth)

    def in_loop(self, depth: int, counter: str) -> None:
        """Write the body of a loop."""
        self.block(depth)
        if self.draw.random() < 0.5:
            self.put(depth, f"if {self.truth()}:")
            self.put(depth + 1, self.draw.choice(["break", "continue"]))
            self.assignment(depth)
        self.put(depth, f"{self.draw.choice(FLOATS)} += {counter} * 0.25")
        self.put(depth, f"m[{counter} % 4] -= {self.number(2)}")

    def block(self, depth: int) -> None:
        """Write a block."""
        for _ in range(self.draw.randint(1, 3)):
            self.statement(depth)

    def assignment(self, depth: int) -> None:
        """Write an assignment."""
        kind = self.draw.random()
        name = self.draw.choice(FLOATS)
        if kind < 0.4:
            self.put(depth, f"{name} = {self.number()}")
        elif kind < 0.55:
            self.put(depth, f"{name} {self.draw.choice(['+=', '-=', '*='])} {self.number()}")
        elif kind < 0.75:
            self.put(depth, f"{self.draw.choice(WHOLE)} = ({self.whole()}) % 1000")
        elif kind < 0.9:
            self.put(depth, f"on = {self.truth()}")
        else:
            other = self.draw.choice(FLOATS)
            self.put(depth, f"{name}, {other} = {self.number()}, {self.number()}")

    def special(self, depth: int) -> None:
        """Write a statement with tuples, lists, or a failure."""
        name = self.draw.choice(FLOATS)
        self.put(
            depth,
            self.draw.choice(
                [
                    f"q = pair({self.number()}, {self.whole()} % 50)",
                    f"{name} = q.a + q[1]",
                    f"a, b = b, {self.number()}",
                    f"m[{self.whole()} % 4] = {self.number()}",
                    f"{name} = m[{self.whole()} % 4] + changed(m, {self.number()}) + m[1]",
                    f"{name} = TABLE[{self.whole()} % 3]",
                    f"(a, b), i = (c, {self.number()}), {self.whole()} % 7",
                    f"{name} = divided({self.number()}, {self.number()})",
                    f"if {self.number()} > 1e4:\n"
                    + "    " * (depth + 1)
                    + f"raise ValueError(f'{{{name}}} at {{i}} {{{self.number(2)}:.3g}}')",
                ]
            ),
        )

    def number(self, depth: int = 0) -> str:
        """Return an expression that is a float."""
        kind = self.draw.random()
        if kind < 0.35 or depth > 2:
            return self.draw.choice([*FLOATS, "0.5", "u.v", "p.a", "q.b", "m[2]", "x.x", "-1.5"])
        left, right = self.number(depth + 1), self.number(depth + 1)
        if kind < 0.65:
            return f"({left} {self.draw.choice('+-*')} {right})"
        return self.draw.choice(
            [
                f"({left} / {right})",
                f"({left} % {right})",
                f"min({left}, {right})",
                f"max({left}, {right}, 0.0)",
                f"abs({left})",
                f"({left} if {self.truth(depth + 1)} else {right})",
                f"first({left}, {right})",
                f"counted({self.whole(depth + 1)}, {left})",
                f"sqrt(abs({left}))",
                f"({left} * ({self.whole(depth + 1)} % 10))",
                f"float({self.whole(depth + 1)} % 10)",
                f"m[{self.whole(depth + 1)} % 4]",
            ]
        )

    def whole(self, depth: int = 0) -> str:
        """Return an expression that is a whole number."""
        kind = self.draw.random()
        if kind < 0.4 or depth > 2:
            return self.draw.choice([*WHOLE, "3", "u.k", "p.n"])
        left, right = self.whole(depth + 1), self.whole(depth + 1)
        if kind < 0.7:
            return f"({left} {self.draw.choice('+-')} {right})"
        return self.draw.choice(
            [
                f"({left} // {right})",
                f"min({left}, {right})",
                f"({left} if {self.truth(depth + 1)} else {right})",
                f"abs({left})",
                f"(on + {left})",
                f"floor(min(1e3, max(-1e3, {self.number(depth + 1)})))",
            ]
        )

    def truth(self, depth: int = 0) -> str:
        """Return an expression that is true or false."""
        kind = self.draw.random()
        if kind < 0.2 or depth > 2:
            return self.draw.choice([*TRUTHS, "u.flag", "p.on"])
        sign = self.draw.choice(["<", "<=", ">", ">=", "==", "!="])
        if kind < 0.5:
            return f"({self.number(depth + 1)} {sign} {self.number(depth + 1)})"
        if kind < 0.65:
            return f"({self.whole(depth + 1)} {sign} {self.whole(depth + 1)})"
        if kind < 0.75:
            return f"(not {self.truth(depth + 1)})"
        if kind < 0.85:
            return f"({self.number(depth + 1)} < {self.number(depth + 1)} <= {self.number(depth + 1)})"
        return f"({self.truth(depth + 1)} {self.draw.choice(['and', 'or'])} {self.truth(depth + 1)})"


BOUNDS = """

def bounded(x):
    return min(1e3, max(-1e3, x))


def bounded_whole(n):
    return n % 1000
"""


def random_step(seed: int) -> tuple[str, str]:
    """Return a step and what stands above its model."""
    return Writer(seed).text(), ABOVE + BOUNDS
