"""The estimator against simulated flights, and against every kind of bad fix."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.checked import read
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.states import Phase
from sar_estimator.estimation.estimator import HelicopterEstimator
from sar_estimator.estimation.fix_screen import Verdict
from sar_estimator.estimation.parameters import EstimatorParameters

DATUM = Datum(37.8, -122.8)
V, A = 20.0, 2.5


def fix_at(time_s, x, y, sigma=3.0):
    latitude, longitude, _ = DATUM.to_geodetic(x, y)
    return Fix(time_s, latitude, longitude, 0.0, np.eye(2) * max(sigma, 0.1) ** 2)


def along(time_s, onset):
    """Distance and speed of a flight at V that slows with A from ``onset`` to a stand."""
    slowing = min(max(time_s - onset, 0.0), V / A)
    return V * min(time_s, onset) + V * slowing - 0.5 * A * slowing**2, V - A * slowing


def fly(onset, *, sigma, seed, until=None, doppler=0.0, turn=True):
    """Fly east, stop at a corner, go on south; yield (time, estimator) after every fix."""
    rng = np.random.default_rng(seed)
    estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
    start = rng.uniform(0.0, 1.0)
    for i in range(int(until or onset + 60.0)):
        t = i + start
        x, speed = along(t, onset)
        going = min(max(t - onset - V / A, 0.0), V / A) if turn else 0.0
        y = -0.5 * A * going**2 - V * max(t - onset - 2 * V / A, 0.0) * turn
        noise = sigma * rng.standard_normal(2)
        if doppler:
            velocity = np.array((speed, 0.0)) + doppler * rng.standard_normal(2)
            estimator.add_velocity(t, *velocity, doppler)
        estimator.add_fix(fix_at(t, x + noise[0], y + noise[1], sigma))
        yield t, estimator


def detection_delay(seed, *, sigma=3.0, doppler=0.0):
    onset = 60.0 + np.random.default_rng(seed + 5000).uniform(0.0, 1.0)
    for t, estimator in fly(onset, sigma=sigma, seed=seed, doppler=doppler, until=90.0):
        if estimator.phase(t) is Phase.DECELERATING:
            return t - onset
    return math.inf


def test_detection_delay_at_3_m_noise():
    delays = np.array([detection_delay(seed) for seed in range(120)])
    assert (delays > 0.0).all()
    assert np.median(delays) <= 3.8
    assert np.percentile(delays, 95) <= 4.8


def test_detection_delay_with_doppler():
    delays = np.array([detection_delay(seed, doppler=0.1) for seed in range(60)])
    assert (delays > 0.0).all()
    assert np.percentile(delays, 95) <= 1.5


def test_no_false_alarm_in_an_hour_of_straight_flight():
    for t, estimator in fly(1e9, sigma=3.0, seed=7, until=3600):
        assert estimator.corner is None, t
    assert estimator.withdrawn_corners == 0


def test_position_is_better_than_the_fixes():
    errors = [
        (estimator.predict(t).motion.x_m - V * t, estimator.predict(t).motion.y_m)
        for t, estimator in fly(1e9, sigma=3.0, seed=3, until=600)
        if t > 20.0
    ]
    assert np.sqrt(np.mean(np.square(errors), axis=0)).max() < 2.0


def test_covariance_is_honest_on_a_leg():
    ratios = []
    for seed in range(20):
        *_, (t, estimator) = fly(1e9, sigma=3.0, seed=seed, until=60)
        estimate = estimator.predict(t)
        ratios.append((estimate.motion.x_m - V * t) / math.sqrt(estimate.covariance[0, 0]))
    assert np.std(ratios) < 1.5


def test_the_leg_has_the_newest_fixes_too_while_they_do_not_look_like_slowing():
    newest, off = [], []
    for seed in range(20):
        for t, estimator in fly(1e9, sigma=3.0, seed=seed, until=40):
            if t > 12.0:
                leg = estimator.leg
                newest.append(leg.time_s == pytest.approx(t, abs=1e-6))
                ahead = leg.foot.offset(leg.speed_mps * (t - leg.time_s))
                off.append((ahead.x_m - V * t) / leg.position_sigma_m)
    assert np.mean(newest) > 0.8
    assert np.sqrt(np.mean(np.square(off))) < 1.3


def test_slowing_does_not_bend_the_leg():
    """Nor what the planner is told of it until the slowing is seen."""
    slow = []
    for seed in range(40):
        for t, estimator in fly(30.0, sigma=3.0, seed=seed, until=40, turn=False):
            if t > 30.0 and estimator.phase(t) is Phase.CRUISE:
                slow.append(estimator.leg.speed_mps - V)
            if estimator.phase(t) is Phase.DECELERATING:
                assert estimator.leg.time_s < 30.5
    assert np.mean(slow) > -0.3
    assert np.min(slow) > -1.5


def test_corner_is_predicted_refined_and_left():
    onset = 60.0
    phases, errors = [], []
    for t, estimator in fly(onset, sigma=1.0, seed=1):
        phases.append(estimator.phase(t))
        if estimator.phase(t) in (Phase.DECELERATING, Phase.STOPPED):
            corner = estimator.corner
            stop = V * onset + V**2 / (2 * A)
            errors.append(math.hypot(corner.stop.x_m - stop, corner.stop.y_m))
            assert corner.stop.heading_rad == pytest.approx(0.0, abs=0.03)
            assert corner.stop_time_s == pytest.approx(onset + V / A, abs=2.5)
            sigma = math.sqrt(np.linalg.eigvalsh(corner.covariance).max())
            assert errors[-1] < 5.0 * sigma + 1.0
    order = [p for i, p in enumerate(phases) if i == 0 or p is not phases[i - 1]]
    assert order == [
        Phase.ACCELERATING,
        Phase.CRUISE,
        Phase.DECELERATING,
        Phase.STOPPED,
        Phase.ACCELERATING,
        Phase.CRUISE,
    ]
    assert errors[-1] < 3.0
    assert estimator.leg.foot.heading_rad == pytest.approx(-math.pi / 2, abs=0.05)
    assert estimator.leg.speed_mps == pytest.approx(V, abs=0.5)


def test_slowing_down_and_going_on_withdraws_the_corner():
    estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
    x, v, seen = 0.0, V, set()
    for i in range(120):
        for _ in range(10):
            accel = -2.0 if 60 <= i < 64 else 2.0 if 64 <= i < 68 else 0.0
            v = max(0.0, v + 0.1 * accel)
            x += 0.1 * v
        estimator.add_fix(fix_at(float(i), x, 0.0, 1.0))
        seen.add(estimator.phase(float(i)))
    assert Phase.DECELERATING in seen
    assert estimator.withdrawn_corners == 1
    assert estimator.phase(119.0) is Phase.CRUISE
    assert estimator.corner is None


@pytest.mark.parametrize("slowest", [8.0, 12.0, 16.0])
def test_slowing_without_stopping_is_withdrawn_and_teaches_nothing(slowest):
    estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
    x, v = 0.0, V
    for i in range(120):
        for _ in range(10):
            accel = (
                -2.5 if i >= 60 and v > slowest and i < 75 else 2.0 if i >= 75 and v < V else 0.0
            )
            v += 0.1 * accel
            x += 0.1 * v
        estimator.add_fix(fix_at(float(i), x, 0.0, 1.0))
    assert estimator.withdrawn_corners == 1
    assert estimator._tracker._prior.centre_mps2 == 2.5
    assert estimator.phase(119.0) is Phase.CRUISE


def test_hover_keeps_stopped_until_it_leaves():
    estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
    rng = np.random.default_rng(5)
    phases = {}
    for t in range(140):
        x = along(t, 60.0)[0]
        y = -0.5 * A * min(max(t - 98.0, 0.0), 8.0) ** 2 - V * max(t - 106.0, 0.0)
        estimator.add_fix(fix_at(float(t), *(np.array((x, y)) + rng.standard_normal(2)), 1.0))
        phases[t] = estimator.phase(float(t))
    assert all(phases[t] is Phase.STOPPED for t in range(70, 98))
    assert phases[103] is Phase.ACCELERATING
    assert phases[139] is Phase.CRUISE


def bad_fixes(time_s):
    good = fix_at(time_s, V * time_s, 0.0)
    return {
        Verdict.NO_FIX: Fix(time_s, good.latitude_deg, good.longitude_deg, has_fix=False),
        Verdict.NOT_FINITE: Fix(time_s, math.nan, good.longitude_deg),
        Verdict.OUT_OF_ORDER: fix_at(time_s - 1.5, V * time_s, 0.0),
        Verdict.OUTLIER: fix_at(time_s, V * time_s + 300.0, 0.0),
    }


@pytest.mark.parametrize("verdict", [*bad_fixes(0.0), Verdict.DUPLICATE, Verdict.REPEATED])
def test_bad_fixes_are_counted_and_move_nothing(verdict):
    *_, (t, estimator) = fly(1e9, sigma=1.0, seed=2, until=40)
    last = fix_at(t, V * t, 0.0)
    estimator.add_fix(fix_at(t + 1.0, V * (t + 1.0), 0.0))
    before = estimator.predict(t + 2.0).motion
    if verdict is Verdict.DUPLICATE:
        bad = fix_at(t + 1.0, V * t + 50.0, 0.0)
    elif verdict is Verdict.REPEATED:
        repeated = fix_at(t + 1.0, V * (t + 1.0), 0.0)
        bad = Fix(t + 2.0, repeated.latitude_deg, repeated.longitude_deg)
    else:
        bad = bad_fixes(t + 2.0)[verdict]
    assert estimator.add_fix(bad) is verdict
    assert estimator.counts[verdict] == 1
    assert estimator.predict(t + 2.0).motion == before
    assert last.time_s < t + 1.0


def test_a_real_jump_is_followed_after_three_fixes():
    *_, (t, estimator) = fly(1e9, sigma=1.0, seed=2, until=40)
    verdicts = [estimator.add_fix(fix_at(t + i, V * (t + i), 500.0, 1.0)) for i in range(1, 5)]
    assert verdicts == [Verdict.OUTLIER, Verdict.OUTLIER, Verdict.JUMP, Verdict.ACCEPTED]
    assert estimator.predict(t + 4.0).motion.y_m == pytest.approx(500.0, abs=3.0)


def test_a_single_outlier_among_good_fixes_is_no_jump():
    *_, (t, estimator) = fly(1e9, sigma=1.0, seed=2, until=40)
    for i in range(1, 13):
        y = 400.0 if i % 3 == 0 else 0.0
        expected = Verdict.OUTLIER if i % 3 == 0 else Verdict.ACCEPTED
        assert estimator.add_fix(fix_at(t + i, V * (t + i), y, 1.0)) is expected
    assert abs(estimator.predict(t + 12.0).motion.y_m) < 3.0


def test_lost_and_found():
    *_, (t, estimator) = fly(1e9, sigma=1.0, seed=2, until=40)
    assert estimator.phase(t + 4.9) is Phase.CRUISE
    assert estimator.phase(t + 5.1) is Phase.LOST
    assert estimator.add_fix(fix_at(t + 30.0, V * (t + 30.0), 0.0)) is Verdict.ACCEPTED
    assert estimator.phase(t + 30.0) is Phase.ACCELERATING


def test_after_a_loss_only_what_can_have_been_reached_is_believed_at_once():
    *_, (t, estimator) = fly(1e9, sigma=1.0, seed=2, until=40)
    rng = np.random.default_rng(4)
    for i in range(1, 60):
        x, y = rng.uniform(-5e6, 5e6, 2)
        assert estimator.add_fix(fix_at(t + i, x, y)) is Verdict.OUTLIER
        assert (estimator.phase(t + i) is Phase.LOST) == (i > 5)
    assert estimator.add_fix(fix_at(t + 60.0, V * (t + 60.0), 0.0)) is Verdict.ACCEPTED
    assert estimator.phase(t + 60.0) is Phase.ACCELERATING


def test_where_several_fixes_agree_after_a_loss_it_is_believed_however_far():
    *_, (t, estimator) = fly(1e9, sigma=1.0, seed=2, until=40)
    verdicts = [estimator.add_fix(fix_at(t + 20.0 + i, 9e3 + V * i, 0.0)) for i in range(4)]
    assert verdicts == [Verdict.OUTLIER, Verdict.OUTLIER, Verdict.JUMP, Verdict.ACCEPTED]


def test_repeats_at_rest_are_real():
    estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
    verdicts = [estimator.add_fix(fix_at(float(t), 5.0, 5.0, 1.0)) for t in range(20)]
    assert set(verdicts) == {Verdict.ACCEPTED}
    assert estimator.phase(19.0) is Phase.STOPPED


def test_clock_set_back_starts_again():
    *_, (_, estimator) = fly(1e9, sigma=1.0, seed=2, until=40)
    assert estimator.add_fix(fix_at(1.0, 0.0, 0.0)) is Verdict.OUT_OF_ORDER
    estimator.restart_clock()
    assert estimator.predict(0.0) is None
    assert estimator.add_fix(fix_at(1.0, 0.0, 0.0)) is Verdict.ACCEPTED


def test_a_receiver_whose_clock_was_set_back_is_believed_in_the_end():
    *_, (_, estimator) = fly(1e9, sigma=1.0, seed=2, until=40)
    verdicts = [estimator.add_fix(fix_at(5.0 + i, 20.0 * i, 0.0, 1.0)) for i in range(8)]
    assert verdicts == [Verdict.OUT_OF_ORDER] * 5 + [Verdict.ACCEPTED] * 3


def test_first_fix_is_the_datum():
    estimator = HelicopterEstimator(EstimatorParameters())
    estimator.add_fix(Fix(0.0, 43.6, 1.4, 300.0))
    assert estimator.datum == Datum(43.6, 1.4, 300.0)
    motion = estimator.predict(0.0).motion
    assert (motion.x_m, motion.y_m) == pytest.approx((0.0, 0.0), abs=1e-6)


def test_bad_velocities_are_counted_and_move_nothing():
    *_, (t, estimator) = fly(1e9, sigma=1.0, seed=2, until=40)
    before = estimator.predict(t + 1.0).motion
    assert not estimator.add_velocity(t + 0.5, math.nan, 0.0, 0.1)
    assert not estimator.add_velocity(t - 5.0, V, 0.0, 0.1)
    assert not estimator.add_velocity(t + 0.5, 500.0, 0.0, 0.1)
    assert estimator.refused_velocities == 3
    assert estimator.add_velocity(t + 0.5, -V, 0.0, 0.1)  # looked at when the next fix comes
    assert estimator.predict(t + 1.0).motion == before
    estimator.add_fix(fix_at(t + 1.0, V * (t + 1.0), 0.0, 1.0))
    assert estimator.refused_velocities == 4
    assert estimator.predict(t + 1.0).motion.vx_mps == pytest.approx(V, abs=1.0)
    assert estimator.corner is None


def test_a_velocity_from_the_future_waits_and_harms_nothing():
    *_, (t, estimator) = fly(1e9, sigma=1.0, seed=2, until=40)
    estimator.add_velocity(t + 3600.0, V, 0.0, 0.1)
    for i in range(1, 10):
        assert estimator.add_fix(fix_at(t + i, V * (t + i), 0.0, 1.0)) is Verdict.ACCEPTED
    assert estimator.predict(t + 9.0).motion.x_m == pytest.approx(V * (t + 9.0), abs=3.0)


def test_one_wrong_velocity_does_not_leave_a_corner_standing():
    for wrong in (6.0, 10.0, 14.0, 17.0):
        corners = []
        estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
        for i in range(80):
            estimator.add_velocity(i, wrong if i == 60 else V, 0.0, 0.1)
            estimator.add_fix(fix_at(float(i), V * i, 0.0, 3.0))
            corners.append(estimator.corner is not None)
        assert sum(corners) <= 2, wrong
        assert estimator.phase(79.0) is Phase.CRUISE


def test_fix_without_altitude_is_a_datum_all_the_same():
    estimator = HelicopterEstimator(EstimatorParameters())
    assert estimator.add_fix(Fix(0.0, 43.6, 1.44, math.nan)) is Verdict.ACCEPTED
    assert estimator.datum == Datum(43.6, 1.44, 0.0)


@pytest.mark.parametrize("rate", [0.5, 2.0, 10.0])
def test_any_rate_from_half_a_hertz_to_ten(rate):
    estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
    rng = np.random.default_rng(8)
    detected = None
    for i in range(int(90 * rate)):
        t = i / rate
        noise = 1.0 * rng.standard_normal(2)
        estimator.add_fix(fix_at(t, along(t, 60.0)[0] + noise[0], noise[1], 1.0))
        if estimator.phase(t) is Phase.DECELERATING and detected is None:
            detected = t
    assert 60.0 < detected < 65.0


numbers = st.one_of(st.floats(), st.floats(-90.0, 90.0))


@settings(max_examples=80, deadline=None)
@given(st.lists(st.tuples(numbers, numbers, numbers, st.booleans()), max_size=40))
def test_no_fix_makes_the_estimate_infinite(rows):
    estimator = HelicopterEstimator(EstimatorParameters())
    for time_s, latitude, longitude, has_fix in rows:
        estimator.add_fix(Fix(time_s, latitude, longitude, has_fix=has_fix))
        if estimator.datum is not None and math.isfinite(time_s):
            estimate = estimator.predict(time_s)
            assert estimate is None or estimate.motion.is_finite()


def test_bad_parameters_are_named():
    with pytest.raises(ValueError, match=r"gate_chi2 = -1\.0: expected more than 0"):
        read(EstimatorParameters, {"gate_chi2": -1.0})
    with pytest.raises(ValueError, match="gate_chi2"):
        EstimatorParameters(gate_chi2=-1.0)


def test_a_velocity_that_comes_after_its_fix_is_used_at_once():
    """As most receivers' drivers send them: a corner is seen as soon as the other way round."""
    seen = []
    for late in (False, True):
        estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
        for i in range(90):
            x, speed = along(float(i), 60.0)
            if not late:
                estimator.add_velocity(float(i), speed, 0.0, 0.1)
            estimator.add_fix(fix_at(float(i), x, 0.0, 2.0))
            if late:
                estimator.add_velocity(float(i), speed, 0.0, 0.1)
            if estimator.corner is not None:
                seen.append(i)
                break
    assert seen[0] == seen[1] <= 62


def predicted(begin_s):
    """Corners predicted of a flight with velocities after their fixes, times since ``begin_s``."""
    rng = np.random.default_rng(4)
    estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
    found = []
    for t in range(120):
        x, speed = along(t, 40.3)
        away = min(max(t - 55.0, 0.0), V / A)
        y = -0.5 * A * away**2 - V * max(t - 55.0 - V / A, 0.0)
        noise = 0.4 * rng.standard_normal(2)
        estimator.add_fix(fix_at(begin_s + t, x + noise[0], y + noise[1], 0.5))
        estimator.add_velocity(begin_s + t, speed, -A * away, 0.07)
        corner = estimator.corner
        found.append((str(estimator.phase(begin_s + t)), corner and corner.stop_time_s - begin_s))
    return found


def test_times_of_the_epoch_do_as_well_as_small_ones():
    """A double is no finer than 0.2 us there: as fine as a tolerance must be."""
    small, large = predicted(0.0), predicted(1.8e9)
    phases = [phase for phase, _ in small]
    assert {"cruise", "decelerating", "stopped", "accelerating"} == set(phases)
    assert phases[-1] == "cruise"
    assert [phase for phase, _ in large] == [phase for phase, _ in small]
    for (_, one), (_, other) in zip(small, large, strict=True):
        assert one == pytest.approx(other, abs=1e-2)


def test_one_wrong_velocity_across_is_no_corner():
    for wrong in (2.0, 3.0, 4.0):
        estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
        for i in range(80):
            estimator.add_velocity(i, V, wrong if i == 60 else 0.0, 0.1)
            estimator.add_fix(fix_at(float(i), V * i, 0.0, 3.0))
            assert estimator.corner is None, (wrong, i)
        assert estimator.withdrawn_corners == 0


def rolled(t, *, onset=60.0, speed=12.0, radius=40.0, accel=A):
    """Place and velocity of a helicopter that slows to a speed and turns right without a stop."""
    slowing, arc = (V - speed) / accel, 0.5 * math.pi * radius / speed
    run = lambda s: V * s - 0.5 * accel * s**2  # noqa: E731
    if t < onset:
        return (V * t, 0.0), (V, 0.0)
    s = t - onset
    if s < slowing:
        return (V * onset + run(s), 0.0), (V - accel * s, 0.0)
    begin, turned = V * onset + run(slowing), min((s - slowing) * speed / radius, 0.5 * math.pi)
    x, y = begin + radius * math.sin(turned), -radius * (1.0 - math.cos(turned))
    going = max(0.0, s - slowing - arc)
    ramp = min(going, slowing)
    y -= speed * ramp + 0.5 * accel * ramp**2 + V * (going - ramp)
    v = speed + accel * ramp
    return (x, y), (v * math.cos(turned), -v * math.sin(turned))


@pytest.mark.parametrize("doppler", [True, False])
def test_a_corner_that_is_rolled_is_told_as_the_stop_that_costs_as_much(doppler):
    """v = 12, r = 40: where the lines cross is 91 m behind the onset, and s = (142 - 91) / 2."""
    rng = np.random.default_rng(3)
    estimator = HelicopterEstimator(EstimatorParameters(), DATUM)
    phases, corners = [], []
    for i in range(110):
        (x, y), velocity = rolled(float(i))
        if doppler:
            estimator.add_velocity(i, *(np.array(velocity) + 0.07 * rng.standard_normal(2)), 0.07)
        noise = (0.4 if doppler else 1.5) * rng.standard_normal(2)
        estimator.add_fix(fix_at(float(i), x + noise[0], y + noise[1], 1.5))
        phases.append(estimator.phase(float(i)))
        if estimator.corner is not None:
            corners.append(estimator.corner)
    order = [p for i, p in enumerate(phases) if i == 0 or p is not phases[i - 1]]
    assert order[1:] == [Phase.CRUISE, Phase.DECELERATING, Phase.ACCELERATING, Phase.CRUISE]
    assert estimator.withdrawn_corners == 0
    last = corners[-1]
    assert (last.stop.x_m, last.stop.y_m) == pytest.approx((V * 60.0 + 91.2, 0.0), abs=12.0)
    assert last.stop.heading_rad == pytest.approx(0.0, abs=0.05)
    passed = last.stop_time_s - 0.5 * last.speed_mps / last.accel_mps2
    assert passed == pytest.approx(60.0 + 91.2 / V, abs=1.0)
    assert last.stopping_distance_m == pytest.approx(25.5, abs=25.0)
    assert estimator.leg.foot.heading_rad == pytest.approx(-math.pi / 2.0, abs=0.05)


@pytest.mark.parametrize("turn_deg", [25.0, 40.0, 60.0])
@pytest.mark.parametrize("doppler", [0.0, 0.1])
def test_a_course_that_is_changed_by_less_than_a_corner_is_a_new_leg(turn_deg, doppler):
    """It was taken for a corner that is being turned for ever, its stop farther and farther off."""
    rng, estimator = np.random.default_rng(9), HelicopterEstimator(EstimatorParameters(), DATUM)
    x = y = course = 0.0
    seen = []
    for i in range(120):
        if i >= 60:
            course = min(course + math.radians(5.0), math.radians(turn_deg))
        x, y = x + V * math.cos(course), y + V * math.sin(course)
        noise = 2.0 * rng.standard_normal(2)
        if doppler:
            velocity = V * np.array((math.cos(course), math.sin(course)))
            estimator.add_velocity(
                float(i), *(velocity + doppler * rng.standard_normal(2)), doppler
            )
        estimator.add_fix(fix_at(float(i), x + noise[0], y + noise[1], 2.0))
        seen.append(estimator.phase(float(i)))
    assert seen[59] is Phase.CRUISE
    # Turned by 72 s at the latest; within half a minute it is a leg again, and stays one.
    assert set(seen[102:]) == {Phase.CRUISE}
    assert estimator.leg.foot.heading_rad == pytest.approx(math.radians(turn_deg), abs=0.05)
    assert estimator.corner is None
