"""Plane geometry: flight paths of straights and arcs, and how poses are joined by them."""
