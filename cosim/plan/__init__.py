"""From files and interfaces to the plan of a run."""
