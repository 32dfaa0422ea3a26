"""What holds for every test."""

from __future__ import annotations

from hypothesis import settings

# an example that a busy machine slows down has failed nothing: speed is shown by benchmarks
settings.register_profile("evcosim", deadline=None)
settings.load_profile("evcosim")
