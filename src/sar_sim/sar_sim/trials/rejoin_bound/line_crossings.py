"""A bound for starts beyond the helicopter's line, by the poses in which it can be crossed.

A path from there crosses the line a last time, downwards, at some pose clear of the helicopter; it
takes at least the unhindered time to that pose, and from there the unhindered, or the around, time
to the slot. Ahead of the helicopter it must then still cross the ray from it at -45 degrees,
outside the separation. The least over a grid of such poses.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from sar_planner.paths.flight_path import FloatArray
from sar_planner.rejoin.rejoin import RejoinTask
from sar_sim.trials.rejoin_bound.around import Around, Limits, seen_from

SAMPLE_S = 0.1
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


def _growing(first_m: float, step_m: float, growth: float, reach_m: float) -> FloatArray:
    """Return distances from ``first_m`` on, at first ``step_m`` apart, then by a growing share."""
    out = [first_m]
    while out[-1] < reach_m:
        out.append(out[-1] + max(step_m, growth * (out[-1] - first_m)))
    return np.array(out)


class Gates:
    """Poses in which the helicopter's line can be crossed a last time, and what is left then."""

    def __init__(self, limits: Limits, around: Around) -> None:
        """Lay the grid out and solve what is left from every pose."""
        self.limits = limits
        self.around = around
        d, separation = limits.spacing_m, limits.separation_m
        beside = np.arange(0.0, separation, GATE_STEP_M)
        outside = _growing(separation, GATE_STEP_M, GATE_GROWTH, GATE_REACH_M)
        x = np.concatenate((-outside[::-1], -beside[:0:-1], beside, outside))
        headings = -math.pi + (np.arange(GATE_HEADINGS) + 0.5) * math.pi / GATE_HEADINGS
        x_all, heading_all = (g.ravel() for g in np.meshgrid(x, headings, indexing="ij"))
        self.poses = np.column_stack((x_all, np.full_like(x_all, d), heading_all))
        self.left_free_s = self.limits.to_slot_s(self.poses)
        self.left_s = self.left_free_s.copy()
        clear = np.abs(x_all) >= separation
        around_s = around.times_s(self.poses[clear, :2])
        self.left_s[clear] = np.maximum(self.left_s[clear], around_s)
        near = (x_all >= separation) & (x_all <= NEAR_SEPARATIONS * separation)
        self.left_s[near] = np.maximum(self.left_s[near], self._past_ray_s(self.poses[near]))

    def _past_ray_s(self, gates: FloatArray) -> FloatArray:
        """Return the least times from gates ahead of the helicopter over the ray at -45 degrees."""
        limits = self.limits
        away = _growing(limits.separation_m, RAY_STEP_M, RAY_GROWTH, GATE_REACH_M)
        headings = (np.arange(RAY_HEADINGS) + 0.5) * 2.0 * math.pi / RAY_HEADINGS
        r, heading = (g.ravel() for g in np.meshgrid(away, headings, indexing="ij"))
        ray = np.column_stack(
            (r * math.cos(RAY_RAD), limits.spacing_m + r * math.sin(RAY_RAD), heading)
        )
        left = np.maximum(self.limits.to_slot_s(ray), self.around.times_s(ray[:, :2]))
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
    return Gates(limits, Around(limits))
