"""Studies, which need several runs: identification, bus budgets, trials of an FMU."""
