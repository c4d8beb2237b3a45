"""MAVLink autopilot bridge."""
