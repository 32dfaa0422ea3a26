"""`evcosim list`: the systems with their scenarios, and the FMUs."""

from __future__ import annotations

from typing import Annotated, Any

import typer


def list_(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List the built-in systems, scenarios and FMUs."""
    from ..builtin import builtin_names, builtin_text
    from .console import print_json

    fmus = {name: builtin_text(name) for name in builtin_names()}
    systems = _systems()
    if as_json:
        print_json({"systems": systems, "fmus": fmus})
    else:
        _print(systems, fmus)


def _systems() -> list[dict[str, Any]]:
    from ...cosim.system.scenario import load_scenario, scenario_names
    from ...cosim.system.system import load_system, system_names

    found = []
    for name in system_names():
        system = load_system(name)
        scenarios = {s: load_scenario(system, s).file.title for s in scenario_names(system)}
        default = system.file.scenario
        found.append({"name": name, "title": system.file.title, "default": default, "scenarios": scenarios})
    return found


def _print(systems: list[dict[str, Any]], fmus: dict[str, str]) -> None:
    from .console import print_fields, print_paragraph, print_title

    for i, system in enumerate(systems):
        print_title(f"System {system['name']}: {system['title']}", first=i == 0)
        marked = [
            (f"{name} *" if name == system["default"] else name, title)
            for name, title in system["scenarios"].items()
        ]
        print_fields(marked, indent=2)
    print_title("FMUs")
    print_fields(list(fmus.items()), indent=2)
    print()
    print_paragraph(
        "'evcosim run SYSTEM --scenario NAME' runs one (* the default), 'evcosim info NAME' shows more."
    )
