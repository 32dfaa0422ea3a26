"""A user's first lines: .ci/run lets mypy infer the type that the installed wheel gives them."""

from typing import reveal_type

from evcosim import simulate

results = simulate("scooter")
reveal_type(results)
