"""A lower bound on rejoining by where the soonest path first touches the disc that is kept free.

Between two contacts with the disc of radius rho about the helicopter the soonest path is one of
free space. There Pontryagin's principle holds: with heading theta, speed v, curvature u, slot speed
V and a constant costate lambda the Hamiltonian

    H = v (lambda . e(theta) + u lambda_theta) - V lambda_x

is constant, and so is the bracket, once u maximises or minimises it: free arcs are flown at the
fastest or at the slowest speed, with turns of the least radius and straights between them. Those
that can be the soonest are Dubins' words. So a path either

* never touches the disc: it is a word that meets the slot and stays clear (*clear word*), or
* has a first contact. There the distance to the helicopter has its least value, rho, and

      (v e(theta) - w) . n = 0,

  with the helicopter's velocity w and the direction n from it to the UAV: at each n the heading is
  one of two, for the slowest to the fastest v. The path takes at least the time of the first clear
  word to that pose, and then what is left from there (*contact*).

While the helicopter cruises what is left is a function of the contact's pose alone, in the slot's
frame. It is solved once: the least of the time of a clear word to the slot, and the time to another
contact and what is left from that. Between contacts close to one another the path may follow the
disc; the unhindered time is no more than that takes. Before the helicopter cruises, the unhindered
time is what is left.

Contacts are taken on a grid. A path's contacts lie up to half a step away from it: since the time
by a contact is least at the best one, that matters in the second order only, and words count as
clear, and as possible, by a tolerance that covers such a shift.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sar_estimator.plane import Pose
from sar_planner.captures import PathBatch
from sar_planner.dubins import lengths_m, words
from sar_planner.forecast import cruising
from sar_planner.geometry import FloatArray
from sar_planner.rejoin import RejoinTask, timed_words
from sar_planner.rejoin_around import HERE, Around, Limits, seen_from
from sar_planner.separation import least_distances_m

CONTACT_STEP_RAD = math.radians(3.0)
NEAR_RAD = math.radians(12.0)
TOLERANCE_M = 4.0
LENGTH_SLACK_M = 1.0
LATER_SHARE = 0.01
LATER_S = 0.05
HOP_SAMPLES = 48
WORD_STEP_S = 0.1
HORIZON_S = 150.0
MOVING_STEP_S = 0.5
MOVING_STEP_RAD = math.radians(2.0)
MOVING_SLACK_M = 5.0
DIFFERENCE_S = 0.01
WORDS = 128
CHUNK = 256
PAIRS = 20000
Motion = Callable[[NDArray[np.intp], FloatArray], FloatArray]


def clear_word_s(task: RejoinTask, upper_s: float) -> float:
    """Return a time before that of the first word that meets the slot and stays clear.

    Infinite where there is none before ``upper_s``.
    """
    rows, speeds = timed_words(task, WORD_STEP_S, upper_s + 2.0 * WORD_STEP_S)
    durations = lengths_m(rows, task.turn_radius_m) / speeds
    count = int(np.count_nonzero(durations < upper_s + WORD_STEP_S))
    for begin in range(0, count, WORDS):
        part = slice(begin, min(begin + WORDS, count))
        distances = least_distances_m(
            PathBatch(task.start, task.turn_radius_m, rows[part]),
            task.forecast,
            start_s=task.start_s,
            speeds_mps=speeds[part],
        )
        clear = np.flatnonzero(distances >= task.separation_m - TOLERANCE_M)
        if clear.size:
            return float(durations[begin + clear[0]]) - WORD_STEP_S
    return math.inf


def tangent_headings(
    angles_rad: FloatArray, velocities_mps: FloatArray, limits: Limits
) -> FloatArray:
    """Return headings, shape (n, 4), that touch the disc at directions from the helicopter.

    To both sides, at the slowest and the fastest speed; where even along the direction the UAV is
    slower than the helicopter, that direction.
    """
    along = velocities_mps[:, 0] * np.cos(angles_rad) + velocities_mps[:, 1] * np.sin(angles_rad)
    speeds = np.array((limits.slowest_mps, limits.fastest_mps))
    away = np.arccos(np.clip(along[:, None] / speeds, -1.0, 1.0))
    return np.concatenate((angles_rad[:, None] + away, angles_rad[:, None] - away), axis=1)


def clear_hops(
    limits: Limits,
    seen: FloatArray,
    times_s: FloatArray,
    helicopter: Motion,
    *,
    which: NDArray[np.intp],
    slack_m: float | FloatArray,
) -> NDArray[np.bool_]:
    """Whether some word from (0, 0, 0) to poses that move with the slot stays clear.

    ``seen``: the poses, as of ``Limits.first_fit_s``, met after ``times_s``, shape (n,).
    ``helicopter``: its positions, shape (k, m, 2), for hops, shape (k,), at times, shape (k, m);
    ``which``: the hops looked at, shape (n,). ``slack_m``: by how much lengths may be out of what
    the speed limits allow.
    """
    run = limits.slot_mps * times_s
    targets = np.column_stack(
        (seen[:, 0] + run * np.cos(seen[:, 3]), seen[:, 1] + run * np.sin(seen[:, 3]), seen[:, 2])
    )
    rows = words(HERE, targets, limits.turn_radius_m)
    lengths = lengths_m(rows, limits.turn_radius_m)
    fits = (lengths >= limits.slowest_mps * times_s - slack_m) & (
        lengths <= limits.fastest_mps * times_s + slack_m
    )
    word, hop = np.nonzero(fits)
    clear = np.zeros(len(times_s), dtype=np.bool_)
    if hop.size:
        shares = (np.arange(HOP_SAMPLES) + 0.5) / HOP_SAMPLES
        points = PathBatch(HERE, limits.turn_radius_m, rows[word, hop]).points(
            lengths[word, hop][:, None] * shares
        )
        gap = points - helicopter(which[hop], times_s[hop][:, None] * shares)
        least = np.sqrt(np.square(gap).sum(axis=2).min(axis=1))
        clear[hop[least >= limits.separation_m - TOLERANCE_M]] = True
    return clear


def first_clear_s(
    limits: Limits, seen: FloatArray, met_s: FloatArray, high_s: FloatArray, helicopter: Motion
) -> FloatArray:
    """Return times, from ``met_s`` on, before which no word to moving poses stays clear.

    Infinite where none does before ``high_s``. Rounded down by ``LATER_SHARE``.
    """
    out = np.full(len(met_s), math.inf)
    times, before = met_s.copy(), met_s.copy()
    open_ = np.flatnonzero(times < high_s)
    while open_.size:
        slack_m = LENGTH_SLACK_M + LATER_SHARE * limits.fastest_mps * times[open_]
        clear = clear_hops(
            limits, seen[open_], times[open_], helicopter, which=open_, slack_m=slack_m
        )
        out[open_[clear]] = before[open_[clear]]
        open_ = open_[~clear]
        before[open_] = times[open_]
        times[open_] += np.maximum(LATER_S, LATER_SHARE * times[open_])
        open_ = open_[before[open_] < high_s[open_]]
    return out


class Contacts:
    """Poses that touch the disc about the cruising helicopter, and what is left from them."""

    def __init__(self, limits: Limits) -> None:
        """Lay the grid out and solve what is left."""
        self.limits = limits
        self.around = Around(limits)
        angles = np.arange(0.0, 2.0 * math.pi - 1e-9, CONTACT_STEP_RAD)
        velocities = np.tile((limits.slot_mps, 0.0), (len(angles), 1))
        headings = tangent_headings(angles, velocities, limits)
        self._angles = np.repeat(angles, headings.shape[1])
        rho = limits.separation_m
        self.poses = np.column_stack(
            (
                rho * np.cos(self._angles),
                limits.spacing_m + rho * np.sin(self._angles),
                headings.ravel(),
            )
        )
        least = np.maximum(limits.to_slot_s(self.poses), self.around.times_s(self.poses[:, :2]))
        words_s = np.maximum(least, self._word_s())
        hops = self._hop_s(least, np.minimum(words_s, HORIZON_S))
        left = np.minimum(words_s, HORIZON_S)
        while True:
            better = np.minimum(left, np.maximum(least, (hops + left).min(axis=1)))
            if np.array_equal(better, left):
                break
            left = better
        self.left_s: FloatArray = left

    def _word_s(self) -> FloatArray:
        """Return the times of the first clear words to the slot."""
        limits = self.limits
        forecast = cruising(0.0, Pose(0.0, limits.spacing_m, 0.0), limits.slot_mps)
        return np.array(
            [
                clear_word_s(
                    RejoinTask(
                        Pose(float(x), float(y), float(heading)),
                        0.0,
                        (forecast,),
                        limits.turn_radius_m,
                        limits.slowest_mps,
                        limits.fastest_mps,
                        limits.separation_m,
                    ),
                    HORIZON_S,
                )
                for x, y, heading in self.poses
            ]
        )

    def _hop_s(self, least_s: FloatArray, most_s: FloatArray) -> FloatArray:
        """Return the least times from contact to contact, where they can be of use."""
        limits, poses = self.limits, self.poses
        ways = poses[None, :, :2] - poses[:, None, :2]
        low = limits.straight_s(ways)
        useful = low + least_s[None, :] < most_s[:, None]
        np.fill_diagonal(useful, val=False)
        begins, ends = np.nonzero(useful)
        apart = np.abs(np.angle(np.exp(1j * (self._angles[begins] - self._angles[ends]))))
        centre = np.array([[0.0, limits.spacing_m, 0.0]])
        hops = np.full(low.shape, math.inf)
        for begin in range(0, len(begins), PAIRS):
            part = slice(begin, begin + PAIRS)
            i, j = begins[part], ends[part]
            seen = seen_from(poses[i], poses[j])
            about = seen_from(poses[i], np.repeat(centre, len(i), axis=0))

            def helicopter(
                hop: NDArray[np.intp], at_s: FloatArray, about: FloatArray = about
            ) -> FloatArray:
                direction = about[hop, 3][:, None]
                run = limits.slot_mps * at_s
                return np.stack(
                    (
                        about[hop, 0][:, None] + run * np.cos(direction),
                        about[hop, 1][:, None] + run * np.sin(direction),
                    ),
                    axis=-1,
                )

            high = most_s[i] - least_s[j]
            met = limits.first_fit_s(seen, low[i, j], high)
            far = apart[part] > NEAR_RAD
            high[~far] = -math.inf
            clear = first_clear_s(limits, seen, met, high, helicopter)
            hops[i, j] = np.where(far, clear, met)
        return hops


def hindered_s(task: RejoinTask, contacts: Contacts, upper_s: float) -> float:
    """Return the least time [s] by a clear word or by a first contact, at most ``upper_s``."""
    best = min(upper_s, clear_word_s(task, upper_s))
    best = _by_cruise_contact_s(task, contacts, best)
    if task.forecast.steady_s > task.start_s:
        best = _by_moving_contact_s(task, contacts, best)
    return best


def _helicopter_seen(task: RejoinTask) -> Motion:
    """Return the helicopter's positions as seen from the start."""
    start = task.start
    cosine, sine = math.cos(start.heading_rad), math.sin(start.heading_rad)

    def helicopter(_: NDArray[np.intp], at_s: FloatArray) -> FloatArray:
        positions = task.forecast.positions(task.start_s + at_s.ravel())
        x, y = positions[:, 0] - start.x_m, positions[:, 1] - start.y_m
        seen = np.column_stack((cosine * x + sine * y, cosine * y - sine * x))
        return seen.reshape(*at_s.shape, 2)

    return helicopter


def _start(task: RejoinTask) -> FloatArray:
    return np.array([[task.ahead_m, task.start.y_m, task.start.heading_rad]])


def _by_cruise_contact_s(task: RejoinTask, contacts: Contacts, upper_s: float) -> float:
    """Return the least time by a first contact while the helicopter cruises."""
    limits, poses, left = contacts.limits, contacts.poses, contacts.left_s
    start = _start(task)
    low = limits.straight_s(poses[:, :2] - start[:, :2])
    low = np.maximum(low, task.forecast.steady_s - task.start_s)
    order = np.argsort(low + left, kind="stable")
    helicopter = _helicopter_seen(task)
    best = upper_s
    for begin in range(0, len(order), CHUNK):
        chosen = order[begin : begin + CHUNK]
        if low[chosen[0]] + left[chosen[0]] >= best:
            break
        seen = seen_from(np.repeat(start, len(chosen), axis=0), poses[chosen])
        high = best - left[chosen]
        met = limits.first_fit_s(seen, low[chosen], high)
        clear = first_clear_s(limits, seen, met, high, helicopter)
        best = min(best, float((clear + left[chosen]).min()))
    return best


def _by_moving_contact_s(task: RejoinTask, contacts: Contacts, upper_s: float) -> float:
    """Return the least time by a first contact before the helicopter cruises."""
    limits, start = contacts.limits, _start(task)
    forecast, rho = task.forecast, contacts.limits.separation_m
    each = np.arange(0.0, forecast.steady_s - task.start_s, MOVING_STEP_S)
    angles = np.arange(0.0, 2.0 * math.pi - 1e-9, MOVING_STEP_RAD)
    times, angles = (g.ravel() for g in np.meshgrid(each, angles, indexing="ij"))
    at = task.start_s + times
    before, after = (forecast.positions(at + d) for d in (-DIFFERENCE_S, DIFFERENCE_S))
    headings = tangent_headings(angles, (after - before) / (2.0 * DIFFERENCE_S), limits)
    slot_x = forecast.leg.x_m + forecast.speed_mps * (at - forecast.zero_s)
    touched = forecast.positions(at) + rho * np.column_stack((np.cos(angles), np.sin(angles)))
    count = headings.shape[1]
    poses = np.column_stack(
        (
            np.repeat(touched[:, 0] - slot_x, count),
            np.repeat(touched[:, 1], count),
            headings.ravel(),
        )
    )
    times = np.repeat(times, count)
    low = limits.straight_s(-poses[:, :2])
    ahead = limits.straight_s(poses[:, :2] - start[:, :2])
    near = (ahead <= times + MOVING_STEP_S) & (times + low < upper_s)
    poses, times, low = poses[near], times[near], low[near]
    order = np.argsort(times + low, kind="stable")
    helicopter, best = _helicopter_seen(task), upper_s
    for begin in range(0, len(order), CHUNK):
        chosen = order[begin : begin + CHUNK]
        if times[chosen[0]] + low[chosen[0]] >= best:
            break
        seen = seen_from(np.repeat(start, len(chosen), axis=0), poses[chosen])
        clear = clear_hops(
            limits,
            seen,
            times[chosen],
            helicopter,
            which=chosen,
            slack_m=MOVING_SLACK_M,
        )
        chosen = chosen[clear]
        slots = seen_from(poses[chosen], np.zeros((len(chosen), 3)))
        left = limits.first_fit_s(slots, low[chosen], best - times[chosen])
        best = min(best, float((times[chosen] + left).min(initial=math.inf)))
    return best


@lru_cache(maxsize=2)
def contacts_of(limits: Limits) -> Contacts:
    """Return the contacts, solved once for all starts."""
    return Contacts(limits)
