"""Many missions, and what they come to."""
