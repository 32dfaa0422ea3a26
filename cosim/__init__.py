"""The description of a run: system and scenario files, units of measure, the CAN channel, results.

Nothing here knows FMI binaries or models; `evcosim.master` runs what this package describes.
"""
