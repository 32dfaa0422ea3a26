"""The compiled engine: the schedule as flat tables, and a kernel of machine code that follows them."""
