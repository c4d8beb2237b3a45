"""What an operator may ask of the graph, by name: one table for the command and the page."""

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
