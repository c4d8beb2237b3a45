"""Recorded flights: bags and tracks."""
