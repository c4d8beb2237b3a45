import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.pose import wrap_angle
from sar_planner.parameters.corner import CornerParameters
from sar_planner.prediction.separation import corner_forecast
from sar_sim.scenario.presets import PILOTS
from sar_sim.scenario.scenario import Pattern, Pilot
from sar_sim.world.helicopter import PatternHelicopter, flown_legs
from sar_sim.world.human_helicopter import flown_by

V, A = 20.0, 2.5


@pytest.mark.parametrize(
    ("kind", "corners"),
    [("sector", 6), ("parallel_track", 5), ("creeping_line", 4), ("track_line_return", 2)],
)
def test_every_pattern_is_flown_by_robot_and_human(kind, corners):
    pattern = Pattern(kind=kind, corners=corners, first_leg_m=3000.0, turn_side=-1)
    for pilot in (Pilot(), Pilot(**PILOTS["human"])):
        helicopter = flown_by(pilot, pattern, V, A)
        assert len(helicopter.corners) == corners
        turned = [
            wrap_angle(helicopter.heading_rad(corner.stop_time_s + 20.0) - corner.stop.heading_rad)
            for corner in helicopter.corners
        ]
        wanted = [leg.turn_rad for leg in flown_legs(pattern)[:-1]]
        assert turned == pytest.approx(wanted, abs=0.2)


def test_a_track_line_has_no_corner():
    helicopter = PatternHelicopter(Pattern(kind="track_line", corners=0), Pilot(), V, A)
    assert helicopter.corners == []
    assert helicopter.end_s == pytest.approx(2000.0 / V)


@pytest.mark.parametrize("side", [1, -1])
def test_square_spirals_outward_with_the_track_spacing(side):
    helicopter = PatternHelicopter(Pattern(turn_side=side), Pilot(), V, A)
    stops = np.array([(c.stop.x_m, c.stop.y_m) for c in helicopter.corners])
    assert stops[0] == pytest.approx((0.0, 2000.0), abs=1e-6)
    assert stops[1] == pytest.approx((side * 2000.0, 2000.0), abs=1e-6)
    # Parallel legs, one turn of the spiral apart.
    assert abs(stops[4][1] - stops[0][1]) == pytest.approx(500.0)
    assert abs(stops[5][0] - stops[1][0]) == pytest.approx(500.0)


def test_motion_at_a_corner_is_the_papers_model():
    helicopter = PatternHelicopter(Pattern(heading_deg=90.0), Pilot(), V, A)
    corner = helicopter.corners[0]
    times = np.linspace(0.0, 25.0, 51)
    expected = corner_forecast(CornerParameters()).positions(times)
    for t, xy in zip(times, expected, strict=True):
        motion = helicopter.motion(corner.onset_time_s + t)
        found = (
            corner.stop.along(motion.x_m, motion.y_m),
            corner.stop.across(motion.x_m, motion.y_m),
        )
        assert found == pytest.approx(tuple(xy), abs=1e-6)


@settings(max_examples=30)
@given(st.integers(0, 1000))
def test_velocity_and_acceleration_are_derivatives(seed):
    pilot = Pilot(0.5, 0.2, 50.0, 5.0, seed)
    helicopter = PatternHelicopter(Pattern(corners=3), pilot, V, A)
    rng = np.random.default_rng(seed)
    h = 1e-4
    for t in rng.uniform(1.0, helicopter.end_s - 1.0, 20):
        a, m, b = (helicopter.motion(t + d) for d in (-h, 0.0, h))
        smooth = (a.ax_mps2, a.ay_mps2) == (b.ax_mps2, b.ay_mps2)
        if smooth:
            assert (b.x_m - a.x_m) / (2 * h) == pytest.approx(m.vx_mps, abs=1e-4)
            assert (b.vy_mps - a.vy_mps) / (2 * h) == pytest.approx(m.ay_mps2, abs=1e-4)
        assert math.dist((a.x_m, a.y_m), (b.x_m, b.y_m)) < 0.01


def test_same_seed_same_pilot():
    pilots = [Pilot(0.5, 0.2, 50.0, 0.0, seed) for seed in (1, 1, 2)]
    one, same, other = (PatternHelicopter(Pattern(), p, V, A).corners for p in pilots)
    assert one == same
    assert one != other


def test_hover_lengthens_the_corner():
    plain = PatternHelicopter(Pattern(corners=1), Pilot(), V, A)
    hover = PatternHelicopter(Pattern(corners=1), Pilot(hover_s=12.0), V, A)
    assert hover.end_s - plain.end_s == pytest.approx(12.0)
    assert hover.motion(hover.corners[0].stop_time_s + 6.0).speed_mps == 0.0


def test_leg_too_short_is_named():
    with pytest.raises(ValueError, match="leg 1 of 50 m: expected at least 80 m"):
        PatternHelicopter(Pattern(first_leg_m=50.0), Pilot(), V, A)
