"""When the simulation's next step is due: at a multiple of real time, or by an autopilot's clock.

Pure: every time is given. ``real_s`` is a monotonic clock, ``time_s`` the simulation's.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Protocol

MAX_SLIP_S = 0.5
CATCH_UP = 0.12
COAST_S = 0.25
WINDOW_S = 5.0
LASTS_S = 6.0
SURE_S = 4.0
SPEED_TOLERANCE = 0.1
STANDS = math.inf


class Pacer(Protocol):
    """Tells when a step is due."""

    def wait_s(self, time_s: float, real_s: float) -> float:
        """Return how long to wait [s] until the simulation may go on from ``time_s``."""

    def stood(self, held_s: float) -> None:
        """Take note that the simulation was held for so long [s] on purpose."""


class RealTimePacer:
    """A multiple of real time; what cannot be kept up with is let go.

    A hold is made up for little by little, the steps coming by ``CATCH_UP`` sooner until it is.
    """

    def __init__(self, speed: float, real_s: float) -> None:
        """Begin at time 0 now."""
        self._speed, self._begun_s = speed, real_s
        self._owed_s = self._time_s = 0.0

    def wait_s(self, time_s: float, real_s: float) -> float:
        """Return how long to wait [s]."""
        made_up = min(self._owed_s, CATCH_UP * (time_s - self._time_s) / self._speed)
        self._owed_s -= made_up
        self._begun_s -= made_up
        self._time_s = time_s
        due = self._begun_s + time_s / self._speed
        if real_s - due > MAX_SLIP_S:
            self._begun_s += real_s - due
        return max(0.0, due - real_s)

    def stood(self, held_s: float) -> None:
        """Shift what is due later by a hold; not by the part that passes in real time anyway."""
        later = held_s * max(0.0, 1.0 - 1.0 / self._speed)
        self._begun_s += later
        self._owed_s += later


class AutopilotPacer:
    """The clock of an autopilot, whatever its speed: both stand when the autopilot's stands.

    Between its messages its clock is carried on at the speed seen of late, for no longer than
    ``COAST_S``; so the simulation never runs ahead of it by more, and never falls behind for good.
    """

    def __init__(self, expected_speed: float) -> None:
        """Stand until the autopilot is heard."""
        self._expected = expected_speed
        self._heard: deque[tuple[float, float]] = deque()
        self._offset_s: float | None = None
        self._other_since_s = math.inf

    def hear(self, boot_s: float, real_s: float) -> None:
        """Take the autopilot's time since boot [s], heard at ``real_s``; back in time: a reboot.

        Raises ``ValueError`` when its clock does not run at the speed expected.
        """
        last = self._heard[-1] if self._heard else None
        if last is not None and boot_s < last[0]:
            self._heard.clear()
            self._offset_s = None
        self._heard.append((boot_s, real_s))
        while real_s - self._heard[0][1] > WINDOW_S:
            self._heard.popleft()
        speed, sure = self.speed, real_s - self._heard[0][1] >= SURE_S
        other = speed is not None and abs(speed / self._expected - 1.0) > SPEED_TOLERANCE
        self._other_since_s = min(self._other_since_s, real_s) if other and sure else math.inf
        # A link that stood and then delivers all at once is no other speed: that lasts.
        if speed is not None and real_s - self._other_since_s >= LASTS_S:
            raise ValueError(
                f"parameter speed = {self._expected:g}: expected {speed:.3g}, "
                "at which the autopilot's clock runs"
            )

    @property
    def speed(self) -> float | None:
        """Return how fast its clock runs of late, None while that is not known well."""
        if len(self._heard) < 2:
            return None
        (boot_0, real_0), (boot_1, real_1) = self._heard[0], self._heard[-1]
        return (boot_1 - boot_0) / (real_1 - real_0) if real_1 - real_0 > 0.0 else None

    def wait_s(self, time_s: float, real_s: float) -> float:
        """Return how long to wait [s]; for ever while the autopilot is not heard."""
        speed = self.speed
        if speed is None or speed <= 0.0:
            return STANDS
        boot_s, heard_s = self._heard[-1]
        if self._offset_s is None:
            self._offset_s = time_s - boot_s
        ahead_s = (time_s - self._offset_s - boot_s) / speed
        if ahead_s > COAST_S:
            return STANDS
        return max(0.0, heard_s + ahead_s - real_s)

    def stood(self, held_s: float) -> None:
        """Nothing is made up for: the autopilot's clock is what counts."""
