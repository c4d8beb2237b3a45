"""Settings of all tests."""

from hypothesis import settings

# How long an example takes is measured in benchmarks, never in a test. Every run draws the same
# examples; to search on: --hypothesis-profile explore.
settings.register_profile("explore", deadline=None)
settings.register_profile("seeded", deadline=None, derandomize=True)
settings.load_profile("seeded")
