"""README, docs and the other pages: their links lead somewhere, and what they say of the project is so."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from evcosim.cosim.system.scenario import scenario_names
from evcosim.cosim.system.system import load_system, system_names
from evcosim.master.builtin import builtin_names
from support.hostile.cases import CASES, GROUPS

ROOT = Path(__file__).parents[1]
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / ".github").rglob("*.md")]
EXAMPLE = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"\]\(([^)\s]+)\)")
README = (ROOT / "README.md").read_text(encoding="utf-8")
ARCHITECTURE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub makes them."""
    titles = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page):
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    for link in LINK.findall(text):
        if not link.startswith(("http://", "https://", "mailto:")):
            path, _, anchor = link.partition("#")
            target = (page.parent / path).resolve() if path else page
            assert target.exists(), link
            assert not anchor or anchor in anchors(target), link


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_what_the_examples_import_is_there(page):
    for code in EXAMPLE.findall(page.read_text(encoding="utf-8")):
        for line in re.findall(r"^(?:from|import) evcosim.*$", code, re.MULTILINE):
            exec(line, {})


def test_the_example_of_the_readme_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    example = EXAMPLE.findall(README)
    assert len(example) == 1
    exec(example[0], {})
    assert (tmp_path / "fig8.png").is_file()


def test_the_table_of_systems_has_the_scenarios_that_there_are():
    rows = re.findall(r"^\| \[`(\w+)`\]\([^|]*\| ([^|]*) \|", README, re.MULTILINE)
    shown = {system: set(re.findall(r"`(\w+)`", names)) for system, names in rows}
    assert shown == {name: set(scenario_names(load_system(name))) for name in system_names()}


def test_the_table_of_fmus_has_those_that_are_built():
    table = README.partition("| FMU | what it is |\n")[2].partition("\n\n")[0]
    first = [row.split("|")[1] for row in table.splitlines()]
    assert set(re.findall(r"`(\w+)`", " ".join(first))) == set(builtin_names())


def test_the_rooms_are_those_that_lint_imports_keeps():
    linter = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]
    kept = {contract["name"]: contract.get("layers") for contract in linter["contracts"]}
    for folder in ("cosim", "master"):
        section = ARCHITECTURE.partition(f"## The rooms of {folder}\n")[2].partition("\n## ")[0]
        rows = re.findall(r"^\| (`.*?`) \|", section, re.MULTILINE)
        assert [sorted(re.findall(r"`(\w+)`", row)) for row in rows] == [
            sorted(layer.split(" | ")) for layer in kept[f"rooms of {folder}"]
        ]


def test_the_number_of_hostile_fmus():
    for page, word in (("README.md", "broken"), ("docs/isolation.md", "hostile"), ("docs/hostile.md", "")):
        text = (ROOT / page).read_text(encoding="utf-8")
        assert re.findall(rf"(\d+) {word} ?FMUs", text) == [str(len(CASES))], page
    classes = sum(map(len, GROUPS.values()))
    assert f"\n{classes} classes, {len(CASES)} FMUs, " in (ROOT / "docs" / "hostile.md").read_text(
        encoding="utf-8"
    )


def test_contributing_names_every_command_that_makes_a_file():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    support = ROOT / "tests" / "support"
    programs = [p for p in support.glob("*.py") if '__name__ == "__main__"' in p.read_text(encoding="utf-8")]
    assert len(programs) >= 4
    assert [p.name for p in programs if f"tests/support/{p.name}" not in text] == []
    packages = [main.parent.name for main in support.glob("*/__main__.py")]
    assert [name for name in packages if f"-m support.{name}" not in text] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_files_are_named_as_they_stand_in_the_clone(page):
    """There is no folder of the package's name; models/base.py is imported as evcosim.models.base."""
    text = page.read_text(encoding="utf-8")
    assert re.findall(r"\bevcosim/(?:models|fmus|cosim|master)/\S*", text) == []
