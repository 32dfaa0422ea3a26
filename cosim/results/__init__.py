"""What a run recorded, its metrics, and the comparison of two."""
