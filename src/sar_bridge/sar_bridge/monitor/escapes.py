"""Ways out for a UAV that is too near the helicopter, and how far apart a path keeps the two.

Pure, and without any of the planner's code. Positions are in the map frame [m], times in seconds
from now on, ``STEP_S`` apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sar_bridge.arduplane import l1_kernels
from sar_bridge.arduplane.l1_predictor import STEP_S
from sar_bridge.monitor.helicopter_hypotheses import Future
from sar_estimator.common.states import FloatArray, Motion

TURNS_RAD = np.radians(np.arange(-150.0, 151.0, 30.0))
AWAY_SHARE = 0.02


class Apart(NamedTuple):
    """How near a path comes to a future [m], and the standard deviation of that, shapes (n,).

    In the step that ends at each time; the first is now.
    """

    future: Future
    distance_m: FloatArray
    sigma_m: FloatArray


def apart(
    path: FloatArray, futures: list[Future], beside_m: float, most_mps2: float
) -> list[Apart]:
    """Return how near a path, shape (n, 2) [m], comes to every future, and how sure that is.

    A lower bound: with relative accelerations up to A the gap goes no farther than A h^2 / 8 beside
    the straight between its places at both ends of a step of h. ``beside_m``: the standard
    deviation of the UAV's position about the path [m]; ``most_mps2``: its most acceleration.
    """
    share = 0.125 * STEP_S**2
    return [
        Apart(
            future,
            *l1_kernels.apart(
                path,
                future.positions,
                future.sigma_m,
                beside_m,
                share * (most_mps2 + future.most_mps2),
            ),
        )
        for future in futures
    ]


@dataclass(frozen=True, slots=True)
class Escape:
    """Where the UAV is sent: ``points``, shape (1, 2) [m], and how much it climbs [m].

    ``predicted_m``: the least horizontal separation in prediction, the doubt against it.
    """

    time_s: float
    points: FloatArray
    climb_m: float
    predicted_m: float


@dataclass(frozen=True, slots=True)
class Worth:
    """What a way is worth: the least separation it keeps, and from all possible at its end [m]."""

    least_m: float
    away_m: float

    @property
    def value_m(self) -> float:
        """The least separation; of ways that begin too near alike, more for what leads away."""
        return self.least_m + AWAY_SHARE * self.away_m


def worth(near: list[Apart], sigmas: float, possible_s: float) -> Worth:
    """Return what a path is worth: against what is possible for a while, what is likely to its end.

    The doubt, ``sigmas`` standard deviations, is taken against it.
    """
    soon = round(possible_s / STEP_S) + 1
    least = away = math.inf
    for future, distance, sigma in near:
        bound = distance - sigmas * sigma
        away = min(away, float(bound[-1]))
        least = min(least, float((bound if future.likely else bound[:soon]).min()))
    return Worth(max(least, 0.0), max(away, 0.0))


def ends(uav: Motion, reach_m: float) -> list[FloatArray]:
    """Return the ends of the ways out, each of shape (1, 2) [m]: straight away, all around.

    None straight behind: to there the autopilot chooses which way it turns.
    """
    courses = uav.course_rad + TURNS_RAD
    here = np.array((uav.x_m, uav.y_m))
    reach = reach_m * np.column_stack((np.cos(courses), np.sin(courses)))
    return [here[None, :] + way[None, :] for way in reach]


def climb_m(near: list[Apart], above_m: float, most_m: float, climb_mps: float) -> float:
    """Return how much to climb on a way [m]: ``most_m`` where that separates more, else nothing.

    ``above_m``: the UAV's height above the helicopter [m]. ``climb_mps``: its rate.
    """
    flat = np.min([distance for _, distance, _ in near], axis=0)
    rise = np.minimum(climb_mps * STEP_S * np.arange(len(flat)), most_m)
    held = float(np.hypot(flat, above_m).min())
    climbing = float(np.hypot(flat, above_m + rise).min())
    return most_m if climbing > held else 0.0
