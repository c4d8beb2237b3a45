"""Flights without sockets: offline and replayed."""
