"""FMUs that are sloppy, broken or hostile, what is expected of a run with each, and what came of it.

python -m support.hostile (from tests/) runs all of them and writes docs/hostile.md.
"""
