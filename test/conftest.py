"""Settings of all tests."""

from hypothesis import settings

# How long an example takes is measured in benchmarks, never in a test.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
