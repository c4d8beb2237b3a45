"""Trials of parts of the system: encounters, rejoining, faults, tracking, the radio."""
