"""Which topics the bridge takes and gives."""

from __future__ import annotations

from sar_estimator.common import topics

INPUTS = (topics.CLEARED, topics.SPEED, topics.DATUM, topics.DIAGNOSTICS)
OUTPUTS = (
    topics.UAV_ODOMETRY,
    topics.UAV_STATE,
    topics.UPLOADED,
    topics.AUTOPILOT,
    topics.WIND,
    topics.DIAGNOSTICS,
)
