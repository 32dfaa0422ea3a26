"""Machine code of calls and handovers, and the tables that it follows, for both sides of an isolated unit."""
