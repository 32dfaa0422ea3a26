"""Shell completion: `--install-completion`, `--show-completion`, and the names that the Tab key offers.

At each press of the key a script of typer's starts `evcosim` with the line so far in its environment. Names
therefore come from file names, the catalog and plain TOML, not from validated files.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer

from ...cosim.visible import on_one_line

VARIABLE = "_EVCOSIM_COMPLETE"
"""The environment variable by which a shell requests completions."""

_SHELLS = ("bash", "zsh", "fish", "powershell", "pwsh")
_START_FILES = {"bash": ".bashrc", "zsh": ".zshrc"}  # to which typer adds lines; the script stands elsewhere
_DETECTED = "detected"  # the value of an option that names no shell
_DATA = Path(__file__).parents[2] / "cosim" / "data"


# ---- the options


def with_shell(arguments: Sequence[str]) -> list[str]:
    """Return the arguments; one of the two options that ends the line is given the value `detected`."""
    named = not arguments or arguments[-1] not in ("--install-completion", "--show-completion")
    return [*arguments] if named else [*arguments, _DETECTED]


def install(context: typer.Context, wanted: str | None) -> None:
    """Set completion up in the shell's own start files and end. Raises ConfigError for an unknown shell."""
    if wanted is None or context.resilient_parsing:
        return
    shell, path = _typer().install(shell=_shell(wanted), prog_name="evcosim", complete_var=VARIABLE)
    edited = f"; {Path.home() / _START_FILES[shell]} was edited to read it" if shell in _START_FILES else ""
    typer.echo(f"{path}: completion for {shell}, from its next start on{edited}")
    raise typer.Exit


def show(context: typer.Context, wanted: str | None) -> None:
    """Print the script for a shell and end. Raises ConfigError for an unknown shell."""
    if wanted is None or context.resilient_parsing:
        return
    shell = _shell(wanted)
    typer.echo(_typer().get_completion_script(prog_name="evcosim", complete_var=VARIABLE, shell=shell))
    raise typer.Exit


def _shell(wanted: str) -> str:
    from ...cosim.errors import ConfigError

    shell = _detected() if wanted == _DETECTED else wanted
    if shell not in _SHELLS:
        problem = f"'{shell}' is no shell that can be set up" if shell else "the shell is not known"
        raise ConfigError(f"completion: {problem}; name one of them: {', '.join(_SHELLS)}")
    return shell


def _detected() -> str:
    """The shell that this command was started from; "" where that is none."""
    import shellingham

    try:
        return str(shellingham.detect_shell()[0])
    except shellingham.ShellDetectionFailure:
        return ""


def completed(command: Any, instruction: str) -> int:
    """Print what the shell requests by `instruction` ("complete_bash") and return the exit code."""
    module = _typer()
    module.completion_init()
    return int(module.shell_complete(command, {}, "evcosim", VARIABLE, instruction))


def _typer() -> Any:
    """Return typer's own module, which exports none of what is taken from it (test_private_names)."""
    from typer import completion

    return completion


# ---- names


def systems() -> list[str]:
    """Return the names of the built-in systems."""
    return sorted(path.stem for path in (_DATA / "systems").glob("*.toml"))


def fmus() -> list[str]:
    """Return the names of the built-in FMUs."""
    from ..builtin import builtin_names

    return sorted(builtin_names())


def systems_and_fmus() -> list[str]:
    """Return both."""
    return [*systems(), *fmus()]


def scenarios(ctx: typer.Context) -> list[str]:
    """Return the scenarios of the system that the line names; of every system where it names none yet."""
    # behind an option without its value yet, what stands before it is in `args`
    words = [ctx.params.get("system"), ctx.params.get("target"), *ctx.args]
    named = next((word for word in words if word and not word.startswith("-")), None)
    folders = [f for name in systems() for f in _folders(name)] if named is None else _folders(named)
    names = {file.stem for folder in folders for file in folder.glob("*.toml")}
    return sorted(name for name in names if on_one_line(name) == name)


def _folders(system: str) -> list[Path]:
    """The folders of a system's scenarios, as `System.scenario_folders`; none of an unknown or broken one."""
    import tomllib

    if system in systems():
        return [_DATA / "scenarios" / system]
    try:
        name = tomllib.loads(Path(system).read_text(encoding="utf-8"))["name"]
        return [root / "scenarios" / name for root in (Path(system).parent, _DATA)]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):  # no file, no TOML, no name, no text
        return []


def places() -> list[str]:
    """Return SYSTEM.UNIT for each unit of the built-in systems."""
    import tomllib

    found = []
    for name in systems():
        text = (_DATA / "systems" / f"{name}.toml").read_text(encoding="utf-8")
        found += [f"{name}.{unit}" for unit in tomllib.loads(text)["units"]]
    return found
