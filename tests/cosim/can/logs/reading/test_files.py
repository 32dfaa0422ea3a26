"""The formats that are read."""

from __future__ import annotations

from pathlib import Path

import pytest

from evcosim.cosim.can.logs.reading.files import FORMATS, format_of, logged_frames
from evcosim.cosim.can.logs.writing import FORMATS as WRITTEN
from evcosim.cosim.errors import ConfigError


def test_all_formats_that_are_written_are_read() -> None:
    assert set(WRITTEN) <= set(FORMATS)


def test_other_suffixes_and_what_is_no_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"here: a\.txt: CAN logs are read as \.log, .*, not as '\.txt'"):
        format_of(Path("a.txt"), "here")
    with pytest.raises(ConfigError, match=r"a\.log: cannot be read: "), logged_frames(tmp_path / "a.log"):
        raise AssertionError("there is no such file")
    (tmp_path / "b.log").mkdir()
    with pytest.raises(ConfigError, match="it is a folder"), logged_frames(tmp_path / "b.log"):
        raise AssertionError("it is a folder")
