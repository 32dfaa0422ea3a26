"""The options of a run: their names."""

from __future__ import annotations

import pytest

from evcosim.cosim.system.run_options import RunOptions, check_names


def test_the_names_that_there_are_pass() -> None:
    check_names(RunOptions.__optional_keys__)
    check_names(())


def test_every_option_may_be_left_out() -> None:
    assert not RunOptions.__required_keys__


@pytest.mark.parametrize("name", sorted(RunOptions.__optional_keys__))
def test_a_misspelled_name_is_told_the_nearest(name: str) -> None:
    with pytest.raises(TypeError, match=rf"has no option '{name}x' \(did you mean '{name}'\?\); there"):
        check_names([name, f"{name}x"])
