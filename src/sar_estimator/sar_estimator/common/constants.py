"""Constants of nature, and of the Earth, each in one place."""

from __future__ import annotations

G_MPS2 = 9.80665
"""Standard acceleration of gravity [m/s^2] (ISO 80000-3), as ArduPilot has it."""
