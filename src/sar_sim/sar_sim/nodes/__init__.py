"""Nodes: simulation, recorder, player."""
