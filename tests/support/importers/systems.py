"""The scooter and its ECU as an SSP, plain, with a factor or with a gain between, in tools that read one.

Vehicle and ECU alone, the rider's throttle at 100 %: the ECU holds the vehicle at its bound of 30 km/h, if
it sees the speed in km/h. The vehicle gives it in m/s.
"""

from __future__ import annotations

import re
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from evcosim.fmus.build import build_model
from evcosim.fmus.native.build import native_built
from support.importers.importers import HOSTS, called
from support.importers.small_models import Full, ToKmh
from support.importers.trials import why

NAMES = ("plain", "factor", "gain")
TOOLS = {
    "FMPy `simulate_ssp`": ("fmpy", "ssp_by_fmpy.py"),
    "libcosimpy": ("libcosimpy", "ssp_by_libcosimpy.py"),
    "ecospy": ("ecospy", "ssp_by_ecospy.py"),
    "fmucontainer, then FMPy": ("fmu-manipulation-toolbox", "ssp_by_fmucontainer.py"),
}


SSP = "http://ssp-standard.org/SSP1/"


def description(units: Sequence[str], connections: Sequence[tuple[str, str]], factor: bool) -> str:
    """Return the description of a system, in the prefixes that all of the tools know."""
    ends = [(end.split("."), kind) for a, b in connections for end, kind in ((a, "output"), (b, "input"))]
    elements = ""
    for unit in units:
        kinds = dict.fromkeys((name, kind) for (owner, name), kind in ends if owner == unit)
        connectors = "".join(
            f'<ssd:Connector name="{name}" kind="{kind}"><ssc:Real/></ssd:Connector>' for name, kind in kinds
        )
        elements += (
            f'<ssd:Component name="{unit}" type="application/x-fmu-sharedlibrary" '
            f'source="resources/{unit}.fmu">'
            f"<ssd:Connectors>{connectors}</ssd:Connectors></ssd:Component>"
        )
    lines = ""
    for a, b in connections:
        (from_, out), (to, in_) = a.split("."), b.split(".")
        inside = '<ssc:LinearTransformation factor="3.6"/>' if factor and b == "ecu.speed_measured" else ""
        suppressed = ' suppressUnitConversion="true"' if inside else ""
        lines += (
            f'<ssd:Connection startElement="{from_}" startConnector="{out}" '
            f'endElement="{to}" endConnector="{in_}"'
            f"{suppressed}>{inside}</ssd:Connection>"
        )
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><ssd:SystemStructureDescription xmlns:ssd="{SSP}'
        f'SystemStructureDescription" xmlns:ssc="{SSP}SystemStructureCommon" name="scooter" version="1.0">'
        f'<ssd:System name="scooter"><ssd:Elements>{elements}</ssd:Elements>'
        f"<ssd:Connections>{lines}</ssd:Connections></ssd:System></ssd:SystemStructureDescription>"
    )


def units(folder: Path) -> dict[str, Path]:
    """Build what stands in the systems into a folder, and return the files."""
    return {
        "ecu": native_built("BoundController"),
        "vehicle": native_built("Scooter"),
        "rider": build_model(Full, folder, native="require"),
        "gain": build_model(ToKmh, folder, native="require"),
    }


def write(path: Path, name: str, files: Mapping[str, Path]) -> Path:
    """Write the system: plain, with a factor on the connection of the speed, or with a gain in it."""
    connections = [("rider.throttle", "ecu.throttle_request"), ("ecu.throttle", "vehicle.throttle")]
    if name == "gain":
        connections += [("vehicle.speed", "gain.speed"), ("gain.converted", "ecu.speed_measured")]
    else:
        connections.append(("vehicle.speed", "ecu.speed_measured"))
        files = {unit: file for unit, file in files.items() if unit != "gain"}
    with zipfile.ZipFile(path, "w") as archive:
        for unit, file in files.items():
            archive.write(file, f"resources/{unit}.fmu")
        archive.writestr("SystemStructure.ssd", description(list(files), connections, name == "factor"))
    return path


def speeds(environments: dict[str, Path]) -> dict[str, dict[str, float | str]]:
    """Return the speed [km/h] after 20 s in each tool, by its environment's Python, and for each system.

    Where there is none, it is what the tool said.
    """
    found: dict[str, dict[str, float | str]] = {}
    with tempfile.TemporaryDirectory() as folder:
        built = units(Path(folder))
        files = {name: write(Path(folder, f"{name}.ssp"), name, built) for name in NAMES}
        for tool, (distribution, program) in TOOLS.items():
            if distribution in environments:
                found[tool] = {n: speed(environments[distribution], program, f) for n, f in files.items()}
    return found


def speed(python: Path, program: str, system: Path) -> float | str:
    """Return the vehicle's speed [km/h] after 20 s, or what the tool said."""
    status, text = called([python, HOSTS / program, system])
    shown = re.search(r"^SPEED (\S+)$", text, re.MULTILINE)
    return 3.6 * float(shown[1]) if shown else why(text) or f"exit code {status}"
