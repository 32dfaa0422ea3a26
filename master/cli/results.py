"""`evcosim results`: what is done with the folder of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .once import OnceCommand
from .typed_paths import checks_paths

results = typer.Typer(
    help="What is done with the folder of a run.", add_completion=False, rich_markup_mode=None
)


@results.callback()
def _group() -> None:
    """Recover the folder of a run that was killed."""


@results.command("recover", cls=OnceCommand)
@checks_paths
def recover(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="The folder of a run that was killed.")],
) -> None:
    """Make results.csv of what a run had saved that was killed or whose disk was full, or mend one.

    `evcosim plot` and `compare` read such a folder as it is, and the next run into it recovers it.
    """
    from ...cosim.errors import ConfigError
    from ...cosim.results.folder_lock import kept_elsewhere
    from ...cosim.results.run_folder import recover as recovered

    elsewhere = kept_elsewhere(folder)
    try:
        found = recovered(folder)
    except ConfigError as error:
        if elsewhere is None:
            raise
        raise ConfigError(*error.lines, f"the results of the run were kept in {elsewhere}") from error
    if found is None:
        print(f"{folder}: no run was killed here and no row is cut off, there is nothing to recover")
    else:
        until = f"up to t = {found.span[1]:.6g} s" if len(found) else "none"
        print(f"{folder}: results.csv has {len(found)} rows, {until}; status: {found.manifest['status']}")
    if elsewhere is not None:
        print(f"{folder}: the results of the run, which found no room here, were kept in {elsewhere}")
