"""The monitor's parameters."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from itertools import pairwise

from sar_bridge.arduplane.l1_predictor import STEP_S

CAUTION_SHARE, WARNING_SHARE, ESCAPE_SHARE = 0.85, 0.75, 0.65


@dataclass(frozen=True, slots=True)
class MonitorParameters:
    """Thresholds, horizontal [m], and times [s].

    min_separation_m: no list passes that leads closer within horizon_s.
    gate_sigmas: standard deviations of both positions that are taken in a list's favour.
    follow_sigma_m: standard deviation of the UAV beside its predicted path.
    caution_separation_m, warning_separation_m: told when the list being flown leads closer within
    alert_horizon_s; None for a share of the least.
    escape_separation_m: the UAV is sent away when it leads closer; None for a share of the least.
    guard_sigmas: standard deviations that are taken against what is possible.
    horizon_s: how far ahead a list is looked at before it passes.
    alert_horizon_s: how far ahead the list being flown is looked at.
    escape_horizon_s: how far ahead what is likely of the helicopter is a reason to be sent away.
    possible_horizon_s: how far ahead anything possible of it is.
    alert_after_s: how long it must be so before it is told.
    escape_after_s: how long what is likely must be so, while the planner leads nowhere else.
    clear_s: how long all must be well before the planner leads again.
    escape_delay_s: from the choice of an escape until the UAV turns.
    escape_climb_m: how far it climbs where that separates more.
    escape_reach_m: how far away an escape ends.
    stale_s: age of a position from which on no list passes.
    lost_s: how long nothing sure may be known of the helicopter before the UAV is sent away.
    watch_only: say all this and do nothing, to see what a planner does by itself.
    """

    min_separation_m: float = 200.0
    gate_sigmas: float = 1.0
    follow_sigma_m: float = 5.0
    caution_separation_m: float | None = None
    warning_separation_m: float | None = None
    escape_separation_m: float | None = None
    guard_sigmas: float = 0.5
    horizon_s: float = 60.0
    alert_horizon_s: float = 40.0
    escape_horizon_s: float = 20.0
    possible_horizon_s: float = 10.0
    alert_after_s: float = 2.0
    escape_after_s: float = 4.0
    clear_s: float = 5.0
    escape_delay_s: float = 1.0
    escape_climb_m: float = 40.0
    escape_reach_m: float = 1500.0
    stale_s: float = 3.0
    lost_s: float = 15.0
    watch_only: bool = False

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for a value that cannot be meant."""
        for item in fields(self):
            value = getattr(self, item.name)
            if value is not None and not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"parameter {item.name} = {value}: expected 0 or more")
        steps = list(self.thresholds().items())
        for (upper, most), (lower, least) in pairwise(steps):
            if not 0.0 < least <= most:
                raise ValueError(
                    f"parameter {lower} = {least:g}: expected more than 0, at most {upper} = "
                    f"{most:g}"
                )
        if self.escape_delay_s > self.escape_horizon_s:
            raise ValueError(
                f"parameter escape_delay_s = {self.escape_delay_s}: expected at most "
                f"escape_horizon_s = {self.escape_horizon_s}"
            )
        if not STEP_S <= self.escape_horizon_s <= self.alert_horizon_s <= self.horizon_s <= 300.0:
            raise ValueError(
                f"parameter escape_horizon_s = {self.escape_horizon_s}: expected at most "
                f"alert_horizon_s = {self.alert_horizon_s}, that at most horizon_s = "
                f"{self.horizon_s}, and that at most 300"
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
