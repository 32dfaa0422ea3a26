"""A ring of units over a bus."""

from __future__ import annotations

import pytest

from benchmarks.case import Case
from benchmarks.runners.evcosim import write_system
from support.needs import need_c_compiler


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    """Writes the system of three C units round a bus, with further keys of the bus and of a unit."""
    need_c_compiler()
    folder = tmp_path_factory.mktemp("ring")

    def write(bus="", unit="", bias=None):
        path = write_system(Case("c", 3, 300, signals=2, channel=True), folder, "gauss_seidel")
        text = path.read_text().replace("[buses.can0]", f"[buses.can0]\n{bus}")
        text = text.replace("[units.n1]\n", f"[units.n1]\n{unit}\n")
        if bias is not None:
            text = text.replace("bias0 = 1.0\n", f"bias0 = {bias}\n")
        path.write_text(text)
        return path

    return write
