"""Pictures of results and systems."""
