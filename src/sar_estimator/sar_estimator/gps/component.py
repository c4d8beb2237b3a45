"""The receiver as a component: its bytes in; fixes and velocities of the helicopter out."""

from __future__ import annotations

import math

from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES, Component, Notice, Outputs
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.reports import Health, Velocity
from sar_estimator.gps.reading import Reading
from sar_estimator.gps.receiver import Receiver
from sar_estimator.gps.receiver_clock import ReceiverClock


class GpsComponent(Component):
    """Reads a receiver; times given are of a monotonic clock [s].

    ``ros_s``: the graph's clock [s], to be set before every call, by which fixes are stamped.
    ``failure``: why there are no bytes, and ``breaks``: how often they have ended, likewise.
    """

    name = "gps"
    outputs = (topics.FIX, topics.VELOCITY, topics.FIX_VELOCITY, topics.DIAGNOSTICS)
    period_s = 1.0

    def __init__(self, *, uere_m: float = 5.0) -> None:
        """Have heard nothing."""
        super().__init__()
        self._receiver = Receiver(uere_m)
        self._clock = ReceiverClock()
        self.ros_s = 0.0
        self.failure = ""
        self.breaks = 0
        self._fixes = self._unbelieved = 0
        self._steps = 0
        self._newest: Reading | None = None

    def receive(self, data: bytes, now_s: float) -> Outputs:
        """Take bytes; return fixes and velocities, the velocity of an epoch first."""
        out: Outputs = []
        for reading in self._receiver.feed(data, now_s):
            out += self._told(reading)
        return out

    def _told(self, reading: Reading) -> Outputs:
        self._newest = reading
        if not reading.is_valid:
            nowhere = Fix(self.ros_s, math.nan, math.nan, math.nan, has_fix=False)
            return [(topics.FIX, nowhere)]
        stamp_s = self._clock.stamp(reading.utc_s, self.ros_s)
        if stamp_s is None:
            self._unbelieved += 1
            return []
        self._fixes += 1
        out: Outputs = []
        if self._clock.steps != self._steps:
            self._steps = self._clock.steps
            text = f"the receiver's clock, or this machine's, was set: {self._clock.offset_s:.3f} s"
            out.append((NOTICES, Notice("warning", text)))
        if reading.velocity_mps is not None:
            sigma = reading.velocity_sigma_mps
            velocity = Velocity(stamp_s, *reading.velocity_mps, sigma)
            out.append((topics.FIX_VELOCITY if sigma else topics.VELOCITY, velocity))
        fix = Fix(
            stamp_s,
            reading.latitude_deg,
            reading.longitude_deg,
            reading.altitude_m,
            reading.covariance_m2,
        )
        return [*out, (topics.FIX, fix)]

    def health(self, now_s: float) -> Health:
        """Return how the receiver is; without fixes nothing can be flown."""
        receiver, newest = self._receiver, self._newest
        problem = self.failure or receiver.problem(now_s)
        sigma = math.nan
        if newest is not None and newest.covariance_m2 is not None:
            sigma = math.sqrt(float(newest.covariance_m2.trace()) / 2.0)
        values = {
            "protocols": ", ".join(str(name) for name in receiver.heard),
            "fixes": self._fixes,
            "sigma_m": f"{sigma:.2f}",
            "velocity_sigma_mps": "" if newest is None else newest.velocity_sigma_mps or "",
            "damaged": receiver.damaged,
            "garbage_bytes": receiver.garbage,
            "unbelieved": self._unbelieved,
            "breaks": self.breaks,
            "clock_offset_s": f"{self._clock.offset_s:.3f}",
            "clock_jitter_s": f"{self._clock.jitter_s:.3f}",
            "clock_steps": self._clock.steps,
        }
        return Health(self.name, problem, values, severe=bool(problem))
