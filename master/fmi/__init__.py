"""FMUs as units: reading the file, loading its library, and calling it (fmi-standard.org)."""
