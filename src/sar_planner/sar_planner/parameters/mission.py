"""How the planner flies, beside the corner's own parameters."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sar_planner.parameters.corner import ParameterError


@dataclass(frozen=True, slots=True)
class MissionParameters:
    """How the planner flies (metres and seconds).

    turn_side: 1 for right-turn patterns, -1 for left. rules: rule set. arc_spacing_m: between
    waypoints on arcs, 0 for arc ends only, for autopilots that fly the waypoints' polygon;
    guide_spacing_m: between those for an L1-guided autopilot. turn_share: its turn rate at a
    bank, over a coordinated turn's. roll_lag_s: from its demand to the bank. speed_lead_s: how
    far ahead of the UAV the airspeed is chosen for. reaction_s: from a decision to the autopilot
    flying the new list. horizon_m: how far ahead of the UAV the list reaches. slot_tolerance_m:
    shift of the slot track that is worth a new list at once, half of it every 550 m later, down
    to 0.3. capture_m: from the UAV to the first waypoint of a slot track. loiter_radius_m: of the
    circle a list ends in, as flown. stale_s: age at which a position is no longer planned with.
    speed_range: speeds of the helicopter, relative to V, that the rules are used for;
    accel_range: decelerations likewise. speed_trim: share of V by which the UAV may be asked to
    fly faster or slower (deadbeat rules); corner_hurry: by which it flies faster in weaves.
    trim_gain: speed asked for per metre of lag [1/s]; trim_follow: share of what the helicopter
    flies faster at present than on average that is asked for too. corner_tolerance_m: by which
    the stop ahead, or V times its time, must change to be planned anew. lag_tolerance_m:
    predicted lag at the end of a path that is worth a correction, and far_tolerance: at least
    this share of what is left of it. correction_s: least time between two corrections;
    settling_s: for how long after one the UAV may be beside its new path, and nearer than the
    margin to the helicopter, without another. ahead_m: how far ahead of its slot the UAV may be
    on a leg before it is led back to it. separation_margin_m: planned beyond the least separation
    where that costs nothing. bias_gain: share of the newest corner's extra path in what is
    expected of the next.
    """

    turn_side: int = 1
    rules: str = "deadbeat"
    arc_spacing_m: float = 20.0
    guide_spacing_m: float = 30.0
    turn_share: float = 0.8
    roll_lag_s: float = 0.35
    speed_lead_s: float = 3.5
    reaction_s: float = 1.0
    horizon_m: float = 4000.0
    slot_tolerance_m: float = 10.0
    capture_m: float = 150.0
    loiter_radius_m: float = 100.0
    stale_s: float = 5.0
    speed_range: tuple[float, float] = (0.75, 1.25)
    accel_range: tuple[float, float] = (0.4, 60.0)
    speed_trim: float = 0.1
    corner_hurry: float = 0.1
    trim_gain: float = 0.15
    trim_follow: float = 0.5
    corner_tolerance_m: float = 12.0
    lag_tolerance_m: float = 60.0
    far_tolerance: float = 0.03
    correction_s: float = 2.0
    settling_s: float = 4.0
    ahead_m: float = 60.0
    separation_margin_m: float = 15.0
    bias_gain: float = 0.5

    def __post_init__(self) -> None:
        """Refuse values out of bounds, naming them."""
        if self.turn_side not in (1, -1):
            raise ParameterError(f"turn_side = {self.turn_side}: expected 1 (right) or -1 (left)")
        for name in (
            "arc_spacing_m",
            "reaction_s",
            "trim_gain",
            "trim_follow",
            "separation_margin_m",
            "roll_lag_s",
            "speed_lead_s",
            "far_tolerance",
            "correction_s",
            "settling_s",
        ):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ParameterError(f"{name} = {getattr(self, name)}: expected 0 or more")
        for name in (
            "guide_spacing_m",
            "turn_share",
            "horizon_m",
            "slot_tolerance_m",
            "capture_m",
            "loiter_radius_m",
            "stale_s",
            "corner_tolerance_m",
            "lag_tolerance_m",
            "ahead_m",
        ):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ParameterError(f"{name} = {getattr(self, name)}: expected more than 0")
        self._check_shares()
        for name in ("speed_range", "accel_range"):
            limits = getattr(self, name)
            if len(limits) != 2 or not 0.0 < limits[0] <= limits[1]:
                raise ParameterError(f"{name} = {limits}: expected two numbers, 0 < low <= high")

    def _check_shares(self) -> None:
        if not 0.0 < self.speed_trim < 0.5:
            raise ParameterError(f"speed_trim = {self.speed_trim}: expected more than 0, under 0.5")
        for name, most in (("corner_hurry", self.speed_trim), ("bias_gain", 1.0)):
            if not 0.0 <= getattr(self, name) <= most:
                raise ParameterError(f"{name} = {getattr(self, name)}: expected 0 to {most:g}")
