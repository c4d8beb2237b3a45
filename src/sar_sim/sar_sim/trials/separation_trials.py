"""Random paths beside random forecasts: the planner's bound of their distance against a fine look.

Each seed draws a forecast and a batch of paths from one pose. The fine look shares nothing with the
bound: it takes positions of both aircraft as numpy computes them, every ``STEP_S``, and about each
place that may be the nearest every ``FINE_S``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sar_estimator.common.pose import Pose
from sar_estimator.common.states import Motion
from sar_planner.paths.flight_path import FloatArray
from sar_planner.paths.slot_intercept import COLUMNS, STRAIGHTS, TURNS, PathBatch
from sar_planner.prediction.forecast import (
    Forecast,
    Stretch,
    along_list,
    cornering,
    cruising,
    departing,
)
from sar_planner.prediction.separation import least_distances_m

PATHS = 50  # a seed
STEP_S, FINE_S = 0.1, 0.002
FASTEST_MPS = 90.0  # of one aircraft seen from the other, more than is drawn
EPOCH_S = 1.7e9
KINDS = ("corner", "cruise", "stop", "depart", "list", "circle")


@dataclass(frozen=True)
class Case:
    """Paths and a forecast, as ``least_distances_m`` takes them."""

    batch: PathBatch
    forecast: Forecast
    start_s: float
    speeds_mps: FloatArray
    lead_mps: float | None

    def bounds_m(self, kept_m: float | None = None) -> FloatArray:
        """Return the planner's lower bounds, shape (n,) [m]."""
        return least_distances_m(
            self.batch,
            self.forecast,
            start_s=self.start_s,
            speeds_mps=self.speeds_mps,
            lead_mps=self.lead_mps,
            kept_m=kept_m,
        )

    def sampled_m(self) -> FloatArray:
        """Return the least distances that a fine look finds, none below the true ones, (n,) [m]."""
        lasts_s = np.maximum(self._flown_s, self.forecast.steady_s - self.start_s)
        count = math.ceil(float(lasts_s.max()) / STEP_S) + 1
        times = np.minimum(STEP_S * np.arange(count), lasts_s[:, None])
        coarse = self._apart_m(np.arange(len(self.batch)), times)
        least: FloatArray = coarse.min(axis=1)
        near = coarse <= least[:, None] + 0.5 * STEP_S * FASTEST_MPS
        path, at = np.nonzero(near)
        fine = np.arange(-0.5 * STEP_S, 0.5 * STEP_S + FINE_S, FINE_S)
        about = np.clip(times[path, at][:, None] + fine, 0.0, lasts_s[path][:, None])
        np.minimum.at(least, path, self._apart_m(path, about).min(axis=1))
        return least

    @property
    def _leads_m(self) -> FloatArray:
        first: FloatArray = self.batch.rows[:, 0]
        return np.zeros_like(first) if self.lead_mps is None else first

    @property
    def _flown_s(self) -> FloatArray:
        lead = self._leads_m
        return lead / (self.lead_mps or 1.0) + (self.batch.lengths_m - lead) / self.speeds_mps

    def _apart_m(self, path: np.ndarray, times: FloatArray) -> FloatArray:
        """Return the distances of some paths, shape (k,), at some times, shape (k, m)."""
        lead, speed = self._leads_m[path][:, None], self.speeds_mps[path][:, None]
        lead_mps, flown_s = self.lead_mps or 1.0, self._flown_s[path][:, None]
        length = self.batch.lengths_m[path][:, None]
        rest = lead + speed * (times - lead / lead_mps)
        flown = np.where(times < lead / lead_mps, lead_mps * times, rest)
        behind = length + self.forecast.speed_mps * (times - flown_s)
        flown = np.where(times > flown_s, behind, flown)
        at = self.batch.take(path).points(flown)
        there = self.forecast.positions((self.start_s + times).ravel()).reshape(at.shape)
        gap = at - there
        apart: FloatArray = np.hypot(gap[..., 0], gap[..., 1])
        return apart


def draw(seed: int) -> Case:
    """Return a seed's forecast and its paths."""
    rng = np.random.default_rng(seed)
    now_s = float(rng.choice([0.0, EPOCH_S]))
    forecast = random_forecast(rng, now_s)
    rows = np.zeros((PATHS, COLUMNS))
    rows[:, STRAIGHTS] = rng.exponential(150.0, (PATHS, 3)) * (rng.random((PATHS, 3)) < 0.7)
    rows[:, TURNS] = rng.uniform(-4.0, 4.0, (PATHS, 4)) * (rng.random((PATHS, 4)) < 0.7)
    x, y = forecast.positions([now_s])[0] + rng.normal(0.0, 300.0, 2)
    batch = PathBatch(
        Pose(float(x), float(y), rng.uniform(-math.pi, math.pi)), rng.uniform(60.0, 250.0), rows
    )
    return Case(
        batch,
        forecast,
        now_s + float(rng.uniform(-5.0, 10.0)),
        rng.uniform(12.0, 30.0, PATHS),
        float(rng.uniform(12.0, 30.0)) if rng.random() < 0.5 else None,
    )


def random_forecast(rng: np.random.Generator, now_s: float) -> Forecast:
    """Return a forecast of any kind that is made in flight, the helicopter near the origin."""
    kind = KINDS[rng.integers(len(KINDS))]
    speed, accel = rng.uniform(12.0, 32.0), rng.uniform(1.0, 4.0)
    at_s = now_s + rng.uniform(-10.0, 25.0)
    x, y = rng.normal(0.0, 100.0, 2).tolist()
    pose = Pose(x, y, rng.uniform(-math.pi, math.pi))
    if kind == "corner":
        return cornering(
            at_s,
            pose,
            speed_mps=speed,
            accel_mps2=accel,
            turn_rad=rng.uniform(-2.4, 2.4),
            hover_s=max(0.0, rng.uniform(-5.0, 15.0)),
            leaving_mps2=rng.uniform(1.0, 4.0),
        )
    if kind == "stop":
        stand = Stretch(at_s + speed / accel, pose.offset(speed**2 / (2.0 * accel)), 0.0)
        return Forecast((Stretch(at_s, pose, speed, -accel), stand), pose, at_s + 100.0, speed)
    if kind == "depart":
        return departing(at_s, pose, rng.uniform(0.0, 12.0), speed_mps=speed, accel_mps2=accel)
    if kind == "list":
        motion = Motion(now_s, pose.x_m, pose.y_m, speed, 0.0)
        return along_list(motion, rng.normal(0.0, 400.0, (6, 2)), now_s, 60.0)
    if kind == "circle":
        return _circling(pose, at_s, speed, rng.uniform(-0.3, 0.3))
    return cruising(at_s, pose, speed)


def _circling(pose: Pose, at_s: float, speed_mps: float, rate: float) -> Forecast:
    """Return an arc of straight steps."""
    stretches = []
    for i in range(40):
        stretches.append(Stretch(at_s + 2.0 * i, pose, speed_mps))
        pose = pose.offset(2.0 * speed_mps)
        pose = Pose(pose.x_m, pose.y_m, pose.heading_rad + 2.0 * rate)
    return Forecast(tuple(stretches), stretches[-1].start, at_s, speed_mps)
