"""Another FMU in the place of a unit."""
