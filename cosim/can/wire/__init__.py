"""Frames as they run: packed, sent, under way, unpacked; the same functions in both engines."""
