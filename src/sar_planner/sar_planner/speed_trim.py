"""The speed trim on legs, and the extra path that the autopilot is expected to fly at corners."""

from __future__ import annotations

LEAST_EXTRA_M, MOST_EXTRA_M = -100.0, 600.0
LEAST_STEP_S = 0.2


def trimmed_mps(lag_m: float, speed_mps: float, *, gain: float, trim: float) -> float:
    """Return the ground speed [m/s] that takes out a lag [m]: V + gain L, within V (1 +- trim)."""
    return speed_mps + min(max(gain * lag_m, -trim * speed_mps), trim * speed_mps)


class PathBias:
    """Learns from corner to corner by how much the UAV falls back against its planned path.

    ``extra_m``: how much longer than planned the next corner's path is expected to be flown [m].
    """

    def __init__(self, gain: float) -> None:
        """Expect nothing yet; ``gain``: the newest corner's share in what is expected."""
        self._gain = gain
        self.extra_m = 0.0
        self._learnt = False
        self._fallen_m: float | None = None
        self._last: tuple[float, float] | None = None

    def begin(self) -> None:
        """Begin to watch a corner's path."""
        self._fallen_m, self._last = 0.0, None

    def watch(self, time_s: float, flown_m: float, speed_mps: float) -> None:
        """Take how far along its path the UAV is [m]."""
        if self._fallen_m is None:
            return
        if self._last is None:
            self._last = (time_s, flown_m)
            return
        since = time_s - self._last[0]
        if since < LEAST_STEP_S:
            return
        self._fallen_m += speed_mps * since - (flown_m - self._last[1])
        self._last = (time_s, flown_m)

    def moved(self) -> None:
        """Go on with another path, one that begins where the UAV is."""
        self._last = None

    def cancel(self) -> None:
        """Learn nothing of a path that was given up."""
        self._fallen_m = self._last = None

    def learn(self) -> None:
        """Learn from the path that has been flown."""
        if self._fallen_m is None:
            return
        share = self._gain if self._learnt else 1.0
        extra = self.extra_m + share * (self._fallen_m - self.extra_m)
        self.extra_m = min(max(extra, LEAST_EXTRA_M), MOST_EXTRA_M)
        self._learnt = True
        self._fallen_m = self._last = None
