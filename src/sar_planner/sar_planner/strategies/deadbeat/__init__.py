"""The deadbeat strategy: a state machine of legs, corners, rejoining and holding."""
