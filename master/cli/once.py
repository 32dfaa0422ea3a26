"""Options that take one value, refused where they are given several: the last would win without a word."""

from __future__ import annotations

import copy
from typing import Any

from typer.core import TyperCommand


class OnceCommand(TyperCommand):
    """A verb of which each option is given once, but those that collect values, such as `--set`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the arguments. Raises a usage error naming an option that is given twice, and its values."""
        if not ctx.resilient_parsing:  # Tab completes a line that is not whole
            self._check_once(ctx, args)
        return super().parse_args(ctx, args)

    def _check_once(self, ctx: Any, args: list[str]) -> None:
        """Parse once more, with every option collecting its values."""
        parser = self.make_parser(ctx)
        once = [option for option in self.get_params(ctx) if takes_one_value(option)]
        for option in once:
            several: Any = copy.copy(option)
            several.multiple = True
            several.add_to_parser(parser, ctx)  # in place of the one of this name
        given: dict[str, Any] = parser.parse_args(args=list(args))[0]
        for option in once:
            values = given.get(option.name or "", [])
            if len(values) > 1:
                name = max(option.opts, key=len)
                first, second = (value if isinstance(value, str) else "" for value in values[:2])
                ctx.fail(f"{name} {second}: it is given already: {name} {first}; it takes one value")


def takes_one_value(option: Any) -> bool:
    """Return True for an option with a value, of which another one would count in its place."""
    return option.param_type_name == "option" and not (option.is_flag or option.multiple or option.count)
