"""Waypoint lists that replace one another in flight."""
