"""The MAVLink link and its protocols."""
