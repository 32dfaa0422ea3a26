"""Logs of the frames on a bus: what was sent when, in the files of other tools."""
