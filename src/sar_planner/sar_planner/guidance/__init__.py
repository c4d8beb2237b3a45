"""From a path to waypoints and airspeeds that an autopilot flies."""
