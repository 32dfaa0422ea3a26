"""The bus: databases, what a signal does to a value, the channel, the frames that crossed it."""
