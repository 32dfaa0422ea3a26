"""The CAN logs that a run writes: which files, and when their clock begins."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from ..simulation import Simulation

CanLogOption = Annotated[
    list[Path] | None,
    typer.Option(
        "--can-log",
        metavar="FILE",
        help="Write the CAN frames: FILE.log (candump), .asc, .blf, .mf4 or .pcapng; a name without a folder "
        "into the results. May be given several times.",
    ),
]
CanLogStartOption = Annotated[
    str | None,
    typer.Option(
        "--can-log-start",
        metavar="DATE",
        help="The moment at which the CAN logs have 0 s, as 2026-05-04T12:00Z. Default: 2000-01-01T00:00Z.",
    ),
]


@dataclasses.dataclass(frozen=True)
class CanLogs:
    """The files that are wanted, and the start of their clock (None: the default)."""

    paths: tuple[Path, ...] = ()
    start: datetime | None = None

    @classmethod
    def asked(cls, paths: Sequence[Path] | None, start: str | None) -> CanLogs:
        """Return what the options ask for.

        Raises ConfigError for a suffix that no format has, a format whose library is not installed, a path
        given twice, and a start that is no date with a time zone, or that no file is there for.
        """
        from ...cosim.can.logs.writing import check_format
        from ...cosim.errors import ConfigError

        paths = tuple(paths or ())
        for path in paths:
            check_format(path)
            if paths.count(path) > 1:
                raise ConfigError(f"--can-log {path} is given twice")
        if start is None:
            return cls(paths)
        if not paths:
            raise ConfigError(f"--can-log-start {start}: there is no --can-log whose clock it would set")
        return cls(paths, _moment(start))

    def __bool__(self) -> bool:
        return bool(self.paths)

    def check(self, folder: Path, start: float) -> None:
        """Raise ConfigError where a file cannot be written after a run that begins at `start` [s]."""
        from ...cosim.can.logs.writing import check_start
        from ...cosim.writing import check_writable

        for path in self.paths:
            check_start(path, start)
            check_writable(self._place(path, folder))

    @staticmethod
    def _place(path: Path, folder: Path) -> Path:
        own = path.parent != Path() or path.is_absolute()
        return path if own else folder / path

    def write(self, folder: Path, simulation: Simulation) -> list[str]:
        """Write the files, those without a folder of their own into `folder`; return them as they are shown.

        Raises ConfigError where one cannot be written.
        """
        shown = []
        for path in self.paths:
            simulation.write_can_log(self._place(path, folder), self.start)
            shown.append(str(path))
        return shown


def _moment(text: str) -> datetime:
    from ...cosim.errors import ConfigError

    try:
        moment = datetime.fromisoformat(text)
        if moment.tzinfo is not None and 1970 < moment.year < 2200:
            return moment
    except ValueError:
        pass  # refused below, as a date without a time zone is
    raise ConfigError(
        f"--can-log-start {text}: a date of 1971 to 2199 with a time zone is needed, as 2026-05-04T12:00Z"
    )
