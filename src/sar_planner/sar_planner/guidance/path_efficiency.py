"""What share of its speed an autopilot makes good along a corner's path."""

from __future__ import annotations

from dataclasses import dataclass, replace

LEAST_SHARE, MOST_SHARE = 0.5, 1.05
PRIOR_S = 8.0
LEAST_STEP_S = 0.19


@dataclass(frozen=True, slots=True)
class CornerProgress:
    """How far a corner's path was flown [m], beside what was expected of the UAV's speed [m].

    ``prior_m``: the expected distance that what was known before is worth. ``last``: the time [s]
    and the place along the path [m] at the last look, None after another path was begun.
    """

    prior_m: float
    flown_m: float = 0.0
    expected_m: float = 0.0
    last: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class PathEfficiency:
    """Learns an autopilot's progress along corner paths, over its speed.

    One that turns late, wide or in oscillations flies farther than planned. ``gain``: the newest
    corner's part in what is expected. ``share``: what is expected of the next corner, learnt from
    corner to corner. ``corner``: of the present one, None while none is flown.
    """

    gain: float
    share: float = 1.0
    corner: CornerProgress | None = None

    @property
    def now(self) -> float:
        """The share expected of the rest of the corner being flown."""
        one = self.corner
        if one is None:
            return self.share
        share = (one.prior_m * self.share + one.flown_m) / (one.prior_m + one.expected_m)
        return min(max(share, LEAST_SHARE), MOST_SHARE)

    def begun(self, speed_mps: float) -> PathEfficiency:
        """Begin to watch a corner's path, to be flown at a speed [m/s]."""
        return replace(self, corner=CornerProgress(PRIOR_S * speed_mps))

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
        return (
            self if self.corner is None else replace(self, corner=replace(self.corner, last=None))
        )

    def cancelled(self) -> PathEfficiency:
        """Learn nothing of a path that was given up."""
        return replace(self, corner=None)

    def learnt(self) -> PathEfficiency:
        """Learn from the path that has been flown."""
        one, share = self.corner, self.share
        if one is not None and one.expected_m > one.prior_m:
            flown = min(max(one.flown_m / one.expected_m, LEAST_SHARE), MOST_SHARE)
            share += self.gain * (flown - share)
        return replace(self, share=share, corner=None)
