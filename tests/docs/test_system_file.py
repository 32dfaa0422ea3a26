"""docs/system-file.md: its tables are those of the docstrings, its example runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from evcosim import simulate
from evcosim.cosim.system.schema import json_schema
from support.tables import MODELS, PAGE, paths, table, written

TEXT = PAGE.read_text(encoding="utf-8")


def test_the_tables_are_those_of_the_docstrings() -> None:
    assert written(TEXT) == TEXT, "python tests/support/tables.py writes the page anew"


@pytest.mark.parametrize("kind", ["system", "scenario"])
def test_every_table_of_a_file_stands_on_the_page(kind: str) -> None:
    """Each record of the schema, by its keys; what a scenario shares with a system stands there."""
    made = {table(*place) for place in paths(TEXT)}
    for name, record in json_schema(MODELS[kind], kind)["$defs"].items():
        if "properties" not in record or name in ("Override", "Bias", "Reset", "Reduction"):
            continue  # events have one table together; a reduction is a metric without name and unit
        keys = [f"| `{key}`<br>" for key in record["properties"]]
        assert any(all(key in text for key in keys) for text in made), name


def test_the_example_runs(tmp_path: Path) -> None:
    files = re.findall(r"<!-- file: (\S+) -->\n```toml\n(.*?)```", TEXT, re.DOTALL)
    assert [name for name, _ in files] == ["my_scooter.toml", "full_throttle.toml"]
    for name, text in files:
        (tmp_path / name).write_text(text, encoding="utf-8")
    system, scenario = (tmp_path / name for name, _ in files)
    results = simulate(system, scenario)
    assert len(results) == 2001
    before, after = results["ecu.speed_measured"][900], results["ecu.speed_measured"][1900]
    assert before == pytest.approx(25.0, abs=1.0)
    assert after == pytest.approx(25.0, abs=1.0)  # as the controller sees it
    assert 3.6 * results["vehicle.speed"][1900] == pytest.approx(30.0, abs=1.5)  # and as it is


def test_a_page_that_is_made_twice_is_the_same() -> None:
    assert written(written(TEXT)) == written(TEXT)
    emptied = re.sub(r"(<!-- table: .*? -->\n).*?(<!-- end -->)", r"\1\2", TEXT, flags=re.DOTALL)
    assert len(emptied) < len(TEXT)
    assert written(emptied) == TEXT
