"""Trials of an FMU before it takes the place of a unit: `evcosim check --try`.

levels   the range that the system can give to each input, and how far a trial moves it
bench    one unit alone, driven over some seconds, in a process of its own
probes   the checks of a trial, each a function from runs to findings
trial    the trial: all probes in order, within a time limit
"""
