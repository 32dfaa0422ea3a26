"""The plan of a run: every value has a slot of one array, and the schedule refers to slots alone."""
