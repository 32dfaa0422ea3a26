"""`evcosim build` writes the built-in FMUs."""

from __future__ import annotations

import zipfile
from pathlib import Path

from support.answers import refused


def test_build(evcosim, tmp_path):
    answer = evcosim("build", "Battery", "--output", "made")
    assert answer.out.strip() == "made/Battery.fmu"
    assert zipfile.is_zipfile(tmp_path / "made" / "Battery.fmu")
    cached = evcosim("build", "Battery").out.strip()
    assert (tmp_path / "made" / "Battery.fmu").read_bytes() == Path(cached).read_bytes()


def test_build_needs_a_cache_that_lasts(evcosim, tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("EVCOSIM_CACHE", str(blocked))
    refused(evcosim("build", "Battery"), f"{blocked}: Battery.fmu cannot be kept there", "--output DIR")
    assert evcosim("build", "Battery", "-o", "made").out.strip() == "made/Battery.fmu"
