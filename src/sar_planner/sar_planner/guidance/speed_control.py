"""The speed trim on legs, and what the autopilot makes good of its speed at corners."""

from __future__ import annotations

LEAST_SHARE, MOST_SHARE = 0.5, 1.05
PRIOR_S = 8.0
LEAST_STEP_S = 0.19


def trimmed_mps(
    lag_m: float, speed_mps: float, *, gain: float, trim: float, off_mps: float = 0.0
) -> float:
    """Return the ground speed [m/s] that takes out a lag [m]: V + off + gain L.

    ``off_mps``: by how much the helicopter is faster at present than V. It and the correction are
    each kept within V ``trim``, so that a lag is still taken out behind who flies fast for a while.
    """
    most = trim * speed_mps
    return speed_mps + min(max(off_mps, -most), most) + min(max(gain * lag_m, -most), most)


class MadeGood:
    """Learns what share of its speed the UAV makes good along a corner's path.

    An autopilot that turns late, wide or in oscillations flies farther than planned: its progress
    along the path is slower than its speed. ``share``: what is expected of the next corner, learnt
    from corner to corner. ``now``: what is expected of the rest of the present one.
    """

    def __init__(self, gain: float) -> None:
        """Expect all of it; ``gain``: the newest corner's part in what is expected."""
        self._gain = gain
        self.share = 1.0
        self._watching = False
        self._progress_m = 0.0
        self._run_m = 0.0
        self._prior_m = 1.0
        self._last: tuple[float, float] | None = None

    @property
    def now(self) -> float:
        """The share expected of the rest of the corner being flown."""
        if not self._watching:
            return self.share
        share = (self._prior_m * self.share + self._progress_m) / (self._prior_m + self._run_m)
        return min(max(share, LEAST_SHARE), MOST_SHARE)

    def begin(self, speed_mps: float) -> None:
        """Begin to watch a corner's path, to be flown at a speed [m/s]."""
        self._watching, self._last = True, None
        self._progress_m = self._run_m = 0.0
        self._prior_m = PRIOR_S * speed_mps

    def watch(self, time_s: float, flown_m: float, speed_mps: float) -> None:
        """Take how far along its path the UAV is [m], at what speed it should be."""
        if not self._watching:
            return
        if self._last is None:
            self._last = (time_s, flown_m)
            return
        since = time_s - self._last[0]
        if since < LEAST_STEP_S:
            return
        self._run_m += speed_mps * since
        self._progress_m += flown_m - self._last[1]
        self._last = (time_s, flown_m)

    def moved(self) -> None:
        """Go on with another path, one that begins where the UAV is."""
        self._last = None

    def cancel(self) -> None:
        """Learn nothing of a path that was given up."""
        self._watching = False

    def learn(self) -> None:
        """Learn from the path that has been flown."""
        if self._watching and self._run_m > self._prior_m:
            flown = min(max(self._progress_m / self._run_m, LEAST_SHARE), MOST_SHARE)
            self.share += self._gain * (flown - self.share)
        self._watching = False
