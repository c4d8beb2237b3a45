"""The parameters of a corner and the conditions under which the four rules hold."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from sar_estimator.common.checked import CHECKED, Positive

RULE_SETS = ("deadbeat", "paper")
PLANNERS = (*RULE_SETS, "follow")


class ParameterError(ValueError):
    """A parameter out of bounds; the message names it, its value and what was expected."""


@dataclass(frozen=True, slots=True, config=CHECKED)
class CornerParameters:
    """One corner's parameters (Ryan & Hedrick 2005, section IV, for the defaults).

    speed_mps: V, nominal speed of both aircraft [m/s].
    turn_radius_m: R, radius the UAV's path is planned with [m].
    accel_mps2: a, magnitude of the helicopter's acceleration at a corner [m/s^2].
    spacing_m: d, distance between the parallel tracks [m].
    convergence: c, rate of the convergent rule.
    min_clearance_s: T_d of (13), the least time between the aircraft where paths cross [s].
    taylor_y_m: y_o of (9) [m]: the paper's Taylor step instead of the exact root.
    min_separation_m: least distance between the aircraft that the deadbeat rules may plan [m];
        0.8 d where it is not set.
    """

    speed_mps: Positive = 20.0
    turn_radius_m: Positive = 100.0
    accel_mps2: Positive = 2.5
    spacing_m: Positive = 250.0
    convergence: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.5
    min_clearance_s: Positive = 10.0
    taylor_y_m: Positive | None = None
    min_separation_m: Positive | None = None

    def beside(self, tracks: int) -> CornerParameters:
        """Return the parameters of a slot so many tracks beside: its distance in ``spacing_m``."""
        if tracks == 1:
            return self
        least_m = self.separation_m
        return replace(self, spacing_m=tracks * self.spacing_m, min_separation_m=least_m)

    @property
    def separation_m(self) -> float:
        """The least distance between the aircraft that may be planned [m]."""
        return 0.8 * self.spacing_m if self.min_separation_m is None else self.min_separation_m

    @property
    def stopping_m(self) -> float:
        """Stopping distance s = V^2 / 2a [m]."""
        return self.speed_mps**2 / (2.0 * self.accel_mps2)

    @property
    def fixed_lag_m(self) -> float:
        """L0 = ((5 pi/2 - 4) R - 4 s) / (1 + c) [m], the lower end of T2's domain (5)."""
        r, s = self.turn_radius_m, self.stopping_m
        return ((2.5 * math.pi - 4.0) * r - 4.0 * s) / (1.0 + self.convergence)

    @property
    def cut_lag_m(self) -> float:
        """S + 2 d + (2 - pi/2) R [m], the lower end of T1's domain (4)."""
        r, d = self.turn_radius_m, self.spacing_m
        return self.stopping_m + 2.0 * d + (2.0 - math.pi / 2.0) * r


def track_spacing_m(altitude_m: float, sweep_rad: float, redundancy: float) -> float:
    """Return d = 2 (1 - f) A tan(beta / 2) [m], equation (1)."""
    return 2.0 * (1.0 - redundancy) * altitude_m * math.tan(sweep_rad / 2.0)


def clearance_times_s(p: CornerParameters) -> tuple[float, float]:
    """Return the exact minima of T_1 and T_2 [s] over the crossing angle.

    cos(alpha) + alpha rises from 1 to pi/2 on [0, pi/2], so min T_1 is at alpha = 0 and min T_2 at
    alpha = pi/2. The paper's (13) lies above min T_1 and is not conservative.
    """
    v, r, d = p.speed_mps, p.turn_radius_m, p.spacing_m
    base = 1.5 * v / p.accel_mps2 + (d + r) / v
    return base + r * (1.0 - math.pi) / v, base - r * math.pi / (2.0 * v)


def check(p: CornerParameters) -> None:
    """Refuse parameters for which the four rules are undefined or break their own conditions.

    Raises ``ParameterError`` naming the parameter, its value and the bound: (11), (12) with its
    relation sign corrected, (13) with the exact minima, and what the rules' geometry needs.
    """
    r, s, d, c = p.turn_radius_m, p.stopping_m, p.spacing_m, p.convergence
    if d <= r:
        raise ParameterError(
            f"spacing_m = {d}: expected more than turn_radius_m = {r} (outside loop, 10)"
        )
    if s + p.cut_lag_m - d - r < 0.0:
        raise ParameterError(
            f"turn_radius_m = {r}: expected at most {(2 * s + d) / (math.pi / 2 - 1):.1f} "
            "(cut corner, 4)"
        )
    ratio_bound = (2.5 * math.pi - 5.0 - c) / (3.0 - c)
    if s / r >= ratio_bound:
        least = p.speed_mps**2 / (2.0 * ratio_bound * r)
        raise ParameterError(
            f"accel_mps2 = {p.accel_mps2}: expected more than {least:.4f}, so that "
            f"V^2/(2aR) = {s / r:.4f} < {ratio_bound:.4f} (12, corrected; L0 > R - s, 11)"
        )
    clearance = min(clearance_times_s(p))
    if clearance <= p.min_clearance_s:
        raise ParameterError(
            f"min_clearance_s = {p.min_clearance_s}: expected less than {clearance:.3f}, "
            "the exact least time between the aircraft at a crossing (13)"
        )
    _check_convergent(p)


def _check_convergent(p: CornerParameters) -> None:
    """Check that T3's equation has a root with y >= 0 at the near end of its domain.

    The root's y falls as L rises; theta is largest at L -> -s. Both limits are tested on the
    shortest admissible curve, whose progression must not exceed c L.
    """
    r, s, d, c = p.turn_radius_m, p.stopping_m, p.spacing_m, p.convergence
    for lag in (-s, p.fixed_lag_m):
        reach = r + d - lag - s
        y_low = max(0.0, reach - 2.0 * r)
        sine = (reach - y_low) / (2.0 * r)
        theta = math.asin(min(1.0, max(-1.0, sine)))
        shortest = (2.5 * math.pi - 2 * theta - 3 - 2 * math.cos(theta)) * r + y_low - d - 3 * s
        if reach < 0.0 or shortest > c * lag:
            raise ParameterError(
                f"spacing_m = {d}: the convergent curve (7) cannot reach L(k+1) = cL at "
                f"L = {lag:.1f} (its shortest gives {shortest:.1f}, expected {c * lag:.1f} or less)"
            )
