"""What is left to the moving slot: unhindered, or for a point around the disc that is kept free.

While the helicopter cruises it stands still in the slot's frame. A point that moves at the fastest
speed, with no turn radius, must go around the disc about it, and so must every path.

Frame: that of the slot, which stays at the origin; the helicopter's leg is y = d.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sar_estimator.common.pose import Pose
from sar_planner.paths.dubins import lengths_m, words
from sar_planner.paths.flight_path import FloatArray
from sar_planner.rejoin.rejoin import RejoinTask

LEAST_STEP_S = 0.05
STEP_SHARE = 0.04
FINER = 8
NODES = 180
HERE = Pose(0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Limits:
    """What the bound depends on, start aside. Metres and metres per second."""

    slot_mps: float
    slowest_mps: float
    fastest_mps: float
    turn_radius_m: float
    spacing_m: float
    separation_m: float

    @classmethod
    def of(cls, task: RejoinTask) -> Limits:
        """Return those of a task."""
        return cls(
            task.forecast.speed_mps,
            task.slowest_mps,
            task.fastest_mps,
            task.turn_radius_m,
            task.forecast.leg.y_m,
            task.separation_m,
        )

    def straight_s(self, ways_m: FloatArray) -> FloatArray:
        """Return the least times for ways in the slot's frame, shape (..., 2): |w + V t| = v t."""
        v, fast = self.slot_mps, self.fastest_mps
        spread = fast**2 - v**2
        b = v * ways_m[..., 0]
        times: FloatArray = (b + np.sqrt(b**2 + spread * np.square(ways_m).sum(axis=-1))) / spread
        return times

    def first_fit_s(self, gates: FloatArray, low_s: FloatArray, high_s: FloatArray) -> FloatArray:
        """Return the first times at which words from (0, 0, 0) meet poses that move with the slot.

        ``gates``: x, y, heading and the direction in which the slot moves, shape (n, 4); not
        before ``low_s``, infinite where not before ``high_s``. Steps are a share of the time, as
        is the time for which lengths within the speed limits last; rounded down to a ``FINER``th.
        """
        out = np.full(len(gates), math.inf)
        times, steps = low_s.copy(), np.zeros(len(gates))
        open_ = np.flatnonzero(times < high_s)
        while open_.size:
            fits = self._fits(gates[open_], times[open_])
            met = open_[fits]
            out[met] = self._refined_s(gates[met], times[met], steps[met])
            open_ = open_[~fits]
            steps[open_] = np.maximum(LEAST_STEP_S, STEP_SHARE * times[open_])
            times[open_] += steps[open_]
            open_ = open_[times[open_] - steps[open_] < high_s[open_]]
        return out

    def to_slot_s(self, poses: FloatArray) -> FloatArray:
        """Return the unhindered times from poses, shape (n, 3), to the slot."""
        slots = seen_from(poses, np.zeros((len(poses), 3)))
        return self.first_fit_s(
            slots, self.straight_s(-poses[:, :2]), np.full(len(poses), math.inf)
        )

    def _fits(self, gates: FloatArray, times_s: FloatArray) -> NDArray[np.bool_]:
        """Whether some word to where the poses are then can be flown in that time."""
        run = self.slot_mps * times_s
        targets = np.column_stack(
            (
                gates[:, 0] + run * np.cos(gates[:, 3]),
                gates[:, 1] + run * np.sin(gates[:, 3]),
                gates[:, 2],
            )
        )
        lengths = lengths_m(words(HERE, targets, self.turn_radius_m), self.turn_radius_m)
        least, most = self.slowest_mps * times_s, self.fastest_mps * times_s
        return np.asarray(((lengths >= least) & (lengths <= most)).any(axis=0), dtype=np.bool_)

    def _refined_s(self, gates: FloatArray, times_s: FloatArray, steps_s: FloatArray) -> FloatArray:
        """Return the last times at which no word fitted yet, within the steps before."""
        shares = np.arange(FINER) / FINER
        tried = times_s[:, None] - steps_s[:, None] * (1.0 - shares)
        flat = np.repeat(gates, FINER, axis=0)
        fits = self._fits(flat, tried.ravel()).reshape(tried.shape)
        first = np.where(fits.any(axis=1), fits.argmax(axis=1), FINER)
        last: FloatArray = times_s - steps_s * (1.0 - np.maximum(first - 1, 0) / FINER)
        return last


def seen_from(poses: FloatArray, targets: FloatArray) -> FloatArray:
    """Return targets, shape (n, 3), as seen from poses, with the direction of the slot's motion."""
    way = targets[:, :2] - poses[:, :2]
    cosine, sine = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    return np.column_stack(
        (
            cosine * way[:, 0] + sine * way[:, 1],
            cosine * way[:, 1] - sine * way[:, 0],
            targets[:, 2] - poses[:, 2],
            -poses[:, 2],
        )
    )


class Around:
    """Least times around the disc about the cruising helicopter, with no turn radius.

    The disc is replaced by an inscribed polygon, which can only make them shorter.
    """

    def __init__(self, limits: Limits) -> None:
        """Solve from every node of the polygon."""
        self._limits = limits
        angles = np.arange(NODES) * 2.0 * math.pi / NODES
        self._centre = np.array((0.0, limits.spacing_m))
        self._clear_m = limits.separation_m * math.cos(math.pi / NODES) - 1e-9
        ring = np.column_stack((np.cos(angles), np.sin(angles)))
        self._nodes = self._centre + limits.separation_m * ring
        onward = limits.straight_s(np.roll(self._nodes, -1, axis=0) - self._nodes)
        back = limits.straight_s(np.roll(self._nodes, 1, axis=0) - self._nodes)
        left = np.where(
            self._is_clear(self._nodes, np.zeros((NODES, 2))),
            limits.straight_s(-self._nodes),
            math.inf,
        )
        for _ in range(NODES):
            left = np.minimum(left, np.minimum(onward + np.roll(left, -1), back + np.roll(left, 1)))
        self._left_s = left

    def _is_clear(self, begins: FloatArray, ends: FloatArray) -> FloatArray:
        way = ends - begins
        square = np.maximum(np.square(way).sum(axis=-1), 1e-12)
        share = np.clip(((self._centre - begins) * way).sum(axis=-1) / square, 0.0, 1.0)
        nearest = begins + share[..., None] * way - self._centre
        clear: FloatArray = np.hypot(nearest[..., 0], nearest[..., 1]) >= self._clear_m
        return clear

    def times_s(self, points: FloatArray) -> FloatArray:
        """Return the least times from points outside the disc, shape (n, 2), to the slot."""
        origin = np.zeros_like(points)
        direct = np.where(
            self._is_clear(points, origin), self._limits.straight_s(-points), math.inf
        )
        begins, nodes = points[:, None, :], self._nodes[None, :, :]
        begins, nodes = np.broadcast_arrays(begins, nodes)
        way = self._limits.straight_s(nodes - begins) + self._left_s
        via = np.where(self._is_clear(begins, nodes), way, math.inf).min(axis=1)
        times: FloatArray = np.minimum(direct, via)
        return times
