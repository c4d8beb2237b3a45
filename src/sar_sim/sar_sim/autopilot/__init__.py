"""The simulated autopilot and the UAV it flies."""
