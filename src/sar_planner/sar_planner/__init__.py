"""Mode-switching corner planner for UAV-assisted expanding-square search."""
