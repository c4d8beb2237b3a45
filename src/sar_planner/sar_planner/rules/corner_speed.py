"""Flying faster in a corner: which speeds a corner is planned with, and what is left to catch up.

Until a slow-down is seen and a list flown the UAV flies on, and most of what a weave leaves
uncovered comes of having to be back in time. Faster than the helicopter, it has time to pass over
more.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from sar_planner.guidance.wind_triangle import LEAST_TRIM, AirEnvelope
from sar_planner.parameters.corner import CornerParameters
from sar_planner.rules.deadbeat_rules import CONVERGED_M, DeadbeatRules
from sar_planner.rules.paper_rules import CornerPlan, NoPathError, Rule


def speed_ups_of(air: AirEnvelope, speed_mps: float, trim: float) -> tuple[float, ...]:
    """Return the speeds a corner is planned with, over V, the most wanted one first.

    Beside V, up to ``trim`` above it: as much as the UAV can make good on any course.
    """
    most = air.speeds_mps(speed_mps, trim)[1] / speed_mps
    return (most, 1.0) if most > 1.0 + LEAST_TRIM else (1.0,)


def sped_up_plan(
    parameters: CornerParameters,
    lag_m: float,
    *,
    lead_m: float,
    separations_m: Sequence[float],
    speed_ups: Sequence[float],
    path_efficiency: float,
    turn_rad: float = 0.5 * math.pi,
    aim_m: float = 0.0,
) -> tuple[CornerPlan, float] | None:
    """Return the plan of a corner and how much faster than V it is flown; None where there is none.

    The first separation and speed, in the order given, at which no lag is left but ``aim_m``; else
    what comes nearest to that. Only weaves are flown faster: they see more by it. ``turn_rad``: the
    size of the turn. Raises ``NoPathError`` for one that the rules are not for.
    """
    found: tuple[CornerPlan, float] | None = None
    for separation in separations_m:
        for speed_up in speed_ups:
            share = path_efficiency * speed_up
            rules = DeadbeatRules(parameters, path_efficiency=share, turn_rad=turn_rad, aim_m=aim_m)
            only = Rule.D4 if speed_up > 1.0 else None
            try:
                plan = rules.plan(lag_m, lead_m=lead_m, separation_m=separation, only=only)
            except NoPathError:
                continue
            left_m = abs(plan.next_lag_m - aim_m)
            if left_m <= CONVERGED_M:
                return plan, speed_up
            if found is None or left_m < abs(found[0].next_lag_m - aim_m) - CONVERGED_M:
                found = plan, speed_up
    return found


def catching_up_mps(
    path_m: float, lag_m: float, speed_mps: float, *, speed_up: float, share: float, most_mps: float
) -> float:
    """Return the speed that takes a lag out along a path, at most ``most_mps``.

    ``speed_up``: the speed the path is planned with, over V; ``share``: of it that is made good.
    """
    share_m = lag_m * share / max(path_m, 1.0)
    planned_mps = speed_mps * speed_up
    return min(planned_mps / max(1e-3, 1.0 - share_m), max(planned_mps, most_mps))
