"""Flying faster in a corner: which speeds a corner is planned with, and what is left to catch up.

Until a slow-down is seen and a list flown the UAV flies on, and most of what a weave leaves
uncovered comes of having to be back in time. Faster than the helicopter, it has time to pass over
more.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from sar_planner.guidance.turn_radius import Turns
from sar_planner.guidance.wind_triangle import LEAST_TRIM, AirEnvelope
from sar_planner.parameters.corner import CornerParameters
from sar_planner.rules.deadbeat_rules import CONVERGED_M, DeadbeatRules
from sar_planner.rules.paper_rules import CornerPlan, NoPathError, Rule

LAG_STEP, LAG_STEPS = 0.2, 12
LAG_COST, LAG_WORTH = 0.5, 1.0
WIDE_SLOWER = (0.2, 0.1, 0.0)  # shares of V by which one that turns wide is flown slower


class CornerSpeed(NamedTuple):
    """A speed a corner is planned with, over V, and the turn radius at that speed [m].

    ``is_seen``: whether it is taken by what it sees; else the first that leaves no lag.
    """

    speed_up: float
    turn_radius_m: float
    is_seen: bool = False


def corner_speeds(
    air: AirEnvelope, speed_mps: float, trim: float, turns: Turns
) -> tuple[CornerSpeed, ...]:
    """Return the speeds a corner is planned with, the most wanted one first.

    Beside V, up to ``trim`` above it: as much as the UAV can make good on any course. One that
    turns wide may also be flown slower: where it turns tighter then, it sees more. One of which it
    is not known how it turns flies at V.
    """
    slowest = air.speeds_mps(speed_mps, max(WIDE_SLOWER))[0] / speed_mps
    fastest = air.speeds_mps(speed_mps, trim)[1] / speed_mps
    if turns.is_wide:
        wanted = (*(max(slowest, 1.0 - one) for one in WIDE_SLOWER), max(1.0, fastest))
        return tuple(
            CornerSpeed(one, turns.at_m(one), is_seen=True) for one in dict.fromkeys(wanted)
        )
    at_v = CornerSpeed(1.0, turns.radius_m)
    if not turns.is_sure or fastest <= 1.0 + LEAST_TRIM:
        return (at_v,)
    return CornerSpeed(fastest, turns.radius_m), at_v


def sped_up_plan(
    parameters: CornerParameters,
    lag_m: float,
    *,
    lead_m: float,
    separations_m: Sequence[float],
    speeds: Sequence[CornerSpeed],
    path_efficiency: float,
    turn_rad: float = 0.5 * math.pi,
    aim_m: float = 0.0,
    least_share: float = 1.0,
) -> tuple[CornerPlan, float] | None:
    """Return the plan of a corner and how much faster than V it is flown; None where there is none.

    The first separation and speed, in the order given, at which no lag is left but ``aim_m``; else
    what comes nearest to that. Only weaves are flown faster: they see more by it. Of speeds that
    are taken by what they see, the one that leaves the least out. ``turn_rad``: the size of the
    turn. ``least_share``: paths stay apart, too, with that share of what is expected. Raises
    ``NoPathError`` for a turn that the rules are not for.
    """
    found: tuple[CornerPlan, float] | None = None
    for separation in separations_m:
        seen: list[tuple[float, CornerPlan, float]] = []
        for speed_up, radius_m, is_seen in speeds:
            share = path_efficiency * speed_up
            at_speed = replace(parameters, turn_radius_m=radius_m)
            rules = DeadbeatRules(
                at_speed,
                path_efficiency=share,
                turn_rad=turn_rad,
                aim_m=aim_m,
                least_efficiency=least_share * share,
            )
            only = Rule.D4 if speed_up > 1.0 else None
            try:
                plan = rules.plan(lag_m, lead_m=lead_m, separation_m=separation, only=only)
            except NoPathError:
                continue
            left_m = abs(plan.next_lag_m - aim_m)
            if left_m <= CONVERGED_M:
                if not is_seen:
                    return plan, speed_up
                seen.append((rules.uncovered_m2(plan), plan, speed_up))
            if found is None or left_m < abs(found[0].next_lag_m - aim_m) - CONVERGED_M:
                found = plan, speed_up
        if seen:
            return min(seen, key=lambda one: one[0])[1:]
    return found


def lag_to_begin_with_m(
    parameters: CornerParameters,
    speeds: Sequence[CornerSpeed],
    *,
    lead_m: float,
    separation_m: float,
    path_efficiency: float,
    turn_rad: float = 0.5 * math.pi,
) -> float:
    """Return the lag [m], 0 or more, with which a corner is best begun; 0 where none can be.

    A UAV that makes good little of its speed cannot take any out from L = 0: it is then on the
    far side of the helicopter's new leg, and has no time to come back across it. One that turns
    wide can, and leaves much out. A lag is kept where there is no path without one, or where it
    saves more than ``LAG_WORTH`` d^2 of a corner: the one that costs the least, by what is left
    out, over d^2, and ``LAG_COST`` of the lag, over d.
    """
    d_m, at_zero, best = parameters.spacing_m, math.inf, (math.inf, 0.0)
    for count in range(LAG_STEPS):
        lag_m = count * LAG_STEP * d_m
        if LAG_COST * lag_m / d_m >= best[0]:
            break
        planned = sped_up_plan(
            parameters,
            lag_m,
            lead_m=lead_m,
            separations_m=(separation_m,),
            speeds=speeds,
            path_efficiency=path_efficiency,
            turn_rad=turn_rad,
            aim_m=lag_m,
        )
        if planned is None or abs(planned[0].next_lag_m - lag_m) > CONVERGED_M:
            continue
        plan = planned[0]
        rules = DeadbeatRules(plan.parameters, turn_rad=turn_rad)
        cost = rules.uncovered_m2(plan) / d_m**2 + LAG_COST * lag_m / d_m
        at_zero = cost if count == 0 else at_zero
        best = min(best, (cost, lag_m))
    return best[1] if at_zero - best[0] > LAG_WORTH or math.isinf(at_zero) else 0.0


def catching_up_mps(
    path_m: float, lag_m: float, speed_mps: float, *, speed_up: float, share: float, most_mps: float
) -> float:
    """Return the speed that takes a lag out along a path, at most ``most_mps``.

    ``speed_up``: the speed the path is planned with, over V; ``share``: of it that is made good.
    """
    share_m = lag_m * share / max(path_m, 1.0)
    planned_mps = speed_mps * speed_up
    return min(planned_mps / max(1e-3, 1.0 - share_m), max(planned_mps, most_mps))
