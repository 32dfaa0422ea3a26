"""Runs as pages that need nothing else: interactive panels over time, and all that is known of the runs."""
