"""What a path keeps from a tube of corners is kept from every corner in it."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.parameters.corner import CornerParameters
from sar_planner.prediction.forecast import cornering, cruising
from sar_planner.prediction.tube import (
    HALVINGS,
    LEAST_LATER_S,
    STEP_S,
    TURN_OFF_RAD,
    sure_apart,
    tube_about,
)
from sar_planner.prediction.tube_kernels import TURN_RAD, least_in_box, reach_m
from sar_planner.rules.deadbeat_rules import DeadbeatRules

P = CornerParameters()
ONSET_S, V, A = 100.0, P.speed_mps, P.accel_mps2
STOP = Pose(40.0, -30.0, 0.7)
SIDES = st.sampled_from([1.0, -1.0])


def expected(turn=-0.5 * math.pi):
    return cornering(ONSET_S, STOP, speed_mps=V, accel_mps2=A, turn_rad=turn, leaving_mps2=0.9 * A)


def one_of(values, turn_side=1.0):
    """Return the forecast of a corner of the tube, made as forecasts are."""
    later, share, speed, turn = values
    accel = share * A
    onset = STOP.offset(-(V**2) / (2.0 * A))
    stop = onset.offset(speed * later + speed**2 / (2.0 * accel))
    return cornering(
        ONSET_S + later,
        stop,
        speed_mps=speed,
        accel_mps2=accel,
        turn_rad=turn_side * turn,
        leaving_mps2=share * 0.9 * A,
    )


def path_of(lag, lead=60.0):
    """Return a rule's path beside this corner, and where the UAV is on it at the onset."""
    path = DeadbeatRules(P).plan(lag, lead_m=lead, separation_m=200.0).path
    begin = STOP.offset(path.start.x_m, path.start.y_m)
    return type(path)(begin._replace(heading_rad=STOP.heading_rad), path.segments)


@settings(max_examples=25, deadline=None)
@given(st.floats(-300.0, 900.0), st.floats(0.0, 6.0), st.integers(0, 1000))
def test_every_corner_of_a_tube_stays_as_far_away_as_is_sure(lag, since, seed):
    tube = tube_about(expected(), 0.8, 0.0)
    path = path_of(lag).cut(V * since)
    start_s = ONSET_S + since
    sure = sure_apart(path, tube, start_s=start_s, speed_mps=V, reaction_s=1.0)
    times = np.linspace(start_s, sure.until_s, 1500)
    flown = path.points(V * (times - start_s))
    rng = np.random.default_rng(seed)
    low, high = tube.box.T
    drawn = rng.uniform(low, high, (40, 4))
    least = math.inf
    for values in itertools.chain(itertools.product(*tube.box), drawn):
        gap = flown - one_of(values).positions(times)
        least = min(least, float(np.hypot(*gap.T).min()))
    assert sure.distance_m <= least + 1e-6
    assert sure.distance_m >= least - 60.0  # not so low as to say nothing


@given(st.floats(0.0, 30.0), st.floats(0.0, 30.0), st.integers(0, 10_000), st.floats(0.0, 20.0))
def test_the_reach_of_a_box_holds_all_its_corners_and_grows(one_s, other_s, seed, beside):
    rng = np.random.default_rng(seed)
    tube = tube_about(expected(), 1.0, beside)
    low, high = tube.box.T
    ends = rng.uniform(low, high, (2, 4))
    box = np.column_stack((ends.min(axis=0), ends.max(axis=0)))
    middle = box.mean(axis=1)
    first_s, last_s = sorted((one_s, other_s))
    reach = reach_m(box, middle, tube.nominal, first_s)
    assert reach <= reach_m(box, middle, tube.nominal, last_s) + 1e-9
    here = one_of(middle).positions([ONSET_S + first_s])
    for values in itertools.chain(itertools.product(*box), rng.uniform(*box.T, (20, 4))):
        away = np.hypot(*(one_of(values).positions([ONSET_S + first_s]) - here).T)
        assert away[0] + beside <= reach + 1e-6


def test_more_halvings_make_it_no_less_sure_and_what_is_beside_is_taken_off():
    flown = path_of(300.0).points(V * (2.0 + STEP_S * np.arange(33)))
    tube = tube_about(expected(), 0.8, 0.0)
    found = [
        least_in_box(flown, 2.0, STEP_S, tube.box, tube.nominal, 4.0, 2.0, halvings)
        for halvings in (0, 10, HALVINGS)
    ]
    bounds = [bound for bound, _, _ in found]
    assert bounds == sorted(bounds)
    assert bounds[0] < bounds[2] - 10.0
    for bound, nearest, box in found:
        assert bound <= nearest
        assert (box[:, 0] >= tube.box[:, 0]).all()
        assert (box[:, 1] <= tube.box[:, 1]).all()
    wider = tube_about(expected(), 0.8, 10.0)
    beside, _, _ = least_in_box(flown, 2.0, STEP_S, wider.box, wider.nominal, 4.0, 2.0, 0)
    assert beside == pytest.approx(bounds[0] - 10.0)


@given(SIDES, st.floats(1.1, 2.1), st.floats(0.0, 3.0))
def test_a_tube_is_about_the_expected_corner(side, turn, later):
    tube = tube_about(expected(side * turn), later, 3.0)
    assert tube.box.mean(axis=1) == pytest.approx([0.0, 1.0, V, side * turn])
    assert np.ptp(tube.box[TURN_RAD]) == pytest.approx(2.0 * TURN_OFF_RAD)
    assert -tube.box[0, 0] == max(later, LEAST_LATER_S)
    stop_s = ONSET_S + max(later, LEAST_LATER_S) + (V + 1.0) / (0.85 * A)
    assert tube.last_stop_s == pytest.approx(stop_s)


def test_what_is_no_corner_or_is_over_has_none():
    assert tube_about(cruising(0.0, STOP, V), 1.0, 0.0) is None
    hovering = cornering(0.0, STOP, speed_mps=V, accel_mps2=A, hover_s=5.0)
    assert tube_about(hovering, 1.0, 0.0) is None
    tube = tube_about(expected(), 1.0, 0.0)
    late_s = tube.last_stop_s + 60.0
    assert sure_apart(path_of(0.0), tube, start_s=late_s, speed_mps=V, reaction_s=1.0) is None


def test_before_the_onset_it_begins_with_that():
    tube = tube_about(expected(), 0.8, 0.0)
    early = path_of(0.0)
    before = type(early)(early.start.offset(-100.0), early.segments)
    sure = sure_apart(before, tube, start_s=ONSET_S - 5.0, speed_mps=V, reaction_s=1.0)
    assert ONSET_S < sure.until_s <= tube.last_stop_s + 6.0
    assert sure.distance_m > 150.0
