"""Paths on grids of poses: flyable, clear, onto the slot, ever sooner."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.pose import Pose
from sar_planner.paths.flight_path import Arc
from sar_planner.prediction.forecast import cornering, cruising, departing, tables_of
from sar_planner.prediction.separation import closest_over_time
from sar_planner.rejoin.hybrid_grid import GRIDS, soonest_on_grids

LEG = Pose(0.0, 250.0, 0.0)
FORECASTS = {
    "cruise": cruising(0.0, LEG, 20.0),
    "stands": departing(15.0, LEG, 0.0, speed_mps=20.0, accel_mps2=2.5),
    "corner": cornering(-3.0, Pose(0.0, 250.0, math.pi / 2), speed_mps=20.0, accel_mps2=2.5),
}
NEEDED_M = 205.0


def search(start, forecast, before_s=300.0, start_s=0.0):
    return soonest_on_grids(
        start,
        start_s,
        forecast.slot_x_m(start_s),
        (20.0, 18.0, 22.0),
        100.0,
        tables_of((forecast,)),
        needed_m=NEEDED_M,
        before_s=before_s,
    )


@settings(max_examples=25, deadline=None)
@given(
    st.floats(300.0, 700.0), st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi),
    st.sampled_from(sorted(FORECASTS)),
)  # fmt: skip
def test_paths_are_flyable_and_meet_the_slot(distance, bearing, heading, name):
    forecast = FORECASTS[name]
    x, y = forecast.positions([0.0])[0] + distance * np.array(
        (math.cos(bearing), math.sin(bearing))
    )
    found = search(Pose(float(x), float(y), heading), forecast)
    times = [met_s for _, met_s in found]
    assert times == sorted(times, reverse=True)
    for path, met_s in found:
        assert all(part.radius_m == 100.0 for part in path.segments if isinstance(part, Arc))
        end = path.end
        assert (end.x_m, end.y_m) == pytest.approx((forecast.slot_x_m(met_s), 0.0), abs=0.01)
        assert math.cos(end.heading_rad) == pytest.approx(1.0)
        assert 18.0 - 1e-6 <= path.length_m / met_s <= 22.0 + 1e-6


def test_a_path_flown_at_the_fastest_keeps_what_is_needed():
    # Behind the helicopter and beyond its line, heading across: it is caught up with all the way.
    (*_, (path, met_s)) = search(Pose(-300.0, 420.0, -1.0), FORECASTS["cruise"])
    speed_mps = path.length_m / met_s
    assert speed_mps == pytest.approx(22.0, abs=0.05)
    nearest = closest_over_time(path, FORECASTS["cruise"], start_s=0.0, speed_mps=speed_mps)
    assert nearest.distance_m == pytest.approx(NEEDED_M, abs=3.0)


def test_nothing_is_found_where_nothing_is_sooner():
    start = Pose(300.0, 500.0, 0.0)
    (*_, (_, soonest_s)) = search(start, FORECASTS["cruise"])
    assert search(start, FORECASTS["cruise"], before_s=0.8 * soonest_s) == []
    assert search(Pose(0.0, 100.0, 0.0), FORECASTS["cruise"]) == []  # too near already


def test_time_may_begin_anywhere():
    early, late = (
        search(
            Pose(x, 500.0, 2.0),
            cruising(at_s, Pose(x - 300.0, 250.0, 0.0), 20.0),
            at_s + 300.0,
            at_s,
        )
        for x, at_s in ((300.0, 0.0), (300.0, 1e5))
    )
    assert len(early) == len(late) > 0
    assert late[-1][1] - 1e5 == pytest.approx(early[-1][1], abs=0.2)
    assert len(GRIDS) >= len(early)
