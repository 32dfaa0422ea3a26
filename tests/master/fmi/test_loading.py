"""The class of a unit follows from the version and the interface of its FMU."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from evcosim.master.fmi.exchange import ModelExchange
from evcosim.master.fmi.fmi1 import Fmi1ModelExchange, Fmi1Unit
from evcosim.master.fmi.fmi2 import Fmi2ModelExchange, Fmi2Unit
from evcosim.master.fmi.fmi3 import Fmi3ModelExchange, Fmi3Unit
from evcosim.master.fmi.fmu import FmuError, read_fmu
from evcosim.master.fmi.loading import load_unit
from evcosim.master.simulation import simulate
from support.c_fmu import mixed_fmu
from support.equations import equations_fmu

pytestmark = pytest.mark.usefixtures("warm_units")


@pytest.mark.parametrize(("fmi", "expected"), [(1, Fmi1Unit), (2, Fmi2Unit), (3, Fmi3Unit)])
def test_co_simulation_of_every_version(tmp_path: Path, fmi: int, expected: type) -> None:
    fmu = read_fmu(mixed_fmu(tmp_path / "mixed.fmu", fmi))
    unit = load_unit(fmu, "a", fmu.interface)
    assert type(unit) is expected
    assert (unit.name, unit.interface) == ("a", fmu.interface)
    unit.free()


@pytest.mark.parametrize(("fmi", "expected"), [(2, Fmi2ModelExchange), (3, Fmi3ModelExchange)])
def test_model_exchange_beside_co_simulation_where_it_is_wanted(
    tmp_path: Path, fmi: int, expected: type
) -> None:
    fmu = read_fmu(equations_fmu(tmp_path / "ball.fmu", "ball", fmi, "ME CS"))
    plain = load_unit(fmu, "a", fmu.interface)
    assert not isinstance(plain, ModelExchange)
    plain.free()
    unit = load_unit(fmu.using("model_exchange"), "a", fmu.interface, tolerance=1e-3)
    assert type(unit) is expected
    assert unit.tolerance == 1e-3
    unit.free()


def test_model_exchange_of_fmi_1_is_an_fmu_of_its_own(tmp_path: Path) -> None:
    fmu = read_fmu(equations_fmu(tmp_path / "ball.fmu", "ball", 1, tolerance="1e-5"))
    unit = load_unit(fmu, "a", fmu.interface)
    assert type(unit) is Fmi1ModelExchange
    assert unit.tolerance == 1e-5
    unit.free()
    with pytest.raises(FmuError, match='interface = "co_simulation": it has no such interface'):
        fmu.using("co_simulation")


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("identifier", ["rollback-end", "Demo.Tank", "2 tanks"])
def test_an_identifier_that_is_no_name_in_c(tmp_path: Path, fmi: int, identifier: str) -> None:
    plain = mixed_fmu(tmp_path / "plain.fmu", fmi)
    odd = tmp_path / "odd.fmu"
    with zipfile.ZipFile(plain) as source, zipfile.ZipFile(odd, "w") as archive:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                content = content.replace(
                    b'modelIdentifier="mixed"', f'modelIdentifier="{identifier}"'.encode()
                )
            archive.writestr(name.replace("mixed.so", f"{identifier}.so"), content)
    one, other = (simulate(path, inputs={"u": 2.0}, stop_time=0.05, step_size=0.01) for path in (plain, odd))
    assert one["fmu.y"][-1] == other["fmu.y"][-1] != 0.0
    assert [d for d in read_fmu(odd).defects if "modelIdentifier" in d and identifier in d]
