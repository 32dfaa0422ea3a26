"""Protection of messages end to end: checksums and counters, and what a receiver makes of them."""
