"""The compiled engine: the schedule as flat tables, and one function of machine code that follows them."""
