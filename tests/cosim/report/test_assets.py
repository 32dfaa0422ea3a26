"""The files of a page: uPlot is the one whose digest stands beside it, and nothing ends a script early."""

from __future__ import annotations

import base64
import hashlib
import re
from pathlib import Path

from evcosim.cosim.report import assets

FOLDER = Path(assets.__file__).parent / "assets"


def test_the_library_is_the_one_that_was_published():
    listed = dict(
        re.findall(r"^\| (\S+) \| .* \| ([0-9a-f]{64}) \|$", assets.text("README.md"), re.MULTILINE)
    )
    found = {name: hashlib.sha256((FOLDER / name).read_bytes()).hexdigest() for name in listed}
    assert listed == found
    assert {path.name for path in FOLDER.iterdir()} == {
        *listed,
        "README.md",
        "charts.js",
        "charts.css",
        "page.css",
    }
    assert f"(v{assets.UPLOT})" in assets.text("uPlot.iife.min.js")[:100]
    assert f"uPlot {assets.UPLOT}" in assets.text("README.md")


def test_the_policy_names_exactly_the_scripts():
    scripts = re.findall(r"<script>(.*?)</script>", assets.scripts(), re.DOTALL)
    digests = [base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in scripts]
    assert re.findall(r"'sha256-([^']+)'", assets.policy()) == digests
    assert len(digests) == 2 and "default-src 'none'" in assets.policy()


def test_no_file_reads_from_the_network():
    styles = assets.styles() + assets.page_styles()
    assert "url(" not in styles and "@import" not in styles
    assert not re.search(
        r"fetch\(|XMLHttpRequest|import\(|innerHTML|insertAdjacent", assets.text("charts.js")
    )
