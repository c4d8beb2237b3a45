"""The independent separation monitor."""
