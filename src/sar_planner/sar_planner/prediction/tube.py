"""How near a path comes whatever a corner turns out to be: over a tube of forecasts. Pure."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sar_estimator.common.pose import wrap_angle
from sar_planner.paths.flight_path import Arc, FlightPath, FloatArray
from sar_planner.prediction.forecast import Forecast
from sar_planner.prediction.tube_kernels import (
    LATER_S,
    SHARE,
    SLOWING_MPS2,
    SPEED_MPS,
    least_in_box,
)

ACCEL_SHARE = 0.15
SPEED_OFF_MPS = 1.0
TURN_OFF_RAD = math.radians(30.0)
LEAST_LATER_S = 0.5
SEEN_S = 5.0
"""After the last stop: by then it is seen where the helicopter goes."""
STEP_S = 0.5
TOLERANCE_M = 2.0
HALVINGS = 200


@dataclass(frozen=True)
class Tube:
    """Corners about an expected one.

    ``onset_s``: when that begins [s]. ``box``, shape (4, 2), and ``nominal``, shape (6,): as
    ``tube_kernels`` takes them.
    """

    onset_s: float
    box: FloatArray
    nominal: FloatArray

    @property
    def last_stop_s(self) -> float:
        """The latest time at which the helicopter comes to its stop [s]."""
        slowing = self.box[SHARE, 0] * self.nominal[SLOWING_MPS2]
        return self.onset_s + float(self.box[LATER_S, 1] + self.box[SPEED_MPS, 1] / slowing)


@dataclass(frozen=True, slots=True)
class SureApart:
    """A lower bound of the least distance over a tube [m], until a time [s]."""

    distance_m: float
    until_s: float


def tube_about(forecast: Forecast, later_s: float, beside_m: float) -> Tube | None:
    """Return the tube about an expected corner; None for a forecast that is none.

    Its onset up to ``later_s`` [s] sooner or later, both accelerations ``ACCEL_SHARE`` more or
    less, V by ``SPEED_OFF_MPS``, the turn by ``TURN_OFF_RAD``; up to ``beside_m`` [m] beside all of
    that. It does not hover at its stop.
    """
    if len(forecast.stretches) != 3:
        return None
    slowing, leaving, _ = forecast.stretches
    if slowing.accel_mps2 >= 0.0 or leaving.accel_mps2 <= 0.0:
        return None
    turn = wrap_angle(leaving.start.heading_rad - slowing.start.heading_rad)
    middle = np.array((0.0, 1.0, slowing.speed_mps, turn))
    off = np.array((max(later_s, LEAST_LATER_S), ACCEL_SHARE, SPEED_OFF_MPS, TURN_OFF_RAD))
    nominal = (*slowing.start, -slowing.accel_mps2, leaving.accel_mps2, beside_m)
    box = np.column_stack((middle - off, middle + off))
    return Tube(slowing.time_s, box, np.array(nominal))


def sure_apart(
    path: FlightPath, tube: Tube, *, start_s: float, speed_mps: float, reaction_s: float
) -> SureApart | None:
    """Return what a path begun at ``start_s`` keeps from all of a tube; None where it is over.

    Until it is seen where the helicopter goes, and another list is flown, ``reaction_s`` later; no
    longer than the path, nor before the onset.
    """
    begin_s = max(start_s, tube.onset_s)
    until_s = min(tube.last_stop_s + SEEN_S + reaction_s, start_s + path.length_m / speed_mps)
    count = int((until_s - begin_s) / STEP_S) + 1
    if until_s <= begin_s:
        return None
    times = begin_s + STEP_S * np.arange(count, dtype=np.float64)
    bends = [part.curvature for part in path.segments if isinstance(part, Arc)]
    distance, _, _ = least_in_box(
        path.points(speed_mps * (times - start_s)),
        begin_s - tube.onset_s,
        STEP_S,
        tube.box,
        tube.nominal,
        speed_mps**2 * max(map(abs, bends), default=0.0),
        TOLERANCE_M,
        HALVINGS,
    )
    return SureApart(distance, float(times[-1]))
