"""A module beside the toy, embedded with it."""

SCALE = 0.7
