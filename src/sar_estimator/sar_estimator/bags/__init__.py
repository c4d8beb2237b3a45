"""Bags: recordings of the graph, written, read, and mended where they were cut."""
