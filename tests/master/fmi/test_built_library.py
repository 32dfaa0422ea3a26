"""A library that was just made is loaded once, in a process of its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.master.fmi.built_library import exported
from support.c_fmu import SOURCES, compiled


def test_the_names_that_a_library_exports(tmp_path: Path) -> None:
    path = tmp_path / "mixed.so"
    path.write_bytes(compiled(SOURCES / "mixed.c", ("-DFMI=2", "-DBEHAVIOR=0", "-DMODEL=mixed")))
    assert exported(path, ["fmi2DoStep", "fmi2DoNothing", "fmi2GetReal"]) == {"fmi2DoStep", "fmi2GetReal"}


def test_what_is_no_library(tmp_path: Path) -> None:
    path = tmp_path / "mixed.so"
    path.write_bytes(b"text")
    with pytest.raises(OSError, match=r"^file too short$|^invalid ELF header$"):
        exported(path, ["fmi2DoStep"])


def test_what_a_library_prints_hides_no_name(tmp_path: Path) -> None:
    source, path = tmp_path / "chatty.c", tmp_path / "chatty.so"
    source.write_text(
        """#include <stdio.h>
        __attribute__((constructor)) void begin(void) { printf("loaded"); fprintf(stderr, "begin"); }
        __attribute__((destructor)) void end(void) { printf("unloaded\\n"); }
        void fmi2DoStep(void) {}
        """
    )
    path.write_bytes(compiled(source))
    assert exported(path, ["fmi2DoStep", "fmi2GetReal"]) == {"fmi2DoStep"}
