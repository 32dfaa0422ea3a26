"""The output folder: tried before the first step, then filled with the files of a run."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ...cosim.results.folder_lock import FolderLock
    from ...cosim.results.results import Results
    from ...cosim.results.run_folder import RunFolder
    from ...cosim.system.figure_spec import FigureSpec
    from ...cosim.system.run_options import RunOptions

_LONGEST = 60  # characters of a suffix
_MOST = 1000  # folders with a number
_held: list[FolderLock] = []


def default_folder(*names: str) -> Path:
    """Return the folder of a run for which `--output` names none; names that are "" are left out."""
    return Path("results") / "-".join(name for name in names if name)


def output_folder(folder: Path, option: str = "--output") -> Path:
    """Make the folder if needed, try to write into it, and return it; this command has it until `release`.

    Raises ConfigError with the reason, also if another command has it, and the option that names another one.
    """
    from ...cosim.errors import ConfigError
    from ...cosim.results.folder_lock import FolderLock

    try:
        _held.append(FolderLock(folder))
    except ConfigError as error:
        raise ConfigError(f"{error}; {option} names another one") from error
    return folder


def release() -> None:
    """Give the folders free that this command has."""
    while _held:
        _held.pop().release()


def run_folder(
    wanted: Path, manifest: Mapping[str, Any], suffix: str, replace: bool
) -> tuple[RunFolder, list[str]]:
    """Lock the folder of a run, which is made if needed, and return it with remarks on the choice.

    A run replaces an earlier one of the same files, FMUs and settings (with `replace` any run). Where another
    one is in the folder, the run gets WANTED-SUFFIX, or one with a number. A killed run is recovered before.
    Raises ConfigError with the reason where the folder cannot be written, if another run has it, or if a file
    to be replaced or removed was not written by a run.
    """
    from ...cosim.errors import ConfigError
    from ...cosim.results.run_folder import RunFolder

    remarks: list[str] = []
    for folder in candidates(wanted, suffix):
        if folder != wanted and _is_taken(folder, manifest):
            continue
        try:
            locked = RunFolder(folder)
            remarks += _recovered(locked)
        except ConfigError as error:
            raise ConfigError(f"{error}; --output names another one") from error
        if replace or not locked.is_of_another(manifest):
            moved = f"{wanted} has results of other files, FMUs or settings; this run's are in {folder}"
            return locked, [*remarks, moved] if folder != wanted else remarks
        locked.release()
    raise ConfigError(f"output folder {wanted}: there are too many with a number; --output names another one")


def candidates(wanted: Path, suffix: str) -> Iterator[Path]:
    """Yield the folders that a run may have, the best first."""
    yield wanted
    base = wanted if wanted.name not in ("", "..") else wanted.resolve()
    if not base.name:  # the root of all folders
        return
    named = base.with_name(f"{base.name}-{suffix}") if suffix else base
    if suffix:
        yield named
    for number in range(2, _MOST):
        yield named.with_name(f"{named.name}-{number}")


def _is_taken(folder: Path, manifest: Mapping[str, Any]) -> bool:
    """Return True for a folder that holds files of somebody's own, or that another run of others has."""
    from ...cosim.file_names import flaw_of_name
    from ...cosim.results.folder_lock import lives, manifest_of
    from ...cosim.results.run_folder import foreign_files, same_settings

    if flaw_of_name(folder) or not folder.exists():  # such a name is refused when it is to be made
        return False
    if not folder.is_dir():
        return True
    return bool(foreign_files(folder)) or (lives(folder) and not same_settings(manifest, manifest_of(folder)))


def _recovered(locked: RunFolder) -> list[str]:
    """Recover the rows of a run that was killed, and return a remark about it.

    Raises ConfigError, also where files of somebody's own would be replaced; the folder is released then.
    """
    from ...cosim.errors import ConfigError

    try:
        if foreign := locked.foreign_files():
            raise ConfigError(locked.refusal(foreign))
        found = locked.recover()
    except ConfigError:
        locked.release()
        raise
    if found is None:
        return []
    return [f"{locked.path}: the run before left no results.csv; {len(found)} of its rows were recovered"]


def suffix_of(options: RunOptions, scenario: str | None = None) -> str:
    """Return the part of a folder's name that says what was set for a run; "" where nothing was, or much."""
    parts = [Path(scenario).stem] if scenario else []
    parts += [f"{name}={value}" for name, value in (options.get("parameters") or {}).items()]
    parts += [f"{name}={value}" for name, value in (options.get("start") or {}).items()]
    parts += [f"{name}={Path(str(x)).name}" for name, x in (options.get("inputs") or {}).items()]
    for files in (options.get("fmus") or {}, options.get("swaps") or {}):
        parts += [f"{unit}={Path(path).stem}" for unit, path in files.items()]
    parts += ["ideal"] if options.get("ideal") else []
    parts += [str(each) for each in (options.get("algorithm"), options.get("engine")) if each]
    parts += [f"isolation={options['isolation']}"] if options.get("isolation") else []
    parts += [str(options["interface"])] if options.get("interface") else []
    parts += [f"delay={options['delay']:g}"] if options.get("delay") else []
    parts += [f"step_size={options['step_size']:g}"] if options.get("step_size") else []
    parts += [f"tolerance={options['tolerance']:g}"] if options.get("tolerance") else []
    parts += [f"stop_time={options['stop_time']:g}"] if options.get("stop_time") is not None else []
    parts += [f"record={','.join(options['record'] or ())}"] if options.get("record") else []
    text = re.sub(r"[^A-Za-z0-9._=+-]+", "_", "-".join(parts))
    return text if len(text) <= _LONGEST else ""


def write_results(folder: RunFolder, results: Results) -> list[str]:
    """Write results.csv and run.json, and texts beside them, and return their names.

    Raises RunError where the disk refuses, which says what is kept where.
    """
    from ...cosim.results.rescue import finish
    from ...cosim.results.results import CSV_NAME, MANIFEST_NAME
    from ...cosim.results.text_table import texts_path

    finish(folder, results)
    texts = [texts_path(folder.path / CSV_NAME).name] if results.texts else []
    return [CSV_NAME, *texts, MANIFEST_NAME]


def figure_of(results: Results) -> FigureSpec | None:
    """Return what the figure of a run shows; None where it has nothing to draw."""
    from ...cosim.errors import ConfigError
    from ...cosim.figures.default_figure import default_spec

    if results.figure is not None or not len(results):
        return results.figure
    try:
        return default_spec(results)
    except ConfigError:  # it records texts alone
        return None


def write_figure(folder: Path, results: Results) -> list[str]:
    """Draw and write the figure and return the names of its files. Raises ConfigError."""
    from ...cosim.figures import draw as figures

    return [path.name for path in figures.save(results.plot(), folder)]


def write_report(folder: Path, results: Results) -> list[str]:
    """Write the page of a run, and return the name of its file. Raises ConfigError."""
    from ...cosim.results.run_folder import REPORT

    return [results.report(folder / REPORT).name]
