"""Results of runs: the recorded rows, their files, their metrics, and the comparison of two."""
