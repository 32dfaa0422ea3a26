"""Functions of makers: where they are found, and what is said of those that do not work."""

from __future__ import annotations

import sys

import pytest

from evcosim.cosim.can.protection.maker import MakerChecksum
from evcosim.cosim.errors import ConfigError, RunError

SOURCE = """
from dataclasses import dataclass
from tables import START

@dataclass
class Sum:
    value: int

def xor(payload, identifier, counter):
    value = START
    for byte in payload:
        value ^= byte
    return Sum(value).value

def broken(payload, identifier, counter):
    return payload[99]

def wide(payload, identifier, counter):
    return 256

def text(payload, identifier, counter):
    return "7"

def none(payload, identifier, counter):
    pass

number = 7
"""


def maker(folder, name: str) -> MakerChecksum:
    (folder / "checks.py").write_text(SOURCE)
    (folder / "tables.py").write_text("START = 0x80\n")
    (folder / "bad.py").write_text("x = 1 / 0\n")
    (folder / "lacks.py").write_text("import not_there_at_all\n")
    return MakerChecksum(name, str(folder), "s.toml: buses.can0.messages.M.checksum", "M.Sum")


def test_a_function_beside_the_system_file_finds_what_stands_beside_it(tmp_path):
    before = list(sys.path)
    assert maker(tmp_path, "checks:xor").loaded()(b"\x01\x02\x04", 1, -1, 8) == 0x87
    assert sys.path == before
    assert "checks" not in sys.modules


def test_a_function_of_an_installed_module(tmp_path):
    assert maker(tmp_path, "os.path:commonprefix").file is None
    found = maker(tmp_path, "math:hypot").loaded()
    with pytest.raises(RunError, match="TypeError"):
        found(b"", 1, 0, 8)


def test_two_folders_have_functions_of_their_own(tmp_path):
    found = []
    for i in range(2):
        folder = tmp_path / str(i)
        folder.mkdir()
        (folder / "own.py").write_text(f"def f(payload, identifier, counter):\n    return {i}\n")
        found.append(MakerChecksum("own:f", str(folder), "", "M.S").loaded())
    assert [each(b"", 1, 0, 8) for each in found] == [0, 1]


@pytest.mark.parametrize(
    ("name", "said"),
    [
        (
            "check:xor",
            r"there is no module 'check', neither check.py in .* nor installed \(did you mean 'checks'",
        ),
        ("checks:xo", r"checks.py has no 'xo' \(did you mean 'xor'"),
        ("checks:number", r"number of .*checks.py is no function"),
        ("bad:f", r"bad.py cannot be imported: ZeroDivisionError: division by zero \(bad.py, line 1\)"),
        ("lacks:f", r"lacks.py cannot be imported: ModuleNotFoundError: No module named 'not_there_at_all'"),
    ],
)
def test_what_cannot_be_loaded_is_named(tmp_path, name, said):
    with pytest.raises(ConfigError, match=rf"^s.toml: buses.can0.messages.M.checksum: .*{said}"):
        maker(tmp_path, name).loaded()


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("broken", r"IndexError: index out of range \(checks.py, line 16\)"),
        ("wide", "it returned 256, and a whole number from 0 to 255 is needed"),
        ("text", "it returned '7', and a whole number"),
        ("none", "it returned None, and a whole number"),
    ],
)
def test_what_a_function_does_wrong_is_named(tmp_path, name, said):
    with pytest.raises(RunError, match=rf"^the checksum M.Sum by checks:{name} of .*checks.py: {said}"):
        maker(tmp_path, f"checks:{name}").loaded()(b"\x01", 1, 0, 8)


def test_what_is_missing_is_said_without_running_any_code(tmp_path):
    for name in ("checks:xor", "checks:number", "math:hypot", "os.path:commonprefix", "bad:x", "__main__:x"):
        maker(tmp_path, name).check()  # bad.py would raise an error
    with pytest.raises(ConfigError, match=r"no module 'check'.* \(did you mean 'checks'\?\)"):
        maker(tmp_path, "check:xor").check()
    with pytest.raises(ConfigError, match=r"no module 'nowhere\.deep', neither nowhere/deep\.py in"):
        maker(tmp_path, "nowhere.deep:xor").check()
    with pytest.raises(ConfigError, match=r"M.checksum: .*bad\.py has no 'y'"):
        maker(tmp_path, "bad:y").check()
    with pytest.raises(ConfigError, match=r"zlib_crc\.py has no 'crc' \(did you mean 'crc8'\?\)"):
        (tmp_path / "zlib_crc.py").write_text("def crc8(payload, identifier, counter): return 0\n")
        maker(tmp_path, "zlib_crc:crc").check()
    with pytest.raises(ConfigError, match=r"colorsys\.py has no 'crc'"):  # an installed one
        maker(tmp_path, "colorsys:crc").check()
    (tmp_path / "inner").mkdir()
    with pytest.raises(ConfigError, match=r"no module 'inner.sums', neither inner/sums\.py in"):
        maker(tmp_path, "inner.sums:f").check()


def test_a_module_that_is_no_python_is_said_alike_before_a_run_and_in_one(tmp_path):
    (tmp_path / "odd.py").write_text("def f(:\n")
    said = r"M.checksum: .*odd\.py cannot be imported: SyntaxError: invalid syntax \(odd\.py, line 1\)$"
    for act in (MakerChecksum.check, MakerChecksum.loaded):
        with pytest.raises(ConfigError, match=said):
            act(maker(tmp_path, "odd:f"))
