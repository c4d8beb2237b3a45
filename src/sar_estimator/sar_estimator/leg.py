"""The straight leg being flown: a constant-velocity fit to the newest fixes that allow one."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sar_estimator.compiled import compiled
from sar_estimator.constant_velocity import constant_velocity
from sar_estimator.corner_detector import TrackRows
from sar_estimator.plane import Pose
from sar_estimator.states import FloatArray, LegEstimate

MIN_ROWS = 6
MISFIT_LIMIT = 4.5
SETTLE_S = 5.0
MIN_SPACING_S = 0.4
TIME, X, Y, SIGMA, IS_VELOCITY = range(5)
ROOM = 256


@compiled("float64(float64, int64)")
def chi_square_z(chi_square: float, dof: int) -> float:
    """Return a chi-square value as standard deviations of a normal (Wilson & Hilferty 1931)."""
    variance = 2.0 / (9.0 * dof)
    return (float(np.cbrt(chi_square / dof)) - 1.0 + variance) / math.sqrt(variance)


class LegRow(NamedTuple):
    """One accepted measurement: position [m] with sigma [m], or a velocity [m/s] with sigma."""

    time_s: float
    x: float
    y: float
    sigma: float
    is_velocity: bool


@compiled("float64[::1](float64[:, ::1])")
def fit_line(rows: FloatArray) -> FloatArray:
    """Fit a constant velocity to rows, shape (n, 5), of which two at least tell of the velocity.

    Returns x, y at the last row's time, vx, vy, the covariance of one axis' position and velocity
    (11, 12, 22), and the misfit: the chi-square of the worse axis, along or across the fitted
    direction, in standard deviations. Both axes share one weighted least-squares design.
    """
    times, sigmas = rows[:, TIME].copy(), rows[:, SIGMA].copy()
    q, (inverse11, inverse12, inverse22) = constant_velocity(
        times, rows[:, IS_VELOCITY] > 0.0, sigmas
    )
    fit = np.zeros((2, 2))
    for i in range(times.size):
        for axis in range(2):
            value = rows[i, X + axis] / sigmas[i]
            fit[0, axis] += q[i, 0] * value
            fit[1, axis] += q[i, 1] * value
    spread = np.zeros(3)
    for i in range(times.size):
        off_x = rows[i, X] / sigmas[i] - q[i, 0] * fit[0, 0] - q[i, 1] * fit[1, 0]
        off_y = rows[i, Y] / sigmas[i] - q[i, 0] * fit[0, 1] - q[i, 1] * fit[1, 1]
        spread[0] += off_x * off_x
        spread[1] += off_x * off_y
        spread[2] += off_y * off_y
    out = np.empty(8)
    for axis in range(2):
        out[axis] = inverse11 * fit[0, axis] + inverse12 * fit[1, axis]
        out[2 + axis] = inverse22 * fit[1, axis]
    out[4] = inverse11 * inverse11 + inverse12 * inverse12
    out[5], out[6] = inverse12 * inverse22, inverse22 * inverse22
    heading = math.atan2(out[3], out[2])
    c, s = math.cos(heading), math.sin(heading)
    along = c * c * spread[0] + 2.0 * c * s * spread[1] + s * s * spread[2]
    out[7] = chi_square_z(max(along, spread[0] + spread[2] - along), max(1, times.size - 2))
    return out


@compiled("int64(float64[:, ::1])")
def _positions(rows: FloatArray) -> int:
    """Return how many rows are positions."""
    count = 0
    for i in range(rows.shape[0]):
        if rows[i, IS_VELOCITY] == 0.0:
            count += 1
    return count


@compiled("int64(float64[:, ::1], float64)")
def first_since(rows: FloatArray, time_s: float) -> int:
    """Return the number of the first row not older than a time [s]."""
    first = len(rows)
    while first > 0 and rows[first - 1, TIME] >= time_s:
        first -= 1
    return first


@compiled("Tuple((int64, int64, float64[::1]))(float64[:, ::1])")
def _longest_fit(rows: FloatArray) -> tuple[int, int, FloatArray]:
    """Return the longest stretch that is straight and steady, its first row and end, and its fit.

    An empty stretch where too few rows agree.
    """
    end = int(np.searchsorted(rows[:, TIME], rows[-1, TIME] - SETTLE_S, side="right"))
    if _positions(rows[:end]) < MIN_ROWS:
        end = rows.shape[0]
    first = 0
    while _positions(rows[first:end]) >= MIN_ROWS:
        found = fit_line(rows[first:end])
        if found[7] < MISFIT_LIMIT:
            return first, end, found
        first += max(1, (end - first) // 4)
    return end, end, np.empty(0)


@compiled("float64(UniTuple(float64, 3), float64)")
def _variance_m2(spread: tuple[float, float, float], age_s: float) -> float:
    """Return the variance of one axis' position ``age_s`` after a fit's time [m^2]."""
    return spread[0] + 2.0 * age_s * spread[1] + age_s**2 * spread[2]


@compiled(
    "float64(float64[:, ::1], float64, UniTuple(float64, 2), UniTuple(float64, 2),"
    " UniTuple(float64, 3))"
)
def misfit_across(
    rows: FloatArray,
    time_s: float,
    position_m: tuple[float, float],
    velocity_mps: tuple[float, float],
    spread: tuple[float, float, float],
) -> float:
    """Return the misfit of rows across a fit's line, in standard deviations."""
    speed = math.hypot(velocity_mps[0], velocity_mps[1])
    c, s = velocity_mps[0] / speed, velocity_mps[1] / speed
    chi_square = 0.0
    for i in range(rows.shape[0]):
        x, y, known = rows[i, X], rows[i, Y], spread[2]
        if rows[i, IS_VELOCITY] == 0.0:
            x, y = x - position_m[0], y - position_m[1]
            known = _variance_m2(spread, rows[i, TIME] - time_s)
        across = y * c - x * s
        chi_square += across * across / (rows[i, SIGMA] * rows[i, SIGMA] + known)
    return chi_square_z(chi_square, max(1, rows.shape[0]))


@compiled(
    "Tuple((float64[::1], float64[::1], float64[::1], boolean[::1]))"
    "(float64[:, ::1], UniTuple(float64, 2), UniTuple(float64, 2))"
)
def rows_along(
    rows: FloatArray, position_m: tuple[float, float], velocity_mps: tuple[float, float]
) -> tuple[FloatArray, FloatArray, FloatArray, NDArray[np.bool_]]:
    """Return ``TrackRows``' arrays of rows, shape (n, 5), along a velocity from a place."""
    is_speed = rows[:, IS_VELOCITY] > 0.0
    values = np.empty(rows.shape[0])
    speed = math.hypot(velocity_mps[0], velocity_mps[1])
    ux, uy = velocity_mps[0] / speed, velocity_mps[1] / speed
    for i in range(rows.shape[0]):
        values[i] = rows[i, X] * ux + rows[i, Y] * uy
        if not is_speed[i]:
            values[i] -= position_m[0] * ux + position_m[1] * uy
    return rows[:, TIME].copy(), values, rows[:, SIGMA].copy(), is_speed


class LegFit(NamedTuple):
    """A constant-velocity fit to rows from ``since_s`` on, with times counted from ``time_s``.

    ``spread``: variances of one axis' position and velocity, and between them their covariance.
    """

    time_s: float
    since_s: float
    position_m: tuple[float, float]
    velocity_mps: tuple[float, float]
    spread: tuple[float, float, float]

    @property
    def speed_mps(self) -> float:
        """Fitted speed [m/s]."""
        return math.hypot(*self.velocity_mps)

    @property
    def heading_rad(self) -> float:
        """Fitted heading [rad]."""
        return math.atan2(self.velocity_mps[1], self.velocity_mps[0])

    @property
    def line(self) -> Pose:
        """The fitted line: the position at ``time_s`` and the heading."""
        return Pose(*self.position_m, self.heading_rad)

    def estimate(self) -> LegEstimate:
        """Return what is published of the fit."""
        speed, sigma_v = self.speed_mps, math.sqrt(self.spread[2])
        return LegEstimate(
            time_s=self.time_s,
            foot=self.line,
            speed_mps=speed,
            position_sigma_m=math.sqrt(self.spread[0]),
            heading_sigma_rad=sigma_v / max(speed, sigma_v),
            speed_sigma_mps=sigma_v,
        )

    def variance_m2(self, age_s: float) -> float:
        """Return the variance of one axis' position ``age_s`` after the fit's time [m^2]."""
        return _variance_m2(self.spread, age_s)

    def project(self, rows: FloatArray) -> TrackRows:
        """Return rows, shape (n, 5), measured along the fitted line, from ``position_m``."""
        return TrackRows(*rows_along(rows, self.position_m, self.velocity_mps))


def leg_fit(rows: FloatArray, found: FloatArray) -> tuple[LegFit, float]:
    """Return what ``fit_line`` found of rows, shape (n, 5), and its misfit."""
    x, y, vx, vy, c11, c12, c22, misfit = found.tolist()
    first, last = float(rows[0, TIME]), float(rows[-1, TIME])
    return LegFit(last, first, (x, y), (vx, vy), (c11, c12, c22)), misfit


class LegTracker:
    """Keeps the newest rows of a leg and fits the longest stretch that is straight and steady."""

    def __init__(self, window_s: float) -> None:
        """Fit at most the last ``window_s`` [s]."""
        self._window_s = window_s
        self._table = np.empty((ROOM, 5))
        self._begin = self._end = 0
        self._newest_s = [-math.inf, -math.inf]

    @property
    def rows(self) -> FloatArray:
        """The rows kept, shape (n, 5), in order of time."""
        return self._table[self._begin : self._end]

    def add(self, row: LegRow) -> None:
        """Append a row and let old ones go.

        Rows of a kind closer than ``MIN_SPACING_S`` are left out: a receiver's errors over such
        times are alike, and more of them tell no more.
        """
        if row.time_s - self._newest_s[row.is_velocity] < MIN_SPACING_S:
            return
        self._newest_s[row.is_velocity] = row.time_s
        if self._end == len(self._table):
            kept = self.rows.copy()
            if len(kept) > len(self._table) // 2:
                self._table = np.empty((2 * len(self._table), 5))
            self._table[: len(kept)] = kept
            self._begin, self._end = 0, len(kept)
        self._table[self._end] = row
        self._end += 1
        while self._table[self._begin, TIME] < row.time_s - self._window_s:
            self._begin += 1

    def clear(self) -> None:
        """Forget the leg."""
        self._begin = self._end = 0
        self._newest_s = [-math.inf, -math.inf]

    def fit(self) -> LegFit | None:
        """Fit the settled rows; None while too few of them agree.

        The newest ``SETTLE_S`` are left out where enough older ones remain, so that a slowing
        which has just begun does not bend the leg it is measured against. Where the helicopter has
        changed course or speed, older rows are let go for good.
        """
        rows = self.rows
        if len(rows) == 0:
            return None
        first, end, found = _longest_fit(rows)
        if first == end:
            return None
        self._begin += first
        return leg_fit(rows[first:end], found)[0]
