"""The monitor's parameters."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from sar_bridge.arduplane.l1_predictor import STEP_S
from sar_estimator.common.checked import CHECKED, NotNegative, Positive

CAUTION_SHARE, WARNING_SHARE, ESCAPE_SHARE = 0.85, 0.75, 0.65


@dataclass(frozen=True, slots=True, config=CHECKED)
class MonitorParameters:
    """Thresholds, horizontal [m], and times [s].

    min_separation_m: no list passes that leads closer within horizon_s.
    gate_sigmas: standard deviations of the doubt that a list is given.
    follow_sigma_m: how far beside its predicted path a UAV flies.
    caution_separation_m: told as caution below this; 0.85 of the least where it is not set.
    warning_separation_m: told as warning below this; 0.75 of the least where it is not set.
    escape_separation_m: the UAV is sent away before it comes closer; 0.65 of the least where it
        is not set.
    guard_sigmas: standard deviations of the doubt that count against what is close in time.
    horizon_s: how far ahead a list is looked at.
    alert_horizon_s: how far ahead cautions and warnings look.
    escape_horizon_s: how far ahead of what is likely the UAV is sent away.
    possible_horizon_s: the same of anything possible.
    alert_after_s: how long a caution or warning must last before it is told.
    escape_after_s: how long the planner may take to end a conflict more than
        `possible_horizon_s` away.
    clear_s: how long all must be well before the planner leads again.
    escape_delay_s: from the choice of an escape until the UAV turns: link, upload, the
        autopilot; where lists are measured to take half a second longer to the autopilot, as
        long as they do.
    most_delay_s: of what is measured of it, counted on at most.
    late_fix_s: age of fixes when they are looked at, from which on that is told, and what the
        helicopter may have begun since is possible.
    escape_climb_m: how far an escape climbs, where that separates more.
    escape_reach_m: how far away an escape ends (in a loiter).
    stale_s: age of a position from which on no list passes.
    lost_s: nothing sure known of the helicopter for so long: the UAV is sent away.
    matched_mps: from the helicopter's speed, within which the UAV is expected to go on at that.
    matched_s: over which the UAV's speed is averaged for that.
    better_list_m: that a list must keep more than the one being flown to pass, where both come too
        near, if less is not missing on the way.
    better_way_m: that another way out must be worth more, to change to it.
    rechoose_s: for how long a way out is held to at least.
    climb_mps: with which the UAV is expected to climb on a way out.
    vertical_separation_m: who is nearer than min_separation_m, and less apart in altitude than
        this, is told of at once.
    layer_separation_m: UAVs that are at least so much apart in altitude need not be so
        horizontally.
    adsb_sigma_m: standard deviation of the helicopter's ADS-B position.
    watch_only: say all this and do nothing, to see what a planner does by itself.
    """

    min_separation_m: Positive = 200.0
    gate_sigmas: NotNegative = 1.0
    follow_sigma_m: NotNegative = 5.0
    caution_separation_m: Positive | None = None
    warning_separation_m: Positive | None = None
    escape_separation_m: Positive | None = None
    guard_sigmas: NotNegative = 0.5
    horizon_s: Annotated[float, Field(ge=0.0, le=300.0)] = 60.0
    alert_horizon_s: NotNegative = 40.0
    escape_horizon_s: NotNegative = 20.0
    possible_horizon_s: NotNegative = 10.0
    alert_after_s: NotNegative = 2.0
    escape_after_s: NotNegative = 4.0
    clear_s: NotNegative = 5.0
    escape_delay_s: NotNegative = 1.0
    most_delay_s: NotNegative = 5.0
    late_fix_s: Positive = 1.5
    escape_climb_m: NotNegative = 40.0
    escape_reach_m: NotNegative = 1500.0
    stale_s: NotNegative = 3.0
    lost_s: NotNegative = 15.0
    matched_mps: NotNegative = 4.0
    matched_s: Positive = 15.0
    better_list_m: NotNegative = 5.0
    better_way_m: NotNegative = 15.0
    rechoose_s: NotNegative = 2.0
    climb_mps: NotNegative = 2.5
    vertical_separation_m: NotNegative = 60.0
    layer_separation_m: Positive = 30.0
    adsb_sigma_m: Positive = 30.0
    watch_only: bool = False

    def __post_init__(self) -> None:
        """Refuse values that do not go together, naming them."""
        steps = list(self.thresholds().items())
        for (upper, most), (lower, least) in pairwise(steps):
            if not 0.0 < least <= most:
                raise ValueError(
                    f"{lower} = {least:g}: expected more than 0, at most {upper} = {most:g}"
                )
        if self.escape_delay_s > self.escape_horizon_s:
            raise ValueError(
                f"escape_delay_s = {self.escape_delay_s}: expected at most "
                f"escape_horizon_s = {self.escape_horizon_s}"
            )
        if not STEP_S <= self.escape_horizon_s <= self.alert_horizon_s <= self.horizon_s:
            raise ValueError(
                f"escape_horizon_s = {self.escape_horizon_s}: expected at most "
                f"alert_horizon_s = {self.alert_horizon_s}, and that at most horizon_s = "
                f"{self.horizon_s}"
            )

    def thresholds(self) -> dict[str, float]:
        """Return the distances [m] that something is told, or done, below; the largest first."""
        least = self.min_separation_m
        shares = (
            ("caution_separation_m", CAUTION_SHARE),
            ("warning_separation_m", WARNING_SHARE),
            ("escape_separation_m", ESCAPE_SHARE),
        )
        found = {"min_separation_m": least}
        for name, share in shares:
            value = getattr(self, name)
            found[name] = share * least if value is None else value
        return found
