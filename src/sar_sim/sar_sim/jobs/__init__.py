"""Child processes, and seeded work on all cores."""
