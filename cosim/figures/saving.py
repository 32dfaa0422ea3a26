"""Figures as files, whose bytes depend on the figure alone."""

from __future__ import annotations

import warnings
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
    with style(), warnings.catch_warnings(), replacing(path) as file:
        # a letter that the font lacks, or no room beside a long name: the figure shows it
        warnings.simplefilter("ignore", UserWarning)
        figure.savefig(file, format=kind, metadata=metadata)
