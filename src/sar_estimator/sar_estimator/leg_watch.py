"""What the newest rows of a leg say of it: that it is kept, strayed from, or slowed on."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sar_estimator.compiled import compiled
from sar_estimator.corner_detector import (
    AccelPrior,
    decelerations,
    first_grid,
    log_bayes_factor,
)
from sar_estimator.leg import (
    MISFIT_LIMIT,
    LegFit,
    first_since,
    fit_line,
    leg_fit,
    misfit_across,
    rows_along,
)
from sar_estimator.states import FloatArray


class LegEvidence(NamedTuple):
    """``log_bayes``: the log Bayes factor of "slowing" against "not", None of a leg strayed from.

    ``steady``: the fit to all rows, the newest too, where they show no slowing; None where they do.
    """

    log_bayes: float | None
    steady: LegFit | None

    @property
    def strays(self) -> bool:
        """Whether the newest rows depart sideways: the helicopter is changing course."""
        return self.log_bayes is None


@compiled(
    "Tuple((float64, float64, float64[::1]))"
    "(float64[:, ::1], float64, UniTuple(float64, 2), UniTuple(float64, 2), UniTuple(float64, 3),"
    " UniTuple(float64, 2), float64[::1], float64[::1])"
)
def _weighed(
    rows: FloatArray,
    time_s: float,
    position_m: tuple[float, float],
    velocity_mps: tuple[float, float],
    spread: tuple[float, float, float],
    onset_range_s: tuple[float, float],
    accels_mps2: FloatArray,
    log_weights: FloatArray,
) -> tuple[float, float, FloatArray]:
    """Return the misfit across a fit's line, the log Bayes factor, and the fit to all rows.

    What is not asked for any more is 0 and empty.
    """
    newer = rows[first_since(rows, time_s + 1e-9) :]
    across = misfit_across(newer, time_s, position_m, velocity_mps, spread)
    if across > MISFIT_LIMIT:
        return across, 0.0, np.empty(0)
    along = rows_along(rows, position_m, velocity_mps)
    onsets, log_prior = first_grid(onset_range_s, log_weights)
    speed = math.hypot(velocity_mps[0], velocity_mps[1])
    log_bayes = log_bayes_factor(
        along[0], along[1], along[2], along[3], speed, onsets, accels_mps2, log_prior
    )
    return across, log_bayes, fit_line(rows) if log_bayes < 0.0 else np.empty(0)


def watch_leg(
    rows: FloatArray,
    fit: LegFit,
    *,
    onset_range_s: tuple[float, float],
    accel_prior: AccelPrior,
) -> LegEvidence:
    """Weigh the rows of a leg, shape (n, 5), against the fit to those of them that are settled.

    The Bayes factor is that of ``stop_posterior``.
    """
    known = (fit.time_s, fit.position_m, fit.velocity_mps, fit.spread)
    across, log_bayes, whole = _weighed(rows, *known, onset_range_s, *decelerations(accel_prior))
    if across > MISFIT_LIMIT:
        return LegEvidence(log_bayes=None, steady=None)
    steady = None
    if whole.size:
        found, misfit = leg_fit(rows, whole)
        steady = found if misfit < MISFIT_LIMIT else None
    return LegEvidence(log_bayes=log_bayes, steady=steady)
