"""Native FMUs: a model's own source becomes readable C99 that computes the same, bit for bit; no Python."""
