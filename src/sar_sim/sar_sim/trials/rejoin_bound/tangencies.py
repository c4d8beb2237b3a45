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
disc; the unhindered time is no more than that takes.

Before the helicopter cruises a contact is one of a pose at a time. What is left from the *first*
of these is taken to be the unhindered time. The *last* of these can have been reached in its time,
past the helicopter, and from there it is a clear word to the slot, or to a first contact in cruise.
Both bound the paths that have such contacts.

Contacts are taken on a grid. A path's contacts lie up to half a step away from it: since the time
by a contact is least at the best one, that matters in the second order only, and words count as
clear, and as possible, by a tolerance that covers such a shift.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sar_estimator.common.pose import Pose
from sar_planner.paths.dubins import lengths_m, words
from sar_planner.paths.flight_path import CornerFrame, FloatArray
from sar_planner.paths.slot_intercept import PathBatch, radii_m
from sar_planner.prediction.forecast import Forecast, cruising
from sar_planner.prediction.separation import least_distances_m
from sar_planner.rejoin.rejoin import RejoinTask, timed_words
from sar_sim.trials.rejoin_bound.around import Around, Limits, seen_from
from sar_sim.trials.rejoin_bound.dubins_legs import clear_hops, first_clear_s

CONTACT_STEP_RAD = math.radians(1.5)
NEAR_RAD = math.radians(12.0)
TOLERANCE_M = 2.0
WORD_STEP_S = 0.1
HORIZON_S = 150.0
MOVING_STEP_S = 0.5
MOVING_STEP_RAD = math.radians(2.0)
MOVING_SLACK_M = 5.0
DIFFERENCE_S = 0.01
WORDS = 128
CHUNK = 256
CLOSE_SHARE = 1.03
PAIRS = 20000


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

            tables = np.zeros((len(i), 7, 1))
            tables[:, 1:3, 0] = about[:, :2]
            tables[:, 3, 0], tables[:, 4, 0] = np.cos(about[:, 3]), np.sin(about[:, 3])
            tables[:, 5, 0] = limits.slot_mps
            high = most_s[i] - least_s[j]
            met = limits.first_fit_s(seen, low[i, j], high)
            far = apart[part] > NEAR_RAD
            high[~far] = -math.inf
            clear = first_clear_s(seen, met, high, tables, 0.0, *_kept(limits))
            hops[i, j] = np.where(far, clear, met)
        return hops


def hindered_s(task: RejoinTask, contacts: Contacts, upper_s: float) -> float:
    """Return the least time [s] by a clear word or by contacts, at most ``upper_s``."""
    best = min(upper_s, clear_word_s(task, upper_s))
    best = _by_cruise_contact_s(task, contacts, best)
    if task.forecast.steady_s <= task.start_s:
        return best
    moving = _moving_contacts(task, contacts.limits, best)
    first = _by_first_moving_contact_s(task, contacts.limits, moving, best)
    if first * CLOSE_SHARE >= best:
        return first
    return _by_last_moving_contact_s(task, contacts, moving, best, enough_s=first)


def _kept(limits: Limits) -> tuple[tuple[float, float, float], FloatArray, float]:
    """Return speeds, the parts' radii and the distance to keep, as hops take them."""
    speeds = (limits.slot_mps, limits.slowest_mps, limits.fastest_mps)
    return speeds, radii_m(limits.turn_radius_m), limits.separation_m - TOLERANCE_M


def _helicopter_seen(forecast: Forecast, here: Pose) -> FloatArray:
    """Return the helicopter's forecast as seen from a pose, shape (7, m)."""
    return forecast.in_frame(CornerFrame(here, 1)).table


def _start(task: RejoinTask) -> FloatArray:
    return np.array([[task.ahead_m, task.start.y_m, task.start.heading_rad]])


def _by_cruise_contact_s(task: RejoinTask, contacts: Contacts, upper_s: float) -> float:
    """Return the least time by a first contact while the helicopter cruises."""
    limits, poses, left = contacts.limits, contacts.poses, contacts.left_s
    start = _start(task)
    low = limits.straight_s(poses[:, :2] - start[:, :2])
    low = np.maximum(low, task.forecast.steady_s - task.start_s)
    order = np.argsort(low + left, kind="stable")
    helicopter = _helicopter_seen(task.forecast, task.start)
    best = upper_s
    for begin in range(0, len(order), CHUNK):
        chosen = order[begin : begin + CHUNK]
        if low[chosen[0]] + left[chosen[0]] >= best:
            break
        seen = seen_from(np.repeat(start, len(chosen), axis=0), poses[chosen])
        high = best - left[chosen]
        met = limits.first_fit_s(seen, low[chosen], high)
        clear = first_clear_s(seen, met, high, helicopter[None], task.start_s, *_kept(limits))
        best = min(best, float((clear + left[chosen]).min()))
    return best


class _Moving(NamedTuple):
    """Contacts before the helicopter cruises: their times from the start, shape (n,) [s].

    ``poses``: in the slot's frame then, shape (n, 3); ``low_s``: the least times that are left from
    there, by straight ways.
    """

    times_s: FloatArray
    poses: FloatArray
    low_s: FloatArray


def _moving_contacts(task: RejoinTask, limits: Limits, upper_s: float) -> _Moving:
    """Return the contacts before the helicopter cruises that a path of ``upper_s`` [s] can have."""
    forecast, start = task.forecast, _start(task)
    each = np.arange(0.0, forecast.steady_s - task.start_s, MOVING_STEP_S)
    angles = np.arange(0.0, 2.0 * math.pi - 1e-9, MOVING_STEP_RAD)
    times, angles = (g.ravel() for g in np.meshgrid(each, angles, indexing="ij"))
    at = task.start_s + times
    before, after = (forecast.positions(at + d) for d in (-DIFFERENCE_S, DIFFERENCE_S))
    headings = tangent_headings(angles, (after - before) / (2.0 * DIFFERENCE_S), limits)
    slot_x = forecast.leg.x_m + forecast.speed_mps * (at - forecast.zero_s)
    around = np.column_stack((np.cos(angles), np.sin(angles)))
    touched = forecast.positions(at) + limits.separation_m * around
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
    return _Moving(times[near], poses[near], low[near])


def _clear_from(
    task: RejoinTask, limits: Limits, begin: FloatArray, begun_s: float, moving: _Moving
) -> NDArray[np.bool_]:
    """Return which contacts are met in their times by a clear word from a pose, shape (3,).

    ``begin``: in the slot's frame, ``begun_s`` [s] after the start.
    """
    at_s = task.start_s + begun_s
    here = Pose(begin[0] + task.forecast.slot_x_m(at_s), begin[1], begin[2])
    speeds, radii, clear_m = _kept(limits)
    return clear_hops(
        seen_from(np.repeat(begin[None, :], len(moving.poses), axis=0), moving.poses),
        moving.times_s - begun_s,
        _helicopter_seen(task.forecast, here),
        at_s,
        speeds,
        MOVING_SLACK_M,
        radii,
        clear_m,
    )


def _by_first_moving_contact_s(
    task: RejoinTask, limits: Limits, moving: _Moving, upper_s: float
) -> float:
    """Return the least time by a first contact before the helicopter cruises."""
    start, best = _start(task)[0], upper_s
    times, poses, low = moving
    order = np.argsort(times + low, kind="stable")
    for begin in range(0, len(order), CHUNK):
        chosen = order[begin : begin + CHUNK]
        if times[chosen[0]] + low[chosen[0]] >= best:
            break
        part = _Moving(times[chosen], poses[chosen], low[chosen])
        chosen = chosen[_clear_from(task, limits, start, 0.0, part)]
        slots = seen_from(poses[chosen], np.zeros((len(chosen), 3)))
        left = limits.first_fit_s(slots, low[chosen], best - times[chosen])
        best = min(best, float((times[chosen] + left).min(initial=math.inf)))
    return best


def _reached(task: RejoinTask, limits: Limits, moving: _Moving) -> NDArray[np.bool_]:
    """Return which contacts can be reached in their times, past the helicopter, one by one."""
    times, poses, low = moving
    reached = _clear_from(task, limits, _start(task)[0], 0.0, moving)
    for i in np.argsort(times, kind="stable"):
        if reached[i]:
            left = np.flatnonzero(~reached & (times > times[i]))
            part = _Moving(times[left], poses[left], low[left])
            reached[left] = _clear_from(task, limits, poses[i], float(times[i]), part)
    return reached


def _by_last_moving_contact_s(
    task: RejoinTask, contacts: Contacts, moving: _Moving, upper_s: float, *, enough_s: float
) -> float:
    """Return the least time by a last contact before the helicopter cruises.

    It is not looked for below ``enough_s``.
    """
    limits, forecast = contacts.limits, task.forecast
    there = moving.poses.copy()
    there[:, 0] += forecast.slot_x_m(task.start_s) + limits.slot_mps * moving.times_s
    lengths = lengths_m(words(task.start, there, limits.turn_radius_m), limits.turn_radius_m)
    shortest_m = np.fmin.reduce(lengths, axis=0)
    can = shortest_m <= limits.fastest_mps * moving.times_s + MOVING_SLACK_M
    moving, there = _Moving(*(part[can] for part in moving)), there[can]
    least = moving.times_s + limits.to_slot_s(moving.poses)
    least[~_reached(task, limits, moving)] = math.inf
    best = upper_s
    for i in np.argsort(least, kind="stable"):
        if least[i] >= best or best <= enough_s:
            break
        begun, (x, y, heading) = float(moving.times_s[i]), there[i].tolist()
        rest = replace(task, start=Pose(x, y, heading), start_s=task.start_s + begun)
        left = min(best - begun, clear_word_s(rest, best - begun))
        best = begun + _by_cruise_contact_s(rest, contacts, left)
    return max(best, enough_s)


@lru_cache(maxsize=2)
def contacts_of(limits: Limits) -> Contacts:
    """Return the contacts, solved once for all starts."""
    return Contacts(limits)
