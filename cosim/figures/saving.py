"""Figures as files, whose bytes depend on the figure alone."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import ConfigError
from ..writing import replacing
from .style import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def save(figure: Figure, folder: Path, stem: str = "figure") -> tuple[Path, Path]:
    """Write STEM.png (1440 pixels wide) and STEM.svg into a folder; equal figures give equal bytes.

    Raises ConfigError when a file cannot be written.
    """
    paths = (Path(folder) / f"{stem}.png", Path(folder) / f"{stem}.svg")
    with _laid_out(figure):
        for path in paths:
            write(figure, path)
    return paths


def write(figure: Figure, path: Path) -> None:
    """Write a figure in the format that the name of the file ends in.

    Raises ConfigError for another ending, naming those there are, and when the file cannot be written.
    """
    kind = path.suffix.removeprefix(".").lower()
    known = figure.canvas.get_supported_filetypes()
    if kind not in known:
        raise ConfigError(
            f"{path}: '{kind}' is not a format of figures; use one of {', '.join(sorted(known))}"
        )
    dated = {"svg": "Date", "pdf": "CreationDate", "png": "Software"}
    metadata = {dated[kind]: None} if kind in dated else None
    with _laid_out(figure), _quietly(), replacing(path) as file:
        figure.savefig(file, format=kind, metadata=metadata)


@contextlib.contextmanager
def _laid_out(figure: Figure) -> Iterator[None]:
    """Place what a figure has once, for all formats: else matplotlib draws it another time before each."""
    if (engine := figure.get_layout_engine()) is None:
        yield
        return
    with _quietly():
        engine.execute(figure)
    figure.set_layout_engine(None)  # not "none": before each file a figure with that is drawn another time
    try:
        yield
    finally:
        figure.set_layout_engine(engine)


@contextlib.contextmanager
def _quietly() -> Iterator[None]:
    with style(), warnings.catch_warnings():
        # a letter that the font lacks, or no room beside a long name: the figure shows it
        warnings.simplefilter("ignore", UserWarning)
        yield
