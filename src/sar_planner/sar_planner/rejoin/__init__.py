"""Paths from anywhere onto the moving slot."""
