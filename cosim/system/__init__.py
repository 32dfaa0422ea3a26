"""What files say: systems, scenarios, stimuli, bus variations, and the specifications in them."""
