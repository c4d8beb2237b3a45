"""What share of its speed an autopilot makes good along a corner's path."""

from __future__ import annotations

from dataclasses import dataclass, replace

LEAST_SHARE, MOST_SHARE = 0.5, 1.05
PRIOR_S = 8.0
UNKNOWN_PRIOR_S = 2.0
LEAST_STEP_S = 0.19


@dataclass(frozen=True, slots=True)
class CornerProgress:
    """How far a corner's path was flown [m], beside what was expected of the UAV's speed [m].

    ``prior_m``: the expected distance that what was known before is worth. ``least_m``: that is
    learnt from. ``gain``: with which. ``last``: the time [s] and the place along the path [m] at
    the last look, None after another path was begun.
    """

    prior_m: float
    least_m: float
    gain: float
    flown_m: float = 0.0
    expected_m: float = 0.0
    last: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class PathEfficiency:
    """Learns an autopilot's progress along corner paths, over its speed.

    One that turns late, wide or in oscillations flies farther than planned. ``gain``: the newest
    corner's part in what is expected. ``share``: what is expected of the next corner, learnt from
    corner to corner. ``corner``: of the present one, None while none is flown. ``corners``: how
    many were learnt from.
    """

    gain: float
    share: float = 1.0
    corner: CornerProgress | None = None
    corners: int = 0

    @property
    def now(self) -> float:
        """The share expected of the rest of the corner being flown."""
        one = self.corner
        if one is None:
            return self.share
        share = (one.prior_m * self.share + one.flown_m) / (one.prior_m + one.expected_m)
        return min(max(share, LEAST_SHARE), MOST_SHARE)

    def begun(self, speed_mps: float, *, is_known: bool = True) -> PathEfficiency:
        """Begin to watch a corner's path, to be flown at a speed [m/s].

        ``is_known``: whether the autopilot tells how it flies. Of another nothing is believed for
        long in its first corner, and all of that is learnt.
        """
        least_m = PRIOR_S * speed_mps
        one = CornerProgress(least_m, least_m, self.gain)
        if not is_known and self.corners == 0:
            one = CornerProgress(UNKNOWN_PRIOR_S * speed_mps, least_m, 1.0)
        return replace(self, corner=one)

    def watched(self, time_s: float, flown_m: float, speed_mps: float) -> PathEfficiency:
        """Take how far along its path the UAV is [m], at what speed it should be."""
        one = self.corner
        if one is None:
            return self
        if one.last is None:
            return replace(self, corner=replace(one, last=(time_s, flown_m)))
        since_s = time_s - one.last[0]
        if since_s < LEAST_STEP_S:
            return self
        farther = replace(
            one,
            flown_m=one.flown_m + flown_m - one.last[1],
            expected_m=one.expected_m + speed_mps * since_s,
            last=(time_s, flown_m),
        )
        return replace(self, corner=farther)

    def moved(self) -> PathEfficiency:
        """Go on with another path, one that begins where the UAV is."""
        one = self.corner
        return self if one is None else replace(self, corner=replace(one, last=None))

    def restarted(self) -> PathEfficiency:
        """Forget what was flown of the present corner's path: the rest of it is watched."""
        one = self.corner
        if one is None:
            return self
        return replace(self, corner=CornerProgress(one.prior_m, one.least_m, one.gain))

    def cancelled(self) -> PathEfficiency:
        """Learn nothing of a path that was given up."""
        return replace(self, corner=None)

    def learnt(self) -> PathEfficiency:
        """Learn from the path that has been flown."""
        one = self.corner
        if one is None or one.expected_m <= one.least_m:
            return replace(self, corner=None)
        flown = min(max(one.flown_m / one.expected_m, LEAST_SHARE), MOST_SHARE)
        share = self.share + one.gain * (flown - self.share)
        return replace(self, share=share, corner=None, corners=self.corners + 1)
