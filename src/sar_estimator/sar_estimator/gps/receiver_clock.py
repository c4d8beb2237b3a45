"""The receiver's time related to this machine's clock.

A reading comes some time after its epoch: the receiver works, and a line takes time. The least of
these delays is taken for what it always takes, so that what is late by more does not move the
stamps.
"""

from __future__ import annotations

from collections import deque

WINDOW = 60
STEP_S = 0.4
HELD_UP_S = 2.0
AGREE = 4


class ReceiverClock:
    """Turns a receiver's times into this machine's.

    ``offset_s``: this machine's clock less the receiver's, with the least delay; ``jitter_s``: by
    how much the newest readings came later than that, at most. ``steps``: how often either clock
    was set, by a leap second or by a whole one.
    """

    def __init__(self) -> None:
        """Know nothing of either."""
        self._late_s: deque[float] = deque(maxlen=WINDOW)
        self._odd_s: list[float] = []
        self.steps = 0

    @property
    def offset_s(self) -> float:
        """The machine's clock less the receiver's, with the least delay [s]; 0 before any."""
        return min(self._late_s, default=0.0)

    @property
    def jitter_s(self) -> float:
        """By how much the newest readings came later than the soonest [s]."""
        return max(self._late_s, default=0.0) - self.offset_s

    def stamp(self, utc_s: float, arrived_s: float) -> float | None:
        """Return a reading's time by this machine's clock [s]; None for one that is not believed.

        One that comes at quite another time, or before it can, is not believed, until some agree
        with each other: then one of the clocks was set. So it was when all that come are late by
        as much.
        """
        late_s = arrived_s - utc_s
        beyond_s = late_s - self.offset_s if self._late_s else 0.0
        if -STEP_S < beyond_s <= STEP_S:
            self._odd_s.clear()
            self._late_s.append(late_s)
            return utc_s + self.offset_s
        self._odd_s = [one for one in self._odd_s if abs(one - late_s) < STEP_S]
        self._odd_s.append(late_s)
        if len(self._odd_s) >= AGREE:
            self.steps += 1
            self._late_s.clear()
            self._late_s.extend(self._odd_s)
            self._odd_s.clear()
        elif not 0.0 < beyond_s < HELD_UP_S:
            return None
        return utc_s + self.offset_s
