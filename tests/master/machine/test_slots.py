"""The slots that both sides of an isolated unit agree on."""

from __future__ import annotations

import struct

from evcosim.cosim.plan.unit_plan import FmuSteps
from evcosim.master.machine import slots as S


def test_the_steps_of_a_turn_have_a_slot_for_each_number_and_end_before_the_other_side() -> None:
    assert len(FmuSteps._fields) == S.STEPS_END - S.STEPS
    assert S.STEPS_END <= S.ANSWER


def test_the_sides_write_to_different_lines_of_a_cache() -> None:
    of_master = range(S.REQUEST, S.STEPS_END)
    of_process = range(S.ANSWER, S.ASKED_END + 1)
    assert not {8 * slot // 64 for slot in of_master} & {8 * slot // 64 for slot in of_process}


def test_the_word_of_a_flag_tells_its_values_apart() -> None:
    halves = [struct.pack("<d", flag)[S.WORD :] for flag in (S.AWAKE, S.ON_SOCKET, S.ON_WORD)]
    assert len(set(halves)) == 3
    assert struct.unpack("<I", halves[2]) == (S.ON_WORD_BITS,)
