"""The straight leg being flown: a constant-velocity fit to the newest fixes that allow one."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from sar_estimator.constant_velocity import constant_velocity
from sar_estimator.corner_detector import TrackRows
from sar_estimator.plane import Pose
from sar_estimator.states import FloatArray, LegEstimate

MIN_ROWS = 6
MISFIT_LIMIT = 4.5
SETTLE_S = 5.0
MIN_SPACING_S = 0.4


def chi_square_z(chi_square: float, dof: int) -> float:
    """Return a chi-square value as standard deviations of a normal (Wilson & Hilferty 1931)."""
    variance = 2.0 / (9.0 * dof)
    return (math.cbrt(chi_square / dof) - 1.0 + variance) / math.sqrt(variance)


@dataclass(frozen=True, slots=True)
class LegRow:
    """One accepted measurement: position [m] with sigma [m], or a velocity [m/s] with sigma."""

    time_s: float
    x: float
    y: float
    sigma: float
    is_velocity: bool


@dataclass(frozen=True)
class LegFit:
    """A constant-velocity fit to rows, with times counted from ``time_s``."""

    time_s: float
    position_m: FloatArray
    velocity_mps: FloatArray
    covariance: FloatArray
    rows: tuple[LegRow, ...]

    @property
    def speed_mps(self) -> float:
        """Fitted speed [m/s]."""
        return float(np.hypot(*self.velocity_mps))

    @property
    def heading_rad(self) -> float:
        """Fitted heading [rad]."""
        return math.atan2(self.velocity_mps[1], self.velocity_mps[0])

    @property
    def line(self) -> Pose:
        """The fitted line: the position at ``time_s`` and the heading."""
        return Pose(float(self.position_m[0]), float(self.position_m[1]), self.heading_rad)

    def estimate(self) -> LegEstimate:
        """Return what is published of the fit."""
        speed = self.speed_mps
        sigma_v = math.sqrt(self.covariance[1, 1])
        return LegEstimate(
            time_s=self.time_s,
            foot=self.line,
            speed_mps=speed,
            position_sigma_m=math.sqrt(self.covariance[0, 0]),
            heading_sigma_rad=sigma_v / max(speed, sigma_v),
            speed_sigma_mps=sigma_v,
        )

    def strays(self, rows: tuple[LegRow, ...]) -> bool:
        """Whether rows depart sideways from the line: the helicopter is changing course."""
        c, s = math.cos(self.heading_rad), math.sin(self.heading_rad)
        spread = self.covariance
        chi_square = 0.0
        for row in rows:
            age = 0.0 if row.is_velocity else row.time_s - self.time_s
            x, y = (0.0, 0.0) if row.is_velocity else self.position_m
            known = (
                spread[1, 1]
                if row.is_velocity
                else (spread[0, 0] + 2.0 * age * spread[0, 1] + age**2 * spread[1, 1])
            )
            across = (row.y - y) * c - (row.x - x) * s
            chi_square += across**2 / (row.sigma**2 + float(known))
        return chi_square_z(chi_square, max(1, len(rows))) > MISFIT_LIMIT

    def project(self, rows: tuple[LegRow, ...]) -> TrackRows:
        """Return rows measured along the fitted line, from ``position_m``."""
        direction = self.velocity_mps / self.speed_mps
        xy = np.array([(row.x, row.y) for row in rows])
        is_velocity = np.array([row.is_velocity for row in rows])
        origin = np.where(is_velocity[:, None], 0.0, self.position_m)
        return TrackRows(
            times_s=np.array([row.time_s for row in rows]),
            values=(xy - origin) @ direction,
            sigmas=np.array([row.sigma for row in rows]),
            is_speed=is_velocity,
        )


def fit_rows(rows: tuple[LegRow, ...]) -> tuple[LegFit, float]:
    """Fit a constant velocity; return it with its misfit in standard deviations of chi-square.

    Both axes share one weighted least-squares design; the misfit is that of the worse axis, along
    or across the fitted direction.
    """
    reference = rows[-1].time_s
    is_velocity = np.array([row.is_velocity for row in rows])
    times = np.array([row.time_s - reference for row in rows])
    sigmas = np.array([row.sigma for row in rows])
    xy = np.array([(row.x, row.y) for row in rows]) / sigmas[:, None]
    q, r_inverse = constant_velocity(times, is_velocity, sigmas)
    solution = r_inverse @ (q.T @ xy)
    residuals = xy - q @ (q.T @ xy)
    fit = LegFit(reference, solution[0], solution[1], r_inverse @ r_inverse.T, rows)
    c, s = math.cos(fit.heading_rad), math.sin(fit.heading_rad)
    turned = residuals @ np.array([[c, -s], [s, c]])
    chi_square = float((turned**2).sum(axis=0).max())
    return fit, chi_square_z(chi_square, max(1, len(rows) - 2))


class LegTracker:
    """Keeps the newest rows of a leg and fits the longest stretch that is straight and steady."""

    def __init__(self, window_s: float) -> None:
        """Fit at most the last ``window_s`` [s]."""
        self._window_s = window_s
        self._rows: deque[LegRow] = deque()

    def add(self, row: LegRow) -> None:
        """Append a row and let old ones go.

        Rows of a kind closer than ``MIN_SPACING_S`` are left out: a receiver's errors over such
        times are alike, and more of them tell no more.
        """
        newest = next(
            (old for old in reversed(self._rows) if old.is_velocity == row.is_velocity), None
        )
        if newest is not None and row.time_s - newest.time_s < MIN_SPACING_S:
            return
        self._rows.append(row)
        while self._rows[0].time_s < row.time_s - self._window_s:
            self._rows.popleft()

    def rows_since(self, time_s: float) -> tuple[LegRow, ...]:
        """Return the rows not older than ``time_s`` [s]."""
        return tuple(row for row in self._rows if row.time_s >= time_s)

    def clear(self) -> None:
        """Forget the leg."""
        self._rows.clear()

    def fit(self) -> LegFit | None:
        """Fit the settled rows; None while too few of them agree.

        The newest ``SETTLE_S`` are left out where enough older ones remain, so that a slowing
        which has just begun does not bend the leg it is measured against. Where the helicopter has
        changed course or speed, older rows are let go for good.
        """
        settled_s = self._rows[-1].time_s - SETTLE_S if self._rows else 0.0
        rows = tuple(row for row in self._rows if row.time_s <= settled_s)
        if _positions(rows) < MIN_ROWS:
            rows = tuple(self._rows)
        dropped = 0
        while _positions(rows) >= MIN_ROWS:
            fit, misfit = fit_rows(rows)
            if misfit < MISFIT_LIMIT:
                for _ in range(dropped):
                    self._rows.popleft()
                return fit
            drop = max(1, len(rows) // 4)
            rows, dropped = rows[drop:], dropped + drop
        return None


def _positions(rows: tuple[LegRow, ...]) -> int:
    return sum(not row.is_velocity for row in rows)
