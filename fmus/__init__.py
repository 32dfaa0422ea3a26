"""Packaging: models become FMI 2.0 co-simulation FMUs that run on pythonfmu's native library.

`build` makes them, `catalog` names them, `slave` is what runs inside. The module docstrings say what an FMU
of ours promises. This file and `slave` and what it imports travel inside each FMU: keep them light.
"""
