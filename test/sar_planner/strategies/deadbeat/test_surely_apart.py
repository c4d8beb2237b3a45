"""What a corner's list is sure to keep is told as long as the corner may be another."""

from dataclasses import replace

import numpy as np
import pytest

from sar_estimator.common.states import Phase
from sar_planner.prediction.separation import least_apart_m
from sar_planner.strategies.deadbeat.corner_planning import plan_corner
from sar_planner.strategies.deadbeat.surely_apart import with_sure


def kept(tick_at, state, corner, now_s=104.0):
    tick = tick_at(now_s, corner=corner)
    found = with_sure(plan_corner(state, tick).state, tick)
    return found, tick


def test_a_rules_path_keeps_less_for_sure_than_from_what_is_expected(tick_at, state, corner):
    found, tick = kept(tick_at, state, corner)
    sure, path = found.corner.sure, found.path
    rest = path.path.cut(path.flown_m)
    expected = least_apart_m(
        rest, tick.forecasts_in(path.frame), start_s=104.0, speed_mps=path.speed_mps
    )
    assert 100.0 < sure.distance_m < expected + 50.0
    assert corner.stop_time_s + 6.0 < sure.until_s < corner.stop_time_s + 10.0


def test_the_less_is_known_the_less_is_sure(tick_at, state, corner):
    late = replace(corner, stop_time_sigma_s=2.0)
    beside = replace(corner, covariance=np.diag((900.0, 100.0)))
    sure, later, wider = (
        kept(tick_at, state, one)[0].corner.sure for one in (corner, late, beside)
    )
    assert later.distance_m < sure.distance_m
    assert later.until_s > sure.until_s
    # Twice what is across the leg, instead of twice the leg's own 0.5 m: along it the onset's
    # doubt has it already.
    assert wider.distance_m == pytest.approx(sure.distance_m - 19.0, abs=2.0)


def test_what_the_uav_is_beside_its_path_is_taken_off(tick_at, state, corner):
    found, tick = kept(tick_at, state, corner)
    tick.situation.set_uav(tick.situation.uav._replace(y_m=-262.0))
    off = with_sure(found, tick).corner.sure
    assert off.distance_m == pytest.approx(found.corner.sure.distance_m - 12.0, abs=1.0)


def test_once_it_has_stopped_and_without_a_corner_nothing_is_told(tick_at, state, corner):
    found, tick = kept(tick_at, state, corner)
    tick.situation.set_phase(Phase.STOPPED)
    assert with_sure(found, tick).corner.sure is None
    assert with_sure(state, tick) is state
