"""The estimator as a component: the helicopter's fixes in; motion, leg, phase and corner out."""

from __future__ import annotations

import math
from typing import Protocol

from sar_estimator.common import topics
from sar_estimator.common.component import Component, Outputs
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.lateness import Lateness
from sar_estimator.common.reports import Health, Velocity
from sar_estimator.common.states import CornerEstimate, LegEstimate, MotionEstimate, Phase
from sar_estimator.estimation.estimator import HelicopterEstimator
from sar_estimator.estimation.fix_screen import Verdict
from sar_estimator.estimation.parameters import VELOCITY_SIGMA_MPS, EstimatorParameters

MOST_RATE_HZ = 100.0


class Estimates(Protocol):
    """What is published of the helicopter: the estimator's, or a simulation's truth."""

    @property
    def leg(self) -> LegEstimate | None:
        """The leg being flown."""
        ...

    @property
    def corner(self) -> CornerEstimate | None:
        """The corner ahead."""
        ...

    def predict(self, time_s: float) -> MotionEstimate | None:
        """Return the motion at a time."""
        ...

    def phase(self, time_s: float) -> Phase:
        """Return the phase at a time."""
        ...


def motion_outputs(source: Estimates, now_s: float) -> Outputs:
    """Return what is published at the prediction rate."""
    estimate = source.predict(now_s)
    if estimate is None:
        return []
    return [(topics.HELICOPTER_ODOMETRY, estimate), (topics.HELICOPTER_ACCEL, estimate)]


def leg_outputs(source: Estimates, time_s: float) -> Outputs:
    """Return what is published after every fix: the leg, and the corner while one is ahead."""
    found: Outputs = [] if source.leg is None else [(topics.LEG, source.leg)]
    corner = source.corner
    if corner is not None and source.phase(time_s) in (Phase.DECELERATING, Phase.STOPPED):
        found += [(topics.CORNER, corner), (topics.PREDICTION, corner)]
    return found


class EstimatorComponent(Component):
    """Feeds the estimator, and tells what it knows.

    ``estimator``: what is fed.
    """

    name = "estimator"
    outputs = (
        topics.HELICOPTER_ODOMETRY,
        topics.HELICOPTER_ACCEL,
        topics.FIX_TIME,
        topics.LEG,
        topics.CORNER,
        topics.PREDICTION,
        topics.PHASE,
        topics.DATUM,
        topics.DIAGNOSTICS,
    )

    def __init__(
        self,
        parameters: EstimatorParameters,
        datum: Datum | None = None,
        *,
        velocity_sigma_mps: float = VELOCITY_SIGMA_MPS,
        rate_hz: float = 5.0,
    ) -> None:
        """Know nothing; without a ``datum`` the first fix is the map's origin.

        ``velocity_sigma_mps``: of the receiver's velocities, at least. ``rate_hz``: of predictions.
        Raises ``ValueError`` for a rate that cannot be meant.
        """
        super().__init__()
        if not 0.0 < rate_hz <= MOST_RATE_HZ:
            raise ValueError(f"parameter prediction_rate_hz = {rate_hz}: expected 0 to 100")
        self.period_s = 1.0 / rate_hz
        self.estimator = HelicopterEstimator(parameters, datum)
        self._velocity_sigma_mps = velocity_sigma_mps
        self._phase: Phase | None = None
        self._datum_published = False
        self._tells_sigma = False
        self._lateness = Lateness()
        self.inputs = {
            topics.FIX: self._on_fix,
            topics.VELOCITY: self._on_velocity,
            topics.FIX_VELOCITY: self._on_fix_velocity,
        }

    def start(self, now_s: float) -> Outputs:  # noqa: ARG002
        """Tell of the map's origin where it was given."""
        return self._datum_outputs()

    def _on_fix(self, fix: Fix, now_s: float) -> Outputs:
        if not self.estimator.add_fix(fix).moved:
            return []
        self._lateness.add(now_s - fix.time_s, now_s)
        told = [(topics.FIX_TIME, fix.time_s)]
        return [*self._datum_outputs(), *told, *self._changed(fix.time_s)]

    def _on_velocity(self, velocity: Velocity, _now_s: float) -> Outputs:
        return [] if self._tells_sigma else self._add(velocity)

    def _on_fix_velocity(self, velocity: Velocity, _now_s: float) -> Outputs:
        self._tells_sigma = True
        return self._add(velocity)

    def _add(self, velocity: Velocity) -> Outputs:
        before = self.estimator.corner
        sigma = max(self._velocity_sigma_mps, velocity.sigma_mps or 0.0)
        self.estimator.add_velocity(velocity.time_s, velocity.vx_mps, velocity.vy_mps, sigma)
        # One that comes after its fix says more.
        return [] if self.estimator.corner is before else self._changed(velocity.time_s)

    def _changed(self, time_s: float) -> Outputs:
        """Return what a fix, or its velocity, has changed."""
        return [*self._phase_outputs(time_s), *leg_outputs(self.estimator, time_s)]

    def tick(self, now_s: float) -> Outputs:
        """Predict; the phase before what is predicted in it."""
        return [*self._phase_outputs(now_s), *motion_outputs(self.estimator, now_s)]

    def _phase_outputs(self, time_s: float) -> Outputs:
        phase = self.estimator.phase(time_s)
        if phase is self._phase:
            return []
        self._phase = phase
        return [(topics.PHASE, phase)]

    def _datum_outputs(self) -> Outputs:
        datum = self.estimator.datum
        if datum is None or self._datum_published:
            return []
        self._datum_published = True
        return [(topics.DATUM, datum)]

    def health(self, now_s: float) -> Health:
        """Return its phase, what became of all fixes, and how old they were when they came."""
        estimator = self.estimator
        phase = estimator.phase(now_s)
        counts = {verdict.value: n for verdict, n in estimator.counts.items()}
        return Health(
            self.name,
            "no usable GPS fix" if phase is Phase.LOST else "",
            {
                "phase": phase,
                **counts,
                "refused": sum(n for name, n in counts.items() if name != Verdict.ACCEPTED.value),
                "refused_velocities": estimator.refused_velocities,
                "withdrawn_corners": estimator.withdrawn_corners,
                "fix_late_s": f"{self._lateness.value_s(now_s):.1f}",
            },
            severe=phase is Phase.LOST,
        )

    def set_clock_back(self) -> None:
        """Begin again."""
        self.estimator.restart_clock()


def given_datum(latitude_deg: float, longitude_deg: float, altitude_m: float) -> Datum | None:
    """Return the map's origin that parameters name, None where they are not numbers."""
    if math.isnan(latitude_deg) and math.isnan(longitude_deg):
        return None
    return Datum(latitude_deg, longitude_deg, altitude_m)
