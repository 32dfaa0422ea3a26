"""Packaging: models become FMI 2.0 co-simulation FMUs that run on pythonfmu's native library.

`build` makes them, `catalog` names them, `slave` runs inside them. The docstrings of these modules state what
an FMU of evcosim guarantees. This file, `slave` and the modules that `slave` imports travel inside each FMU:
keep them light.
"""
