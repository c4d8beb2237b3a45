"""How the planner flies, beside the corner's own parameters."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field
from pydantic.dataclasses import dataclass

from sar_estimator.common.checked import (
    CHECKED,
    NotNegative,
    Positive,
    PositiveRange,
    Share,
    Side,
)
from sar_planner.patterns.legs import PatternKind, PatternTerms
from sar_planner.patterns.slot import INSIDE, Slot, SlotSide, SlotTracks


@dataclass(frozen=True, slots=True, config=CHECKED)
class MissionParameters:
    """How the planner flies (metres and seconds).

    pattern: expanding_square, sector, parallel_track, creeping_line, track_line,
        track_line_return, or none: what is expected of the helicopter, leg by leg; of none that
        all turns are to one side.
    turn_side: to which side its first leg ends, 1 right, -1 left.
    first_leg_m: of the pattern: the first leg of an expanding square, the radius of a sector
        search, the search legs of the others; 0 for not known.
    track_spacing_m: of the pattern: between the helicopter's neighbouring tracks.
    pattern_leg: which of its legs is flown, from 1, and counted on from; 0 for the first.
    slot_side: inside or outside of the turn at a leg's end, or always to the right or left of the
        helicopter.
    slot_tracks: the slot's distance from the helicopter's track, over `spacing_m`.
    layer_separation_m: UAVs that are at least so much apart in altitude need not be so
        horizontally (deadbeat).
    rules: deadbeat, paper, or follow.
    arc_spacing_m: between waypoints on arcs; 0 for arc ends only.
    guide_spacing_m: between waypoints where the guide of an L1-guided autopilot bends.
    turn_share: an L1-guided autopilot's turn rate at a bank, over that of a coordinated turn.
    roll_lag_s: from its demand to the bank.
    speed_lead_s: how far ahead of the UAV the airspeed asked for is chosen.
    reaction_s: from a decision to the autopilot flying the new list; where that is measured to take
        half a second longer, as long as it does.
    most_reaction_s: of what is measured of it, planned with at most.
    late_fix_s: age of fixes when they are planned with, from which on that is told.
    horizon_m: how far ahead of the UAV its list reaches.
    slot_tolerance_m: shift of the slot track that is worth a new list at once; half of it every
        550 m later, down to 0.3 of it.
    capture_m: from the UAV to the first waypoint on the slot track.
    loiter_radius_m: of the circle a list ends in, as flown: it is laid beside the slot track.
    stale_s: age at which a position is no longer planned with.
    speed_range: the helicopter's speeds, relative to V, that the rules are used for.
    accel_range: its decelerations, relative to a; a corner that is rolled is told as a short
        stop.
    speed_trim: share of V by which the UAV may be asked to fly faster or slower (deadbeat).
    outside_speed_up: share of V by which a UAV outside of the turns may be asked to fly faster, in
        them and on legs: it has the longer way (deadbeat).
    corner_speed_up: share of V by which it flies faster in weaves, at most speed_trim.
    trim_gain: speed asked for per metre of lag, 1/s (deadbeat).
    trim_follow: share of what the helicopter flies faster now than on average that is asked for
        too (deadbeat).
    corner_tolerance_m: by which the stop ahead, or V times its time, must change to be planned
        anew (deadbeat).
    lag_tolerance_m: lag predicted for the end of a path that is worth a correction (deadbeat).
    far_tolerance: at least this share of what is left of the path is worth a correction
        (deadbeat).
    correction_s: least time between two corrections (deadbeat).
    settling_s: for how long after a correction the UAV may be beside its new path, and nearer
        to the helicopter than the margin beyond `min_separation_m`, without another one
        (deadbeat).
    ahead_m: how far ahead of its slot the UAV may be on a leg before it is led back (deadbeat).
    separation_margin_m: planned beyond the least separation where that costs nothing
        (deadbeat).
    bias_gain: share of the newest corner in the extra path expected of the next (deadbeat).
    off_path_m: beside its path, beyond which a UAV is not on it (deadbeat).
    low_efficiency: share of its speed that a UAV makes good along its path, below which it begins a
        corner with a lag (deadbeat).
    detection_s: from a corner's onset to its detection, as a rule (deadbeat).
    retry_s: from a list that did not pass, or a way that was not found, to the next try.
    farthest_m: between the aircraft, beyond which nothing is planned.
    orbit_radius_m: of the circle about a mark; more than the least separation and its margin.
    same_mark_m: within which what is marked is a mark that is there already, moved.
    """

    CHANGEABLE: ClassVar[frozenset[str]] = frozenset({"slot_side", "slot_tracks", "pattern_leg"})

    turn_side: Side = 1
    rules: str = "deadbeat"
    arc_spacing_m: NotNegative = 20.0
    guide_spacing_m: Positive = 30.0
    turn_share: Positive = 0.8
    roll_lag_s: NotNegative = 0.35
    speed_lead_s: NotNegative = 3.5
    reaction_s: NotNegative = 1.0
    most_reaction_s: NotNegative = 5.0
    late_fix_s: Positive = 1.5
    horizon_m: Positive = 4000.0
    slot_tolerance_m: Positive = 10.0
    capture_m: Positive = 150.0
    loiter_radius_m: Positive = 100.0
    stale_s: Positive = 5.0
    speed_range: PositiveRange = (0.75, 1.25)
    accel_range: PositiveRange = (0.4, 60.0)
    speed_trim: Annotated[float, Field(gt=0.0, lt=0.5)] = 0.1
    corner_speed_up: NotNegative = 0.1
    trim_gain: NotNegative = 0.15
    trim_follow: NotNegative = 0.5
    corner_tolerance_m: Positive = 12.0
    lag_tolerance_m: Positive = 60.0
    far_tolerance: NotNegative = 0.03
    correction_s: NotNegative = 2.0
    settling_s: NotNegative = 4.0
    ahead_m: Positive = 60.0
    separation_margin_m: NotNegative = 15.0
    bias_gain: Share = 0.5
    off_path_m: Positive = 20.0
    low_efficiency: Share = 0.85
    detection_s: NotNegative = 4.0
    retry_s: NotNegative = 2.0
    farthest_m: Positive = 20_000.0
    orbit_radius_m: Positive = 300.0
    same_mark_m: NotNegative = 100.0
    pattern: PatternKind = "expanding_square"
    first_leg_m: NotNegative = 0.0
    track_spacing_m: NotNegative = 500.0
    pattern_leg: Annotated[int, Field(ge=0)] = 0
    slot_side: SlotSide = "inside"
    slot_tracks: SlotTracks = 1
    layer_separation_m: Positive = 30.0
    outside_speed_up: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.4

    @property
    def terms(self) -> PatternTerms:
        """The pattern."""
        return PatternTerms(self.pattern, self.turn_side, self.first_leg_m, self.track_spacing_m)

    @property
    def slot(self) -> Slot:
        """The UAV's place in the formation."""
        return Slot(self.slot_side, self.slot_tracks)

    def __post_init__(self) -> None:
        """Refuse values that do not go together, naming them."""
        for name in ("speed_range", "accel_range"):
            low, high = getattr(self, name)
            if low > high:
                raise ValueError(f"{name} = {low}, {high}: expected low <= high")
        if self.rules != "deadbeat" and self.slot != INSIDE:
            raise ValueError(f"slot_side = {self.slot}: expected inside, with rules {self.rules}")
        if self.corner_speed_up > self.speed_trim:
            raise ValueError(
                f"corner_speed_up = {self.corner_speed_up}: expected at most speed_trim = "
                f"{self.speed_trim}"
            )
