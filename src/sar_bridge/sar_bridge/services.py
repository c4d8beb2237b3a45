"""What an operator may ask of the graph, by name: the same for the command and the page."""

from __future__ import annotations

from sar_estimator.common import topics

SERVICES = {
    "engage": topics.ENGAGE,
    "disengage": topics.DISENGAGE,
    "return_home": topics.RETURN_HOME,
    "mark": topics.MARK,
    "orbit": topics.ORBIT,
    "resume": topics.RESUME,
}
SLOT = "slot"
SIDES = ("inside", "outside", "right", "left")
TRACKS = (1, 2, 3)
"""The slots that a UAV may be given: on a side of the helicopter, so many tracks away."""
