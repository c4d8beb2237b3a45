"""The parameters of a corner, and of how the planner flies."""
