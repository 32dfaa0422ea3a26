"""Constants: physical constants, unit factors and tolerances that models share, each declared once."""

from __future__ import annotations

GRAVITY = 9.81  # m/s2, chosen by every model in which something has a weight
AIR_DENSITY = 1.2  # kg/m3, chosen by every vehicle with air drag
KMH = 3.6  # km/h in 1 m/s
HOUR = 3600.0  # s in 1 h: W.s to Wh, A.s to A.h
SAME_TIME = 1e-9  # s: a time that is counted down in steps counts as over below this
