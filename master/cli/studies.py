"""The folder of a study (`budget`, `identify`), which is named and chosen as that of a run is.

It is results/<system>-<scenario>-<verb>. A study replaces an earlier one of the same settings; where one of
others is in the folder, the settings are added to the name, or a number.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from .outputs import candidates, default_folder, output_folder, suffix_of

_KEY = "settings"


def study_folder(
    wanted: Path | None,
    names: tuple[str, ...],
    data: str,
    settings: Mapping[str, Any],
    option: str = "--output",
) -> tuple[Path, list[str]]:
    """Make and lock the folder of a study, and return it with remarks on the choice.

    `wanted` is the one that the user names by `option` (None: that of the `names`), `data` the name of the
    JSON file in which a study keeps its `settings`. Raises ConfigError where the folder cannot be written, or
    another command has it.
    """
    from ...cosim.errors import ConfigError

    first = wanted or default_folder(*names)
    for folder in candidates(first, suffix_of(settings["options"])):
        kept = _settings_in(folder / data)
        if kept is None or kept == json.loads(json.dumps(settings, default=str)):
            moved = f"{first} has results of other settings; these are in {folder}"
            return output_folder(folder, option), [moved] if folder != first else []
    raise ConfigError(f"output folder {first}: there are too many with a number; {option} names another one")


def written(names: Iterator[str]) -> tuple[list[str], str]:
    """Return the names of the files that are written while they are asked for, and why there are no more.

    "": there are all. What a study has found is printed in any case: it may have taken an hour.
    """
    from ...cosim.errors import ConfigError

    files: list[str] = []
    try:
        files.extend(names)
    except ConfigError as error:
        return files, str(error)
    return files, ""


def ended(folder: Path, files: Sequence[str], unwritten: str, remarks: Sequence[str]) -> int:
    """Print remarks, and why files are lacking, on stderr; return the exit code."""
    from .failures import FAILED, complain

    for remark in remarks:
        complain(f"warning: {remark}")
    if unwritten:
        complain(f"{unwritten}\nin {folder}: {', '.join(files) or 'nothing'}")
    return FAILED if unwritten else 0


def _settings_in(path: Path) -> Any:
    """Return the settings of the study that wrote a file; None where there is none, or not of a study."""
    from ...cosim.results.manifest import from_json

    try:
        found = from_json(path.read_bytes())
    except (OSError, ValueError):
        return None
    found = found[0] if isinstance(found, list) and found else found
    return found.get(_KEY, {}) if isinstance(found, dict) else None


def with_settings(data: Mapping[str, Any], settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a study found, with its settings as `study_folder` reads them."""
    return {**data, _KEY: json.loads(json.dumps(settings, default=str))}


def names_of(system: str, scenario: str | None) -> tuple[str, str]:
    """Return the names of system and scenario, of which that of the folder is made."""
    from ...cosim.system.scenario import load_scenario
    from ...cosim.system.system import load_system

    read = load_system(system)
    return read.file.name, load_scenario(read, scenario).name
