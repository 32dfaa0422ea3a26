"""Units in processes of their own: an FMU that crashes, exits or hangs ends its process and not the run."""
