"""Simulation, recording, playback and reports."""
