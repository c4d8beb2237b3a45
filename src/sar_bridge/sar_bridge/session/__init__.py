"""A session with one autopilot."""
