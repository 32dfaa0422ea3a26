"""`evcosim reproduce`: the papers' tables and figures beside the obtained ones."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import completion
from .options import UnitsOption, WorkersOption

if TYPE_CHECKING:
    from ..reproduce.page import Page


def reproduce(
    papers: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="PAPER",
            help="By the name of its system, as 'evcosim list' shows; default: all.",
            autocompletion=completion.systems,
        ),
    ] = None,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Where the pages go.")] = Path(
        "results/reproduce"
    ),
    workers: WorkersOption = None,
    units: UnitsOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the tables as JSON.")] = False,
) -> int:
    """Reproduce papers: a page of all that each prints beside what is obtained, with verdicts and figures.

    Exit code 1 when a verdict is not borne out, or an own number is not what it was.
    """
    from ..reproduce import papers as library
    from .console import print_json, progress_bar
    from .failures import FAILED, complain
    from .outputs import output_folder

    names = list(dict.fromkeys(papers or library.NAMES))
    for name in names:
        library.load(name)  # a wrong name is said before anything runs
    folder = output_folder(output)
    begin = time.perf_counter()
    unwritten = ""
    said = _PapersDone({} if as_json or sys.stderr.isatty() else library.counts(names), begin)
    with progress_bar("reproducing", 0.0, 1.0, not as_json) as show:

        def progress(done: int, total: int, task: str) -> None:
            show(done / total)
            said(task)

        try:
            pages = library.reproduce(names, folder, workers, progress, units.value if units else "auto")
        except library.UnwrittenError as error:
            pages, unwritten = error.pages, str(error)
    seconds = time.perf_counter() - begin
    if as_json:
        print_json({page.name: _as_data(page) for page in pages})
    else:
        _show(pages, f"after {seconds:.0f} s", "" if unwritten else str(folder))
    if unwritten:
        complain(unwritten)
        return FAILED
    return 1 if any(page.missed for page in pages) else 0


class _PapersDone:
    """A line on stderr for each paper whose runs have ended, where no bar shows that the command lives."""

    def __init__(self, left: dict[str, int], begin: float) -> None:
        self.left, self.begin = left, begin

    def __call__(self, task: str) -> None:
        from .failures import complain

        paper = task.partition(":")[0]
        if paper in self.left:
            self.left[paper] -= 1
            if not self.left[paper]:
                after = time.perf_counter() - self.begin
                complain(f"{paper}: all runs have ended, after {after:.0f} s")


def _as_data(page: Page) -> dict[str, Any]:
    import dataclasses

    from ..reproduce.printed import counted

    return {
        "title": page.title,
        "source": page.source,
        "counts": counted(row.verdict for row in page.rows),
        "rows": [dataclasses.asdict(row) for row in page.rows],
        "own": [dataclasses.asdict(row) for row in page.own],
        "missed": len(page.missed),
    }


def _show(pages: list[Page], seconds: str, folder: str) -> None:
    """Print tables and counts, and the files in a folder ("": not all are there)."""
    from ..reproduce.printed import sentence
    from ..reproduce.render import missed
    from .console import print_paragraph, print_title, print_wrapped

    for i, page in enumerate(pages):
        print_title(f"{page.name}: {page.title}", first=i == 0)
        head = ["place", "what", "printed", "obtained", "verdict"]
        print_wrapped(head, [[r.place, r.what, r.printed, r.obtained, r.verdict] for r in page.rows])
        if page.own:
            print_title(f"{page.name}: own numbers")
            print_wrapped(["what", "obtained", "to reach"], [[r.what, r.obtained, r.reach] for r in page.own])
    names = ", ".join(f"{page.name}.md and .html" for page in pages)
    print()
    if folder:
        print_paragraph(f"in {folder}, {seconds}: README.md, index.html, {names}, figures/")
    print_paragraph(f"{sentence(row.verdict for page in pages for row in page.rows)}; {missed(pages)}")
