"""How soon a corner is seen, and how often one is seen that is not there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sar_estimator.common.geodesy import Datum
from sar_estimator.estimation.estimator import HelicopterEstimator
from sar_estimator.estimation.parameters import VELOCITY_SIGMA_MPS, EstimatorParameters
from sar_planner.parameters.corner import CornerParameters
from sar_sim.scenario.presets import PILOTS, RECEIVERS
from sar_sim.scenario.scenario import Gps, Pattern, Pilot
from sar_sim.world.gps import SimulatedGps
from sar_sim.world.helicopter import CornerTruth, Helicopter
from sar_sim.world.human_helicopter import flown_by

DATUM = Datum(37.8, -122.8)
HOUR_S = 3600.0
EARLY_S = 0.5
LATE_S = 20.0
CORNERS = 8
SETTLED_S = 25.0


@dataclass(frozen=True, slots=True)
class Watched:
    """What an estimator made of one flight.

    ``delays_s``: from every corner's onset until it was predicted, infinite where it was not;
    ``alarms``: corners predicted that were none; ``withdrawn``: of all, how many were taken back;
    ``unled_s``: for how long on legs, from 25 s after a corner on, no leg was known.
    """

    delays_s: tuple[float, ...]
    alarms: int
    withdrawn: int
    flown_s: float
    unled_s: float


def pilot_of(kind: str, seed: int, **changed: float) -> Pilot:
    """Return a pilot of a kind; ``rolled`` is a human who turns every corner without a stop."""
    if kind == "rolled":
        return pilot_of("human", seed, roll_share=1.0, roll_spread_mps=2.0, **changed)
    values = {**PILOTS[kind], **changed}
    return replace(Pilot(kind=kind, seed=seed), **values)  # type: ignore[arg-type]


def receiver_of(kind: str, seed: int, *, doppler: bool = True) -> Gps:
    """Return a receiver of a kind."""
    values = dict(RECEIVERS[kind])
    if not doppler:
        values["doppler_sigma_mps"] = 0.0
    return replace(Gps(receiver=kind, seed=seed), **values)  # type: ignore[arg-type]


def watch(
    helicopter: Helicopter, gps: Gps, until_s: float, expected_m: Sequence[float] = ()
) -> Watched:
    """Let an estimator watch a flight through a receiver.

    ``expected_m``: the lengths of the legs that it is told of beforehand [m].
    """
    parameters = EstimatorParameters(expected_legs_m=tuple(expected_m))
    estimator = HelicopterEstimator(parameters, DATUM)
    seen: list[float] = []
    predicted, unled_s = False, 0.0
    corners = helicopter.corners
    for reception in SimulatedGps(helicopter, gps, DATUM).due(until_s):
        velocity, time_s = reception.velocity, reception.fix.time_s
        if velocity is not None:
            estimator.add_velocity(time_s, velocity.vx_mps, velocity.vy_mps, VELOCITY_SIGMA_MPS)
        estimator.add_fix(reception.fix)
        if estimator.corner is not None and not predicted:
            seen.append(time_s)
        predicted = estimator.corner is not None
        if estimator.leg is None and _on_leg(corners, time_s):
            unled_s += 1.0 / gps.rate_hz
    delays, alarms = matched(corners, seen)
    return Watched(tuple(delays), alarms, estimator.withdrawn_corners, until_s, unled_s)


def _on_leg(corners: list[CornerTruth], time_s: float) -> bool:
    """Whether a leg has been flown for a while, and no corner has begun."""
    ends = [corner.stop_time_s for corner in corners if corner.onset_time_s <= time_s]
    return time_s - max(ends, default=0.0) > SETTLED_S


def matched(corners: list[CornerTruth], seen_s: list[float]) -> tuple[list[float], int]:
    """Return the delay of every corner, and how many of what was seen belong to none."""
    left, delays = list(seen_s), []
    for corner in corners:
        begin, end = corner.onset_time_s - EARLY_S, corner.onset_time_s + LATE_S
        mine = [time for time in left if begin <= time <= end]
        delays.append(mine[0] - corner.onset_time_s if mine else math.inf)
        left = [time for time in left if time not in mine]
    return delays, len(left)


def corner_flight(
    pilot: Pilot,
    gps: Gps,
    *,
    speed_mps: float = 20.0,
    accel_mps2: float | None = None,
    told_off_m: float | None = None,
) -> Watched:
    """Fly a square of ``CORNERS`` corners, its legs of a length drawn from the receiver's seed.

    ``told_off_m``: by how much longer its legs are told of beforehand than they are [m]; None:
    nothing is told.
    """
    accel = CornerParameters().accel_mps2 if accel_mps2 is None else accel_mps2
    # The onset falls anywhere between two fixes.
    leg = 1400.0 + speed_mps * float(np.random.default_rng(gps.seed + 10**6).random())
    pattern = Pattern(first_leg_m=leg, last_leg_m=600.0, corners=CORNERS)
    helicopter = flown_by(pilot, pattern, speed_mps, accel)
    told = [] if told_off_m is None else pattern.terms.lengths_m()
    return watch(helicopter, gps, helicopter.end_s, [one + (told_off_m or 0.0) for one in told])


def straight_flight(
    pilot: Pilot,
    gps: Gps,
    hours: float,
    *,
    speed_mps: float = 20.0,
    told_m: Sequence[float] = (),
) -> Watched:
    """Fly straight on, whatever length the leg was told to have, ``told_m`` [m]."""
    length = speed_mps * (HOUR_S * hours + 300.0) * 1.2
    pattern = Pattern(first_leg_m=length, corners=1)
    helicopter = flown_by(pilot, pattern, speed_mps, CornerParameters().accel_mps2)
    return watch(helicopter, gps, HOUR_S * hours, told_m)
