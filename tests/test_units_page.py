"""docs/units.md: its tables are those of the code, and what it says of conversions is so."""

from __future__ import annotations

import re

import pytest

from evcosim.cosim.errors import ConfigError
from evcosim.cosim.units.conversion import between
from support import units_page

TEXT = units_page.PAGE.read_text(encoding="utf-8")


def test_the_tables_are_those_of_the_code():
    assert units_page.rewritten(TEXT) == TEXT, "python tests/support/units_page.py writes it"


def test_what_the_page_converts_is_converted():
    rows = re.findall(r"^\| `(\S+)` \| `(\S+)` \| x ([\d.]+)(?: \+ ([\d.]+))? \|$", TEXT, re.MULTILINE)
    assert len(rows) >= 8
    for source, target, scale, offset in rows:
        map_ = between(source, target)
        assert (map_.scale, map_.offset) == (pytest.approx(float(scale), rel=1e-4), float(offset or 0.0))


def test_what_the_page_refuses_is_refused():
    rows = re.findall(r"^\| `(\S+)` \| `(\S+)` \| refused", TEXT, re.MULTILINE)
    assert len(rows) >= 4
    for source, target in rows:
        with pytest.raises(ConfigError):
            between(source, target)
