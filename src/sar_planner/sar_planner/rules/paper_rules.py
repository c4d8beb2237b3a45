"""The four path rules of Ryan & Hedrick (2005), section III, in the corner's frame.

The frame: origin at the corner, x along the helicopter's old heading, a right turn, the UAV inside
on y = -d. When the helicopter begins to slow it is at (-s, 0) and the UAV at (-(s + L), -d); after
the turn the slot track is x = -d, flown towards -y.

Every rule accepts a lead-in: the distance the UAV will still have flown straight on, counted from
that moment, before it can begin to turn (detection and upload take time). A rule whose own straight
is longer ignores it; otherwise the curve starts later and its free parameter makes up for it.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass

from sar_estimator.common.pose import Pose
from sar_planner.parameters.corner import CornerParameters
from sar_planner.paths.flight_path import Arc, FlightPath, Straight

HALF_PI = math.pi / 2.0


class Rule(enum.StrEnum):
    """The path rules: T1 to T4 in the paper's numbering, D1 to D4 of the deadbeat set.

    O1 to O3 lead to a place outside of the turn. RJ stands for a corner that is begun from anywhere
    but the slot track.
    """

    T1 = "T1"
    T2 = "T2"
    T3 = "T3"
    T4 = "T4"
    D1 = "D1"
    D2 = "D2"
    D3 = "D3"
    D4 = "D4"
    O1 = "O1"
    O2 = "O2"
    O3 = "O3"
    RJ = "RJ"

    @property
    def label(self) -> str:
        """The rule's name; the paper's for the paper's."""
        return {
            Rule.T1: "cut corner",
            Rule.T2: "fixed curve",
            Rule.T3: "convergent",
            Rule.T4: "outside loop",
            Rule.D1: "cut corner",
            Rule.D2: "adjustable curve",
            Rule.D3: "outside loop",
            Rule.D4: "weave",
            Rule.O1: "outer corner",
            Rule.O2: "outer corner cut",
            Rule.O3: "over to the outside",
            Rule.RJ: "rejoin",
        }[self]


OUTSIDE = (Rule.O1, Rule.O2, Rule.O3)
"""The rules that lead to a place outside of the turn."""


class NoPathError(ValueError):
    """No path of the rule exists; the message says which value is out of which bound."""


@dataclass(frozen=True)
class CornerPlan:
    """A path for one corner, from the moment the helicopter begins to slow.

    ``path`` begins at (-(s + L), -d) and ends on the new slot track, heading towards -y.
    """

    rule: Rule
    lag_m: float
    next_lag_m: float
    path: FlightPath
    parameters: CornerParameters

    @property
    def turn_start_m(self) -> float:
        """Path distance [m] at which the UAV begins to turn."""
        first = self.path.segments[0]
        return first.length_m if isinstance(first, Straight) else 0.0


def next_lag_m(path: FlightPath, p: CornerParameters) -> float:
    """L(k+1) = l - Y - 3 s [m] from (2) for any path that ends on the new slot track."""
    return path.length_m + path.end.y_m - 3.0 * p.stopping_m


def convergent_theta_rad(y_m: float, lag_m: float, p: CornerParameters) -> float:
    """Return theta(k) [rad] of (7). Raises ``NoPathError`` outside the arcsine's domain."""
    sine = (p.turn_radius_m + p.spacing_m - lag_m - y_m - p.stopping_m) / (2.0 * p.turn_radius_m)
    if abs(sine) > 1.0 + 1e-12:
        raise NoPathError(f"straight y = {y_m:.1f} m at L = {lag_m:.1f} m: no tangent arcs")
    return math.asin(max(-1.0, min(1.0, sine)))


def convergent_progression_m(y_m: float, lag_m: float, p: CornerParameters) -> float:
    """Return f(L, y) [m], the L(k+1) of (7)."""
    theta = convergent_theta_rad(y_m, lag_m, p)
    arcs = (2.5 * math.pi - 2.0 * theta - 3.0 - 2.0 * math.cos(theta)) * p.turn_radius_m
    return arcs + y_m - p.spacing_m - 3.0 * p.stopping_m


def convergent_slope(y_m: float, lag_m: float, p: CornerParameters) -> float:
    """Return df/dy of (8): 1 + (1 - sin theta) / cos theta."""
    theta = convergent_theta_rad(y_m, lag_m, p)
    return 1.0 + (1.0 - math.sin(theta)) / math.cos(theta)


def exact_straight_m(lag_m: float, target_m: float, p: CornerParameters) -> float:
    """Solve f(L, y) = target for y [m] by safeguarded Newton (f rises strictly with y).

    The bracket is y >= 0 with 0 <= theta < pi/2. Raises ``NoPathError`` when the target lies
    outside what the bracket reaches.
    """
    reach = p.turn_radius_m + p.spacing_m - lag_m - p.stopping_m
    low, high = max(0.0, reach - 2.0 * p.turn_radius_m * (1.0 - 1e-9)), reach
    if high < low:
        raise NoPathError(f"lag {lag_m:.1f} m: the curve would begin {-high:.1f} m too early")
    bounds = (
        convergent_progression_m(low, lag_m, p),
        convergent_progression_m(high, lag_m, p),
    )
    if not bounds[0] - 1e-9 <= target_m <= bounds[1] + 1e-9:
        raise NoPathError(
            f"L(k+1) = {target_m:.1f} m at L = {lag_m:.1f} m: "
            f"the curve reaches {bounds[0]:.1f} ... {bounds[1]:.1f} m"
        )
    y = 0.5 * (low + high)
    for _ in range(100):
        error = convergent_progression_m(y, lag_m, p) - target_m
        if abs(error) < 1e-10:
            break
        low, high = (low, y) if error > 0.0 else (y, high)
        newton = y - error / convergent_slope(y, lag_m, p)
        y = newton if low < newton < high else 0.5 * (low + high)
    return y


def taylor_straight_m(lag_m: float, target_m: float, y_o_m: float, p: CornerParameters) -> float:
    """Return y(k) [m] by the paper's single Taylor step (9) about ``y_o_m``."""
    error = target_m - convergent_progression_m(y_o_m, lag_m, p)
    return y_o_m + error / convergent_slope(y_o_m, lag_m, p)


def _start(lag_m: float, p: CornerParameters) -> Pose:
    return Pose(-(p.stopping_m + lag_m), -p.spacing_m, 0.0)


def _curve(lag_m: float, lead_m: float, y_m: float, p: CornerParameters) -> FlightPath:
    """S(lead) R(pi) S(y) L(pi - theta) R(pi/2 - theta)."""
    r = p.turn_radius_m
    theta = convergent_theta_rad(y_m, lag_m - lead_m, p)
    return FlightPath.of(
        _start(lag_m, p),
        (
            Straight(lead_m),
            Arc(r, -math.pi),
            Straight(y_m),
            Arc(r, math.pi - theta),
            Arc(r, -(HALF_PI - theta)),
        ),
    )


def _cut_corner(lag_m: float, lead_m: float, p: CornerParameters) -> FlightPath:
    straight = p.stopping_m + lag_m - p.spacing_m - p.turn_radius_m
    if lead_m > straight:
        raise NoPathError(f"lead-in {lead_m:.1f} m: the corner is cut {straight:.1f} m on")
    return FlightPath.of(_start(lag_m, p), (Straight(straight), Arc(p.turn_radius_m, -HALF_PI)))


def _fixed_curve(lag_m: float, lead_m: float, p: CornerParameters) -> FlightPath:
    straight = lag_m - p.fixed_lag_m
    if lead_m <= straight:
        y = p.turn_radius_m + p.spacing_m - p.fixed_lag_m - p.stopping_m
        if y < 0.0:
            raise NoPathError(f"fixed curve: its straight would be y = {y:.1f} m")
        return _curve(lag_m, straight, y, p)
    target = lag_m - (1.0 - p.convergence) * p.fixed_lag_m
    return _curve(lag_m, lead_m, exact_straight_m(lag_m - lead_m, target - lead_m, p), p)


def _convergent(lag_m: float, lead_m: float, p: CornerParameters) -> FlightPath:
    target = p.convergence * lag_m - lead_m
    if p.taylor_y_m is None:
        y = exact_straight_m(lag_m - lead_m, target, p)
    else:
        y = taylor_straight_m(lag_m - lead_m, target, p.taylor_y_m, p)
        if y < 0.0:
            raise NoPathError(f"Taylor step (9) about {p.taylor_y_m} m gives y = {y:.1f} m")
    return _curve(lag_m, lead_m, y, p)


def _outside_loop(lag_m: float, lead_m: float, p: CornerParameters) -> FlightPath:
    r = p.turn_radius_m
    ahead = p.spacing_m - r - p.stopping_m - (lag_m - lead_m)
    if ahead <= 0.0:
        raise NoPathError(f"lag {lag_m:.1f} m: the outside loop needs the UAV past the corner")
    psi = math.atan2(r, ahead)
    return FlightPath.of(
        _start(lag_m, p),
        (
            Straight(lead_m),
            Arc(r, math.pi + psi),
            Straight(math.hypot(r, ahead)),
            Arc(r, HALF_PI - psi),
        ),
    )


_BUILDERS = {
    Rule.T1: _cut_corner,
    Rule.T2: _fixed_curve,
    Rule.T3: _convergent,
    Rule.T4: _outside_loop,
}


def build(rule: Rule, lag_m: float, p: CornerParameters, *, lead_m: float = 0.0) -> CornerPlan:
    """Build the plan of one rule for lag L [m], the UAV turning no earlier than ``lead_m`` [m].

    Raises ``NoPathError`` when the rule has no such path, ``KeyError`` for the deadbeat rules.
    """
    path = _BUILDERS[rule](lag_m, max(0.0, lead_m), p)
    return CornerPlan(rule, lag_m, next_lag_m(path, p), path, p)
