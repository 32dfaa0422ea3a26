"""Mathematics on arrays: sweeps, responses, first-order fits, bus budgets."""
