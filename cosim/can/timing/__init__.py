"""Time on the bus: lengths of frames, who wins the arbitration, the longest response times."""
