"""Which GPS fixes may reach the filter."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, field

from sar_estimator.common.geodesy import valid_position
from sar_estimator.common.gps_fix import Fix

MAX_TIME_S = 1e11
SET_BACK_AFTER = 5


class Verdict(enum.StrEnum):
    """What became of a fix. Only ``ACCEPTED`` and ``JUMP`` moved the estimate."""

    ACCEPTED = "accepted"
    JUMP = "jump"
    NO_FIX = "no_fix"
    NOT_FINITE = "not_finite"
    OUT_OF_ORDER = "out_of_order"
    DUPLICATE = "duplicate"
    REPEATED = "repeated_position"
    OUTLIER = "outlier"

    @property
    def moved(self) -> bool:
        """Whether the fix was used."""
        return self in (Verdict.ACCEPTED, Verdict.JUMP)


@dataclass
class FixScreen:
    """Refuses fixes that carry no new position, and counts every verdict."""

    counts: dict[Verdict, int] = field(
        default_factory=lambda: dict.fromkeys(Verdict, 0), init=False
    )
    _last_time_s: float = field(default=-math.inf, init=False)
    _last_position: tuple[float, float] | None = field(default=None, init=False)
    _older_s: list[float] = field(default_factory=list, init=False)

    def refusal(self, fix: Fix) -> Verdict | None:
        """Return why a fix cannot be used, None when it can; repeats are only reported."""
        if not fix.has_fix:
            return Verdict.NO_FIX
        if not (
            abs(fix.time_s) < MAX_TIME_S and valid_position(fix.latitude_deg, fix.longitude_deg)
        ):
            return Verdict.NOT_FINITE
        if fix.time_s < self._last_time_s:
            return Verdict.OUT_OF_ORDER
        if fix.time_s == self._last_time_s:
            return Verdict.DUPLICATE
        if (fix.latitude_deg, fix.longitude_deg) == self._last_position:
            return Verdict.REPEATED
        return None

    def note(self, fix: Fix, verdict: Verdict) -> Verdict:
        """Count a verdict, remember the fix it was given for, and return it."""
        self.counts[verdict] += 1
        if verdict.moved or verdict in (Verdict.REPEATED, Verdict.OUTLIER):
            self._older_s.clear()
            self._last_time_s = fix.time_s
            self._last_position = (fix.latitude_deg, fix.longitude_deg)
        return verdict

    def set_back(self, time_s: float) -> bool:
        """Whether fixes keep coming in order, but from before the newest: the clock was set back.

        To be asked of every fix that is out of order.
        """
        self._older_s = [time for time in self._older_s if time < time_s][-SET_BACK_AFTER:]
        self._older_s.append(time_s)
        return len(self._older_s) > SET_BACK_AFTER

    def forget(self) -> None:
        """Accept any time again (the clock was set back)."""
        self._last_time_s, self._last_position = -math.inf, None
        self._older_s.clear()
