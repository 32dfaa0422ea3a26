"""The files of a user: systems, scenarios, stimuli, bus variations, and the specifications in them."""
