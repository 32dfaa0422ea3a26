"""Files of results: a module for each format, and the table of them by suffix."""
