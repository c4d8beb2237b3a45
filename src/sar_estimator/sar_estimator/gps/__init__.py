"""A GPS receiver: its bytes in; fixes and velocities, stamped with this machine's clock, out."""
