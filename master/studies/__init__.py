"""Questions that need several runs: identification, bus budgets, trials of an FMU."""
