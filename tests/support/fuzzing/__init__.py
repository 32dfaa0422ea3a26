"""The makers of hostile inputs: files of each kind, and command lines, from a random generator."""
