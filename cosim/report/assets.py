"""The files that a page carries whole: the library that draws, our script and our style."""

from __future__ import annotations

import base64
import functools
import hashlib
from pathlib import Path

UPLOT = "1.6.32"
"""The version of uPlot in assets/."""

_FOLDER = Path(__file__).parent / "assets"


def text(name: str) -> str:
    """Return a file of assets/."""
    return (_FOLDER / name).read_text(encoding="utf-8")


@functools.cache
def styles() -> str:
    """Return the style sheets of panels, as an element of the head of any page that has some."""
    return f"<style>{text('uPlot.min.css')}\n{text('charts.css')}</style>"


@functools.cache
def page_styles() -> str:
    """Return the style sheet of a page of ours beside that of its panels."""
    return f"<style>{text('page.css')}</style>"


@functools.cache
def scripts() -> str:
    """Return the scripts of a page, as elements at the end of its body."""
    return "".join(f"<script>{script}</script>" for script in _scripts())


@functools.cache
def policy() -> str:
    """Return the element of a page's head that forbids the network, and every script but these."""
    digests = [base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in _scripts()]
    allowed = " ".join(f"'sha256-{digest}'" for digest in digests)
    rules = f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; img-src data:"
    return f'<meta http-equiv="Content-Security-Policy" content="{rules}">'


def _scripts() -> tuple[str, str]:
    return text("uPlot.iife.min.js"), text("charts.js")
