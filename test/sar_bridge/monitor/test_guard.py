"""The guard by itself: when, which way, and until when."""

import math

import numpy as np
import pytest

from sar_bridge.arduplane.l1_predictor import Route
from sar_bridge.monitor.guard import Guard
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.outlook import Outlook
from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common.states import Motion, Phase

AT = np.array([[400.0, 0.0], [4000.0, 0.0]])
BESIDE = np.array([[800.0, -250.0], [4000.0, -250.0]])


class Bench:
    """The helicopter flies along x, the UAV beside it, and towards it where ``vy`` says so."""

    def __init__(self, points, *, uav_y=-250.0, vy=0.0, **changes):
        self.parameters = MonitorParameters(**changes)
        self.outlook = Outlook(self.parameters, HelicopterModel(20.0, 2.5, 1))
        self.outlook.helicopter.phase = Phase.CRUISE
        self.guard = Guard(self.parameters, self.outlook)
        self.uav_y, self.vy = uav_y, vy
        self.tell(0.0)
        self.route = Route(points, self.outlook.uav)

    def tell(self, now_s):
        self.outlook.helicopter.set_motion(Motion(now_s, 20.0 * now_s, 0.0, 20.0, 0.0), 1.0, 0.1)
        y = self.uav_y + self.vy * now_s
        self.outlook.set_uav(Motion(now_s, 20.0 * now_s, y, 20.0, self.vy))

    def look(self, now_s, *, escaping=False):
        self.tell(now_s)
        return self.guard.look(self.route, now_s, escaping=escaping)


def test_beside_there_is_no_reason_and_nothing_is_near():
    bench = Bench(BESIDE)
    for second in range(20):
        look = bench.look(float(second))
        assert bench.guard.reason(look) == ""
        assert look.nearest.distance_m > 200.0


def test_what_comes_near_soon_is_a_reason_at_once():
    bench = Bench(AT, uav_y=-120.0, vy=5.0)
    assert "m in" in bench.guard.reason(bench.look(0.0))


def test_what_comes_near_later_is_one_once_it_has_lasted():
    bench = Bench(AT, uav_y=-330.0, possible_horizon_s=0.25)
    near, reasons = [], []
    for step in range(40):
        look = bench.look(0.5 * step)
        near.append(look.later.distance_m < 130.0)
        reasons.append(bool(bench.guard.reason(look)))
    lasted = [i >= 8 and all(near[i - 8 : i + 1]) for i in range(40)]  # escape_after_s
    assert any(near[:8])
    assert reasons.index(True) == lasted.index(True)


def test_a_helicopter_that_is_lost_for_long_is_a_reason():
    bench = Bench(np.array([[800.0, -600.0], [4000.0, -600.0]]), uav_y=-600.0)
    bench.look(0.0)
    bench.outlook.helicopter.phase = Phase.LOST
    reasons = {second: bench.guard.reason(bench.look(float(second))) for second in (5, 16)}
    assert "lost for 16 s" in reasons[16]
    assert reasons[5] == ""


@pytest.mark.parametrize("uav_y", [-130.0, 130.0])
def test_the_way_out_leads_away_from_the_helicopter(uav_y):
    bench = Bench(AT, uav_y=uav_y)
    escape = bench.guard.way_out(bench.look(0.0))
    (x, y) = escape.points[0]
    assert math.hypot(x, y - uav_y) == pytest.approx(1500.0, rel=0.1)
    assert y * uav_y > 0.0
    assert abs(y) > 500.0


def test_all_is_clear_after_a_while_and_not_while_it_is_near():
    bench = Bench(BESIDE)
    clear = [bench.guard.is_clear(bench.look(float(second))) for second in range(8)]
    assert clear == [False] * 5 + [True] * 3
    near = Bench(AT, uav_y=-120.0, vy=5.0)
    assert not any(near.guard.is_clear(near.look(0.5 * step)) for step in range(10))


def test_another_way_is_looked_for_now_and_then_and_taken_when_clearly_better():
    bench = Bench(AT, uav_y=-150.0)
    first = bench.guard.way_out(bench.look(0.0))
    bench.route = Route(first.points, bench.outlook.uav)
    assert bench.guard.better_way(bench.look(1.0, escaping=True)) is None
    toward = Bench(AT, uav_y=-150.0)
    toward.guard.way_out(toward.look(0.0))
    toward.route = Route(np.array([[300.0, 800.0]]), toward.outlook.uav)
    assert toward.guard.better_way(toward.look(2.0, escaping=True)) is not None


def make_late(bench, late_s, now_s=0.0):
    """Have a list taken so long to the autopilot."""
    bench.outlook.timing.give(1, now_s - late_s)
    bench.outlook.timing.flown(1, now_s)


@pytest.mark.parametrize("late_s", [3.0, 5.0])
def test_where_lists_come_late_the_uav_is_sent_away_so_much_sooner(late_s):
    """Straight towards the helicopter's track: in time is when 10 s are left, and what is late."""

    def first_s(late_s):
        bench = Bench(AT, uav_y=-400.0, vy=10.0, escape_after_s=1000.0)
        for step in range(60):
            make_late(bench, late_s, 0.5 * step)
            if bench.guard.reason(bench.look(0.5 * step)):
                return 0.5 * step
        raise AssertionError("no reason")

    soon = first_s(0.5)
    assert soon == first_s(1.0)
    assert first_s(late_s) == pytest.approx(soon - (late_s - 1.0), abs=1.0)


@pytest.mark.parametrize(
    ("late_s", "delay_s"), [(0.0, 1.0), (1.4, 1.0), (1.6, 1.5), (3.0, 3.0), (9.0, 5.0)]
)
def test_a_way_out_begins_where_the_uav_will_be_when_it_has_it(late_s, delay_s):
    bench = Bench(AT, uav_y=-200.0, vy=5.0)
    make_late(bench, late_s)
    assert bench.outlook.delay_s(0.0) == delay_s
    escape = bench.guard.way_out(bench.look(0.0))
    held = bench.outlook.path(bench.route, 0.0, delay_s, is_flown=True, escaping=False)
    reach = math.dist(escape.points[0], held[-1])
    assert reach == pytest.approx(bench.parameters.escape_reach_m, abs=0.1)
