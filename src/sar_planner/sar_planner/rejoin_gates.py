"""What is left to the moving slot from beyond the helicopter, by the ways a path must take.

* *Around*: while the helicopter cruises it stands still in the slot's frame. A point that moves at
  the fastest speed, with no turn radius, must go around the disc about it.
* *Gate*: a path from beyond the helicopter's line crosses it a last time, downwards, at some pose
  clear of the helicopter; it takes at least the unhindered time to that pose, and from there the
  unhindered, or the around, time to the slot. Ahead of the helicopter it must then still cross the
  ray from it at -45 degrees, outside the separation. The least over a grid of such poses.

Frame: that of the slot, which stays at the origin; the helicopter's leg is y = d.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sar_estimator.plane import Pose
from sar_planner.dubins import lengths_m, words
from sar_planner.geometry import FloatArray
from sar_planner.rejoin import RejoinTask

LEAST_STEP_S = 0.05
STEP_SHARE = 0.04
FINER = 8
SAMPLE_S = 0.1
NODES = 180
GATE_STEP_M = 5.0
GATE_GROWTH = 0.03
GATE_REACH_M = 4000.0
GATE_HEADINGS = 36
RAY_RAD = -math.pi / 4.0
RAY_STEP_M = 5.0
RAY_GROWTH = 0.07
RAY_HEADINGS = 72
NEAR_SEPARATIONS = 6.0
CHUNK = 512
PAIRS = 8
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


def _growing(first_m: float, step_m: float, growth: float, reach_m: float) -> FloatArray:
    """Return distances from ``first_m`` on, at first ``step_m`` apart, then by a growing share."""
    out = [first_m]
    while out[-1] < reach_m:
        out.append(out[-1] + max(step_m, growth * (out[-1] - first_m)))
    return np.array(out)


class Gates:
    """Poses in which the helicopter's line can be crossed a last time, and what is left then."""

    def __init__(self, limits: Limits) -> None:
        """Lay the grid out and solve what is left from every pose."""
        self.limits = limits
        self.around = Around(limits)
        d, separation = limits.spacing_m, limits.separation_m
        beside = np.arange(0.0, separation, GATE_STEP_M)
        outside = _growing(separation, GATE_STEP_M, GATE_GROWTH, GATE_REACH_M)
        x = np.concatenate((-outside[::-1], -beside[:0:-1], beside, outside))
        headings = -math.pi + (np.arange(GATE_HEADINGS) + 0.5) * math.pi / GATE_HEADINGS
        x_all, heading_all = (g.ravel() for g in np.meshgrid(x, headings, indexing="ij"))
        self.poses = np.column_stack((x_all, np.full_like(x_all, d), heading_all))
        self.left_free_s = self.to_slot_s(self.poses)
        self.left_s = self.left_free_s.copy()
        clear = np.abs(x_all) >= separation
        around = self.around.times_s(self.poses[clear, :2])
        self.left_s[clear] = np.maximum(self.left_s[clear], around)
        near = (x_all >= separation) & (x_all <= NEAR_SEPARATIONS * separation)
        self.left_s[near] = np.maximum(self.left_s[near], self._past_ray_s(self.poses[near]))

    def to_slot_s(self, poses: FloatArray) -> FloatArray:
        """Return the unhindered times from poses to the slot."""
        slots = seen_from(poses, np.zeros((len(poses), 3)))
        low = self.limits.straight_s(-poses[:, :2])
        return self.limits.first_fit_s(slots, low, np.full(len(poses), math.inf))

    def _past_ray_s(self, gates: FloatArray) -> FloatArray:
        """Return the least times from gates ahead of the helicopter over the ray at -45 degrees."""
        limits = self.limits
        away = _growing(limits.separation_m, RAY_STEP_M, RAY_GROWTH, GATE_REACH_M)
        headings = (np.arange(RAY_HEADINGS) + 0.5) * 2.0 * math.pi / RAY_HEADINGS
        r, heading = (g.ravel() for g in np.meshgrid(away, headings, indexing="ij"))
        ray = np.column_stack(
            (r * math.cos(RAY_RAD), limits.spacing_m + r * math.sin(RAY_RAD), heading)
        )
        left = np.maximum(self.to_slot_s(ray), self.around.times_s(ray[:, :2]))
        ways = ray[None, :, :2] - gates[:, None, :2]
        least = limits.straight_s(ways) + left
        order = np.argsort(least, axis=1)
        best = np.full(len(gates), math.inf)
        open_ = np.arange(len(gates))
        for begin in range(0, len(ray), PAIRS):
            chosen = order[open_, begin : begin + PAIRS]
            promising = least[open_, chosen[:, 0]] < best[open_]
            open_, chosen = open_[promising], chosen[promising]
            if not open_.size:
                break
            gate, over = np.repeat(open_, chosen.shape[1]), chosen.ravel()
            low = limits.straight_s(ways[gate, over])
            seen = seen_from(gates[gate], ray[over])
            times = limits.first_fit_s(seen, low, best[gate] - left[over]) + left[over]
            best[open_] = np.minimum(best[open_], times.reshape(chosen.shape).min(axis=1))
        return best

    def bound_s(self, task: RejoinTask, upper_s: float) -> float:
        """Return the least time by any gate, at most ``upper_s``, from a start beyond y = d."""
        start = np.array([[task.ahead_m, task.start.y_m, task.start.heading_rad]])
        straight = self.limits.straight_s(self.poses[:, :2] - start[:, :2])
        cruise_s = max(task.forecast.steady_s - task.start_s, 0.0)
        order = np.argsort(straight + self.left_free_s, kind="stable")
        best = upper_s
        for begin in range(0, len(order), CHUNK):
            chosen = order[begin : begin + CHUNK]
            low, left_free = straight[chosen], self.left_free_s[chosen]
            if low[0] + left_free[0] >= best:
                break
            seen = seen_from(np.repeat(start, len(chosen), axis=0), self.poses[chosen])
            met = self.limits.first_fit_s(seen, low, best - left_free)
            can = np.isfinite(met)
            met = self._unblocked_s(task, self.poses[chosen[can], 0], met[can], cruise_s)
            left = np.where(met >= cruise_s, self.left_s[chosen[can]], left_free[can])
            best = min(best, float((met + left).min(initial=math.inf)))
        return best

    def _unblocked_s(
        self, task: RejoinTask, x_m: FloatArray, met_s: FloatArray, cruise_s: float
    ) -> FloatArray:
        """Return the first times from ``met_s`` on at which the helicopter leaves gates free."""
        times = np.arange(0.0, cruise_s + 2.0 * SAMPLE_S, SAMPLE_S)
        helicopter = task.forecast.positions(task.start_s + times)
        at_x = helicopter[:, 0] - np.array(
            [task.forecast.slot_x_m(task.start_s + t) for t in times]
        )
        above = np.square(helicopter[:, 1] - self.limits.spacing_m)
        half = np.sqrt(np.maximum(self.limits.separation_m**2 - above, 0.0))
        free = np.abs(x_m[:, None] - at_x[None, :]) >= half[None, :] - 1e-9
        # The first free sample from each sample on; the last one is the cruise's, for ever.
        when = np.where(free, times[None, :], math.inf)
        ahead = np.minimum.accumulate(when[:, ::-1], axis=1)[:, ::-1]
        index = np.minimum((met_s / SAMPLE_S).astype(int), len(times) - 1)
        first = ahead[np.arange(len(x_m)), index]
        return np.where(first <= times[-1], np.maximum(met_s, first), math.inf)


@lru_cache(maxsize=2)
def gates_of(limits: Limits) -> Gates:
    """Return the gates, solved once for all starts."""
    return Gates(limits)
