"""Every word of the plan has a code of its own."""

from __future__ import annotations

from typing import get_args, get_type_hints

from evcosim.master.engine.compiled.codes import effect_kind
from evcosim.master.engine.turn import Effect


def test_kinds_of_effects_differ() -> None:
    kinds = get_args(get_type_hints(Effect)["kind"])
    assert len({effect_kind(Effect(kind, 1.0)) for kind in kinds}) == len(kinds)
