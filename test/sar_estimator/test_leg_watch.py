import numpy as np
import pytest

from sar_estimator.corner_detector import AccelPrior, stop_posterior
from sar_estimator.leg import fit_line, leg_fit
from sar_estimator.leg_watch import watch_leg

PRIOR = AccelPrior(2.5, 0.3)
SPEED = 20.0
SETTLED = 30


def table(newer):
    """Rows of a leg flown east, and what came after."""
    settled = [(float(t), SPEED * t, 0.0, 1.0, 0.0) for t in range(SETTLED)]
    return np.array(settled + [(SETTLED + float(t), x, y, 1.0, 0.0) for t, (x, y) in newer])


def watched(newer):
    rows = table(list(enumerate(newer)))
    fit, _ = leg_fit(rows[:SETTLED], fit_line(rows[:SETTLED]))
    last = float(rows[-1, 0])
    onsets = (last - 10.0, last)
    return rows, fit, onsets, watch_leg(rows, fit, onset_range_s=onsets, accel_prior=PRIOR)


def test_a_leg_kept_is_steady_to_its_newest_row():
    rows, _, _, seen = watched([(SPEED * (SETTLED + t), 0.0) for t in range(5)])
    assert not seen.strays
    assert seen.log_bayes < 0.0
    assert seen.steady.time_s == rows[-1, 0]
    assert seen.steady.speed_mps == pytest.approx(SPEED)


def test_a_change_of_course_strays():
    *_, seen = watched([(SPEED * SETTLED + 15.0 * t, 10.0 * t) for t in range(5)])
    assert seen.strays
    assert (seen.log_bayes, seen.steady) == (None, None)


def test_a_change_of_speed_is_slowing_by_the_posteriors_own_evidence():
    rows, fit, onsets, seen = watched([(SPEED * (SETTLED + t) - 1.2 * t**2, 0.0) for t in range(6)])
    wanted = stop_posterior(
        fit.project(rows), onset_range_s=onsets, speed_mps=fit.speed_mps, accel_prior=PRIOR
    )
    assert not seen.strays
    assert seen.log_bayes == pytest.approx(wanted.log_bayes_factor)
    assert seen.log_bayes > 10.0
    assert seen.steady is None
