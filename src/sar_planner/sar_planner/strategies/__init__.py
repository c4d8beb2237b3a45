"""How the UAV is led, from decision to decision."""
