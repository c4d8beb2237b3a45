"""What is wrong with the two aircraft as they are now: too near, or the helicopter elsewhere."""

from __future__ import annotations

import math

from sar_bridge.monitor.outlook import Outlook
from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common.reports import Target

DOUBT_SIGMAS = 3.0
ADSB_LATE_S = 1.0
"""By how much an ADS-B position may be older than it says."""
LONGEST_AGE_S = 5.0
FORGOTTEN_S = 15.0
IN_A_ROW = 2


class Present:
    """Compares where the aircraft are, and the helicopter's own position with its ADS-B one.

    ``adsb``: how the two disagree, empty where they do not, or none was heard for long.
    """

    def __init__(self, parameters: MonitorParameters, outlook: Outlook) -> None:
        """Have seen nothing."""
        self._p, self._outlook = parameters, outlook
        self.adsb = ""
        self._heard_s = -math.inf
        self._far = 0

    def too_near(self, now_s: float) -> str:
        """Return how near the aircraft are, empty where one of both separations is kept.

        Altitudes that are not known are taken to be the same.
        """
        one, other = self._outlook.helicopter.motion, self._outlook.uav
        if one is None or other is None:
            return ""
        ages = now_s - one.time_s, now_s - other.time_s
        if max(ages) > self._p.stale_s:
            return ""
        one, other = one.after(ages[0]), other.after(ages[1])
        apart_m = math.hypot(one.x_m - other.x_m, one.y_m - other.y_m)
        above_m, least_m = self._outlook.above_m, self._p.vertical_separation_m
        if apart_m >= self._p.min_separation_m or abs(above_m) >= least_m:
            return ""
        high = "altitudes not known" if math.isnan(above_m) else f"{abs(above_m):.0f} m in altitude"
        return (
            f"{apart_m:.0f} m apart, {high}: expected {self._p.min_separation_m:g} m, "
            f"or {least_m:g} m in altitude"
        )

    def hear(self, seen: Target) -> None:
        """Take an ADS-B position of the helicopter."""
        own, sigma_m = self._outlook.helicopter.motion, self._outlook.helicopter.position_sigma_m
        if own is None or abs(seen.time_s - own.time_s) > LONGEST_AGE_S:
            return
        self._heard_s = seen.time_s
        there = own.after(seen.time_s - own.time_s)
        off_m = math.hypot(there.x_m - seen.x_m, there.y_m - seen.y_m)
        most_m = DOUBT_SIGMAS * math.hypot(sigma_m, self._p.adsb_sigma_m)
        most_m += ADSB_LATE_S * own.speed_mps
        self._far = self._far + 1 if off_m > most_m else 0
        self.adsb = ""
        if self._far >= IN_A_ROW:
            self.adsb = (
                f"the helicopter's ADS-B position is {off_m:.0f} m from its own GPS's: "
                f"expected {most_m:.0f} m at most"
            )

    def forget_old(self, now_s: float) -> None:
        """Believe what was heard long ago no more."""
        if now_s - self._heard_s > FORGOTTEN_S:
            self.adsb, self._far = "", 0
