"""A lower bound on the time in which the moving slot can be rejoined."""
