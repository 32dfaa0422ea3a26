"""What does the steps: the schedule, the python engine and the compiled one."""
