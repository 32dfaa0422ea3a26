"""The engines that do the steps of a run, in Python and compiled, and the schedule that both follow."""
