"""A lower bound on the time in which the moving slot can be rejoined.

The largest of four, each of which no flyable path that keeps the separation can beat:

* *Unhindered*: until some Dubins word meets the slot at a speed within the limits, the slot has not
  come into what can be reached; the boundary of the poses that paths of exactly some length reach
  is made of these words (Patsko, Pyatko, Fedotov 2003).
* *Around* (``around``): in cruise, by a point without turn radius around the disc that is
  kept free.
* *Gate* (``line_crossings``): by the poses in which the helicopter's line can be crossed.
* *Contact* (``tangencies``): the soonest path touches the disc or is a word that stays clear
  of it; where it touches, it is tangent to the disc, and what is left from there is known.

The least over gates and contacts is taken on grids, between whose poses a path can be a little
sooner than by any of them; ``GRID_SHARE`` of it is taken for the bound.
"""

from __future__ import annotations

import math

import numpy as np

from sar_planner.paths.dubins import lengths_m
from sar_planner.rejoin.rejoin import RejoinTask, timed_words
from sar_sim.trials.rejoin_bound.around import Limits
from sar_sim.trials.rejoin_bound.line_crossings import gates_of
from sar_sim.trials.rejoin_bound.tangencies import contacts_of, hindered_s

UNHINDERED_STEP_S = 0.02
CLOSE_SHARE = 1.03
GRID_SHARE = 0.995


def unhindered_s(task: RejoinTask) -> float:
    """Return the least time [s] in which any path of this radius meets the slot, helicopter aside.

    Rounded down to a grid of ``UNHINDERED_STEP_S``; infinite when the slot is never met.
    """
    rows, speeds = timed_words(task, UNHINDERED_STEP_S)
    if len(rows) == 0:
        return math.inf
    first = float(lengths_m(rows[:1], task.turn_radius_m)[0] / speeds[0])
    return first - UNHINDERED_STEP_S


def lower_bound_s(task: RejoinTask, upper_s: float) -> float:
    """Return a time [s] in which the slot cannot be rejoined by less.

    ``upper_s``: of some path that is flyable; a bound above it is not looked for, nor a better one
    than one within ``CLOSE_SHARE`` of it. Infinite where the slot is never met.
    """
    bound = unhindered_s(task)
    if CLOSE_SHARE * bound >= upper_s:
        return bound
    limits = Limits.of(task)
    contacts = contacts_of(limits)
    if task.forecast.steady_s <= task.start_s:
        here = np.array([[task.ahead_m, task.start.y_m]])
        bound = max(bound, float(contacts.around.times_s(here)[0]))
    if task.start.y_m > limits.spacing_m:
        bound = max(bound, GRID_SHARE * gates_of(limits).bound_s(task, upper_s))
    if CLOSE_SHARE * bound >= upper_s:
        return bound
    return max(bound, GRID_SHARE * hindered_s(task, contacts, upper_s))
