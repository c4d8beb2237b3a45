"""A flight for other tools: GPX, KML, GeoJSON, and plans for QGroundControl."""
