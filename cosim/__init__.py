"""Descriptions of what is connected to what: files, units of measure, the CAN channel, plans and results.

Nothing here knows FMI binaries or models; `evcosim.master` runs what this package describes.
"""
