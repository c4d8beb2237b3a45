"""A helicopter flown by a human: what he does is within what his kind says."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sar_estimator.common.constants import G_MPS2
from sar_planner.prediction.forecast import departing
from sar_sim.scenario.presets import PILOTS
from sar_sim.scenario.scenario import Pattern, Pilot
from sar_sim.world.helicopter import PatternHelicopter
from sar_sim.world.human_helicopter import HumanHelicopter, flown_by, slowing, wander

V, A = 20.0, 2.5
SQUARE = Pattern(first_leg_m=1500.0, corners=6)


def pilot(kind="human", seed=1, **changed):
    return replace(Pilot(kind=kind, seed=seed), **{**PILOTS[kind], **changed})


def flown(kind="human", seed=1, pattern=SQUARE, **changed):
    return flown_by(pilot(kind, seed, **changed), pattern, V, A)


def test_a_robot_flies_the_papers_model_and_others_do_not():
    assert isinstance(flown("robot"), PatternHelicopter)
    for kind in ("steady", "human", "rough"):
        assert isinstance(flown(kind), HumanHelicopter)
    assert isinstance(flown("robot", roll_share=1.0), HumanHelicopter)


@settings(max_examples=25, deadline=None)
@given(
    st.sampled_from(["steady", "human", "rough"]), st.integers(0, 1000), st.sampled_from([1, -1])
)
def test_every_flight_is_smooth_and_flies_its_corners(kind, seed, side):
    helicopter = flown(kind, seed, replace(SQUARE, turn_side=side))
    assert [corner.k for corner in helicopter.corners] == [1, 2, 3, 4, 5, 6]
    onsets = [corner.onset_time_s for corner in helicopter.corners]
    assert onsets == sorted(onsets)
    rng = np.random.default_rng(seed)
    for t in rng.uniform(1.0, helicopter.end_s - 1.0, 30):
        a, b = helicopter.motion(t - 0.01), helicopter.motion(t + 0.01)
        m = helicopter.motion(t)
        assert math.hypot(b.x_m - a.x_m, b.y_m - a.y_m) < 0.02 * 40.0
        # A step of the simulation changes the velocity by no more than gusts and a bank can.
        assert (b.x_m - a.x_m) / 0.02 == pytest.approx(m.vx_mps, abs=1.5)
    for corner in helicopter.corners:
        turned = [helicopter.heading_rad(t) for t in (corner.onset_time_s, corner.stop_time_s + 25)]
        assert -side * math.degrees(turned[1] - turned[0]) == pytest.approx(90.0, abs=12.0)


def test_the_same_seed_is_the_same_flight():
    assert flown(seed=3).corners == flown(seed=3).corners != flown(seed=4).corners


@pytest.mark.parametrize("kind", ["steady", "human", "rough"])
def test_wander_has_the_size_its_kind_says(kind):
    p = pilot(kind, gust_mps2=0.0)
    rng = np.random.default_rng(0)
    drawn = rng.standard_normal((2, 100_000, 2))
    settings_ = np.array(
        [p.wander_along_mps, p.wander_across_mps, p.wander_time_s, p.wander_damping, 0.0, 3.0]
    )
    courses, shares = np.zeros(100_000), np.ones(100_000)
    found = wander(drawn[0], drawn[1], courses, shares, np.zeros((2, 2)), settings_)[5000:]
    sizes = np.array((p.wander_along_mps, p.wander_across_mps))
    assert found[:, 2:].std(axis=0) == pytest.approx(sizes, rel=0.1)
    assert found[:, :2].std(axis=0) == pytest.approx(16.0 * sizes, rel=0.15)


def test_a_rough_pilot_wanders_as_recorded_helicopters_do():
    """0.1 to 0.3 m/s^2 over 40 s in cruise, 2 to 16 m across: what recorded ones show."""
    helicopter = flown_by(pilot("rough"), Pattern(first_leg_m=60_000.0, corners=1), V, A)
    times = np.arange(10.0, 2000.0, 1.0)
    across = np.array([helicopter.motion(t).x_m for t in times])
    line = np.polyfit(times, across, 1)
    assert 4.0 < np.std(across - np.polyval(line, times)) < 20.0


def test_slowing_builds_up_stays_within_limits_and_is_eased_off():
    speeds = slowing(V, 0.0, A, 1.5, 4.0, np.zeros(1))
    accels = -np.diff(np.concatenate(((V,), speeds))) / 0.1
    assert accels[0] < 0.3
    assert accels.max() == pytest.approx(A, rel=0.05)
    assert (accels[:14] >= np.arange(14) * 0.15).all()
    assert accels[-5] < 1.0
    assert speeds[-1] == 0.0
    at_once = slowing(V, 0.0, A, 0.0, 0.0, np.zeros(1))
    assert len(at_once) == pytest.approx(V / A / 0.1, abs=1)


def speeds_in(helicopter, corner):
    return [
        helicopter.motion(t).speed_mps
        for t in np.arange(corner.onset_time_s, corner.onset_time_s + 30.0, 0.1)
    ]


def test_a_corner_that_is_passed_has_no_stop():
    helicopter = flown(pass_share=1.0, wander_along_mps=0.0, wander_across_mps=0.0, gust_mps2=0.0)
    for corner in helicopter.corners:
        assert min(speeds_in(helicopter, corner)) == pytest.approx(4.0, abs=0.3)
    standing = flown(pass_share=0.0, wander_along_mps=0.0, wander_across_mps=0.0, gust_mps2=0.0)
    for corner in standing.corners:
        assert min(speeds_in(standing, corner)) < 0.1


def test_a_rolled_corner_is_turned_at_its_bank_and_costs_what_the_geometry_says():
    """V T_h = Y + Lambda, Lambda = 2V(V - v)/a + pi rho V/(2v) - x0, x0 = (V^2 - v^2)/2a + rho."""
    for v, rho in ((12.0, 40.0), (16.0, 75.0)):
        bank = math.degrees(math.atan(v**2 / (G_MPS2 * rho)))
        helicopter = flown("robot", roll_share=1.0, roll_mps=v, bank_deg=bank)
        corner = helicopter.corners[0]
        x0 = (V**2 - v**2) / (2 * A) + rho
        assert math.dist(corner.onset[:2], corner.stop[:2]) == pytest.approx(x0, abs=1.0)
        lost_m = 2 * V * (V - v) / A + math.pi * rho * V / (2 * v) - x0 - x0
        equal = V**2 / (2.0 * corner.accel_mps2)
        # A step of the simulation is 2 m of the way.
        assert equal == pytest.approx(max(0.5 * lost_m, 0.5), abs=1.5)
        assert min(speeds_in(helicopter, corner)) == pytest.approx(v, abs=0.2)
        # From then on it is where a stop that costs as much would have it.
        stop = corner.stop
        out = stop._replace(heading_rad=stop.heading_rad - math.pi / 2.0)
        like = departing(corner.stop_time_s, out, 0.0, speed_mps=V, accel_mps2=corner.accel_mps2)
        later = corner.stop_time_s + 30.0
        x, y = like.positions([later])[0]
        there = helicopter.motion(later)
        assert math.hypot(there.x_m - x, there.y_m - y) < 3.0


def test_odd_actions_are_flown_by_humans_too():
    other = flown(anomaly_corner=2, anomaly="other_way")
    plain = flown()
    turned = [
        h.heading_rad(h.corners[1].stop_time_s + 25.0) - h.corners[1].onset.heading_rad
        for h in (other, plain)
    ]
    assert turned[0] * turned[1] < 0.0
    gone = flown(anomaly_corner=2, anomaly="break_off")
    assert len(gone.corners) == 2
    assert gone.motion(gone.end_s - 5.0).speed_mps > 1.4 * V
    slowed = flown(anomaly_corner=2, anomaly="go_on", wander_along_mps=0.0)
    begin, end = slowed.corners[0].stop_time_s + 25.0, slowed.corners[1].onset_time_s
    least = min(slowed.motion(t).speed_mps for t in np.arange(begin, end, 0.5))
    assert least == pytest.approx(V / 3.0, abs=1.5)


def test_a_leg_too_short_is_named():
    with pytest.raises(ValueError, match="leg 1 of 60 m: expected at least"):
        flown(pattern=replace(SQUARE, first_leg_m=60.0))
