"""The figure that a call of `Results.plot` asks for: of the run, of a spec, or of some signals."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.backend_bases import FigureCanvasBase

from ..errors import ConfigError, nearest
from ..results.results import Results
from ..system.figure_spec import FigureSpec
from .default_figure import spec_of
from .draw import draw, write

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot(
    results: Results,
    path: str | os.PathLike[str] | Sequence[str] | None,
    title: str | None,
    spec: FigureSpec | None,
    signals: str | Sequence[str] | None,
) -> Figure:
    """Draw the figure that the arguments of `Results.plot` ask for, and write it where there is a path.

    In the place of the path may be signals: a list, or the name of a variable, which a name with the ending
    of a picture never is. Raises ConfigError as `Results.plot` says.
    """
    file, first = _file_or_signals(results, path)
    if first is not None and signals is not None:
        raise ConfigError("signals are given twice, as the first argument and as 'signals'")
    names = signals if first is None else first
    if names is not None and spec is not None:
        raise ConfigError("a figure shows signals or a spec: give one of the two")
    if names is not None:
        spec = spec_of(results, [names] if isinstance(names, str) else names)
    figure = draw(results, spec or results.figure, title=title)
    if file is not None:
        write(figure, file)
    return figure


def _file_or_signals(
    results: Results, given: str | os.PathLike[str] | Sequence[str] | None
) -> tuple[Path | None, str | Sequence[str] | None]:
    """Return the path of the figure's file, or else the signals, that the first argument says."""
    if given is None:
        return None, None
    if isinstance(given, os.PathLike):
        return Path(given), None
    if not isinstance(given, str):
        return None, given
    if Path(given).suffix.lower().removeprefix(".") in FigureCanvasBase.get_supported_filetypes():
        return Path(given), None
    if given in results:
        return None, given
    if near := nearest(given, results.names):
        raise ConfigError(f"'{given}' is no variable of the results{near}, and no name of a figure's file")
    return Path(given), None  # whose ending is refused with a list of those there are
