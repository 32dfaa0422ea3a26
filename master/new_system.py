"""A folder with a system of one's own: a small example, or the files of a built-in system to be changed."""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from ..cosim.errors import ConfigError, nearest
from ..cosim.system.scenario import load_scenario, scenario_names
from ..cosim.system.system import System, load_system, system_names
from ..cosim.system.toml import DATA, data_file
from ..cosim.writing import reason, write_text
from .builtin import build_models, builtin_names, model_source

_TEMPLATE = DATA / "new"
_FMU = re.compile(r'^(\s*fmu\s*=\s*)"(\w+)"', re.MULTILINE)
_COMMANDS = re.compile(r"(?<=^```sh\n).*?(?=\n```$)", re.DOTALL | re.MULTILINE)
_NAME = re.compile(r'^name = ".*"$', re.MULTILINE)


def new_system(folder: Path, base: str | None = None) -> list[str]:
    """Make a folder with a system that runs, and return the names of its files, below the folder.

    `base` is the built-in system whose files it gets (None: a small example). Its name is that of the
    folder. Raises ConfigError for a folder that is there, a name that no system can have, an unknown system,
    and where nothing can be written; then there is no folder.
    """
    name = _checked(folder, base)
    draft: Path | None = None
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(prefix=f".{name}-", dir=folder.parent))
        draft.chmod(0o755)
        for path, text in _example(name) if base is None else _copy(name, load_system(base)):
            (draft / path).parent.mkdir(parents=True, exist_ok=True)
            write_text(draft / path, text)
        for model in sorted((draft / "models").glob("*.py")):
            build_models(model)
        draft.rename(folder)
    except OSError as error:
        raise ConfigError(f"{folder}: cannot be made: {reason(folder, error)}") from error
    except ConfigError as error:  # of a file of the draft, which nobody knows
        raise ConfigError(*(line.replace(str(draft), str(folder)) for line in error.lines)) from error
    finally:
        if draft is not None:
            shutil.rmtree(draft, ignore_errors=True)
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def _checked(folder: Path, base: str | None) -> str:
    """Return the name of the system in a folder that is to be made. Raises ConfigError."""
    name, known = folder.resolve().name, system_names()
    if not (name.isidentifier() and name.isascii()):
        plain = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")
        hint = f", as in {plain}" if plain.isidentifier() and plain != name else ""
        raise ConfigError(f"{folder}: a system's name is made of letters, digits and '_'{hint}")
    if name in known:
        raise ConfigError(f"{folder}: {name} is the name of a built-in system: choose another one")
    if base is not None and base not in known:
        raise ConfigError(
            f"--from {base}: it is no built-in system{nearest(base, known)}; known: {', '.join(known)}"
        )
    if folder.is_symlink() or folder.exists():
        raise ConfigError(f"{folder}: is there already, and nothing is overwritten: choose another name")
    return name


def _example(name: str) -> Iterator[tuple[str, str]]:
    """Yield the files of the small example: path and text."""
    places = {
        "system.toml": f"{name}.toml",
        "scenario.toml": f"scenarios/{name}/hill.toml",
        "bus.dbc": "can/bus.dbc",
    }
    for file in sorted(_TEMPLATE.rglob("*")):
        path = file.relative_to(_TEMPLATE).as_posix()
        if file.is_file() and path != "README_COPY.md":
            text = _aligned(file.read_text(encoding="utf-8").replace("@NAME@", name))
            yield places.get(path, path.removesuffix(".txt")), text


def _copy(name: str, system: System) -> Iterator[tuple[str, str]]:
    """Yield the files of a built-in system under another name: path and text."""
    text = _NAME.sub(f'name = "{name}"', system.path.read_text(encoding="utf-8"), count=1)
    yield f"{name}.toml", _FMU.sub(lambda found: f'{found[1]}"{_own(found[2])}"', text)
    files: dict[str, Path] = {}
    for bus in system.file.buses.values():
        files[bus.dbc] = data_file(bus.dbc, system.path, "dbc")
    for scenario in (load_scenario(system, each) for each in scenario_names(system)):
        if scenario.path is not None:
            files[f"scenarios/{name}/{scenario.path.name}"] = scenario.path
            for csv in {entry.csv for _, entry in scenario.file.stimuli if entry.csv is not None}:
                files[f"scenarios/{name}/{csv}"] = data_file(csv, scenario.path, "csv")
    for path, file in files.items():
        yield path, file.read_text(encoding="utf-8")
    for fmu in {entry.fmu for entry in system.file.units.values()}:
        file_name, source = model_source(fmu)
        yield f"models/{file_name}", source
    readme = (_TEMPLATE / "README_COPY.md").read_text(encoding="utf-8")
    yield "README.md", _aligned(readme.replace("@NAME@", name).replace("@SYSTEM@", system.file.name))


def _aligned(page: str) -> str:
    """Return a page whose commands, which names have made longer, have their comments in one column."""

    def block(found: re.Match[str]) -> str:
        lines = [line.partition("  # ") for line in found[0].splitlines()]
        width = max((len(command.rstrip()) for command, comment, _ in lines if comment), default=0)
        return "\n".join(f"{a.rstrip():{width}}  # {b}" if comment else a for a, comment, b in lines)

    return _COMMANDS.sub(block, page)


def _own(fmu: str) -> str:
    return f"models/{fmu}.fmu" if fmu in builtin_names() else fmu
