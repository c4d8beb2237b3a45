"""What is known of both aircraft, the helicopter's motion to come, and their distance."""
