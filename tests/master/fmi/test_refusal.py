"""The reason why an FMU was not instantiated is looked for in its words, its library and its description."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from evcosim.cosim import shortage
from evcosim.master.fmi.fmu import Fmu
from evcosim.master.fmi.refusal import why_refused

DECLARED = "{11111111-2222-3333-4444-555555555555}"
OTHER = "aaaaaaaa-bbbb-cccc-dddd-eeeeeeeeeeee"


def reason(folder: Path, library: str, said: str = "", version: str = "2.0", **more: Any) -> str:
    """Refuse an FMU with a declared GUID whose library has this content."""
    path = folder / "library.so"
    path.write_bytes(library.encode())
    kind = SimpleNamespace(needsExecutionTool=more.pop("tool", "false"))
    description = SimpleNamespace(
        fmiVersion=version, guid=DECLARED, generationTool=more.get("generation_tool"),
        coSimulation=kind, modelExchange=None,
    )  # fmt: skip # as short as it is
    return why_refused(Fmu(Path("a.fmu"), description, ()), path, said)


def test_a_library_with_another_guid_does_not_belong_to_the_description(tmp_path: Path) -> None:
    found = reason(tmp_path, f"..{OTHER}..")
    assert f"has the GUID '{DECLARED}', its library holds '{OTHER}'" in found
    assert reason(tmp_path, f"..{OTHER}..", "[Error] no", "3.0").endswith("\n[Error] no")
    assert "instantiationToken" in reason(tmp_path, f"..{OTHER}..", version="3.0")


@pytest.mark.parametrize(
    "library", ["no guid", f"{DECLARED}", f"{OTHER} {OTHER[::-1]} {OTHER.replace('a', 'b')}"]
)
def test_without_one_other_guid_nothing_is_said_of_it(tmp_path: Path, library: str) -> None:
    """None, the declared one, or several, of which nobody knows which it is."""
    assert reason(tmp_path, library) == ": its instantiate function returned nothing and no message"


@pytest.mark.parametrize("said", ["[Error] wrong guid", "[Warning] Instantiation Token does not match"])
def test_an_fmu_that_complains_about_the_guid(tmp_path: Path, said: str) -> None:
    found = reason(tmp_path, "nothing", said)
    assert found.startswith(f": it does not accept the GUID '{DECLARED}'") and found.endswith(said)
    assert reason(tmp_path, "nothing", "[OK] the guid is fine") == ":\n[OK] the guid is fine"


def test_an_fmu_whose_tool_is_missing(tmp_path: Path) -> None:
    found = reason(tmp_path, "nothing", tool="true", generation_tool="ACME")
    assert found == ": it needs the tool that made it (ACME) to be installed (needsExecutionTool)"
    assert "(it does not say which)" in reason(tmp_path, "nothing", tool="true")


def test_a_limit_of_this_process_is_the_reason(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shortage, "_limit", lambda name: 7.0)
    found = reason(tmp_path, "nothing", "[Fatal] OSError(24, 'Too many open files')")
    assert found == ": Too many open files: the limit of open files is 7 (`ulimit -n`)"
