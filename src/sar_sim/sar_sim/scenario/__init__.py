"""What a simulated mission is made of."""
