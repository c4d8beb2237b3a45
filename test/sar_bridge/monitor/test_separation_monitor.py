"""The monitor: gate and guard."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.monitor.alerts import Alert
from sar_bridge.monitor.gate import Offered
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.parameters import MonitorParameters
from sar_bridge.monitor.separation_monitor import SeparationMonitor
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import LegEstimate, Motion, Phase

SLOT = np.array([[800.0, -250.0], [4000.0, -250.0], [4300.0, -280.0]])
CROSSING = np.array([[500.0, 0.0], [500.0, 3000.0]])
NEAR = np.array([[300.0, -160.0], [4000.0, -160.0]])
NEARER = np.array([[300.0, -140.0], [4000.0, -140.0]])


class Bench:
    """A monitor, a helicopter that flies east from the origin, and a UAV."""

    def __init__(self, uav=(0.0, -250.0), **changes):
        self.monitor = SeparationMonitor(MonitorParameters(**changes), HelicopterModel())
        self.now_s = 0.0
        self.leader = Motion(0.0, 0.0, 0.0, 20.0, 0.0)
        self.uav = Motion(0.0, *uav, 20.0, 0.0)
        self.monitor.helicopter.phase = Phase.CRUISE
        self.tell()

    def tell(self, *, helicopter=True, uav=True):
        if helicopter:
            self.monitor.helicopter.set_motion(self.leader, 2.0, 0.5)
            foot = Pose(self.leader.x_m, self.leader.y_m, 0.0)
            if self.leader.speed_mps > 1.0:
                leg = LegEstimate(self.now_s, foot, self.leader.speed_mps, 1.0, 0.002, 0.1)
                self.monitor.helicopter.set_leg(leg)
        if uav:
            self.monitor.set_uav(self.uav)

    def fly(self, seconds, *, helicopter=True, uav=True, step_s=0.5):
        """Fly both straight on; return the escapes."""
        escapes = []
        for _ in range(round(seconds / step_s)):
            self.now_s += step_s
            self.leader = moved(self.leader, step_s)
            self.uav = moved(self.uav, step_s)
            self.tell(helicopter=helicopter, uav=uav)
            escape = self.monitor.update(self.now_s)
            if escape is not None:
                escapes.append(escape)
        return escapes

    def offer(self, points):
        """Offer a list; when it passes the autopilot flies it."""
        stamp = self.now_s + 0.125
        passed = self.monitor.passes(points, stamp, self.now_s)
        if passed:
            self.monitor.set_uploaded(stamp)
        return passed


def moved(motion, step_s):
    return motion._replace(
        time_s=motion.time_s + step_s,
        x_m=motion.x_m + motion.vx_mps * step_s,
        y_m=motion.y_m + motion.vy_mps * step_s,
    )


# Gate --------------------------------------------------------------------------------------------


def test_a_list_beside_the_helicopter_passes():
    bench = Bench()
    assert bench.offer(SLOT)
    assert bench.monitor.reason == ""
    assert bench.monitor.counts["passed"] == 1


def test_a_list_across_the_helicopters_way_is_refused_and_says_why():
    bench = Bench()
    assert not bench.offer(CROSSING)
    assert bench.monitor.reason.startswith("list refused: ")
    assert " m in " in bench.monitor.reason
    assert "if the helicopter " in bench.monitor.reason
    assert bench.monitor.counts["refused"] == 1


def test_what_a_stop_would_lead_to_is_refused():
    """Fast behind the helicopter to its other side: apart only while it flies on."""
    bench = Bench(uav=(-400.0, -250.0))
    behind = np.array([[-100.0, -20.0], [300.0, 20.0], [400.0, 2000.0]])
    assert not bench.offer(behind)


def test_the_doubt_is_in_the_lists_favour():
    close = np.array([[1500.0, -197.0], [4000.0, -197.0]])
    for sigmas, passes in ((1.0, True), (0.0, False)):
        bench = Bench(uav=(0.0, -197.0), gate_sigmas=sigmas)
        bench.monitor.set_flown(close)
        assert bench.offer(close) is passes


def test_a_list_is_predicted_at_the_speed_it_is_planned_with_within_reason():
    """Ahead of the helicopter across its way: only one that is fast is gone in time."""
    across = np.array([[500.0, -250.0], [530.0, -220.0], [530.0, 2500.0]])
    verdicts = []
    for speed in (None, 16.5, 23.5, 60.0):
        bench = Bench(uav=(250.0, -250.0), gate_sigmas=0.0)
        path = bench.monitor.outlook.path(
            Offered(across, speed).route(bench.uav),
            bench.now_s,
            30.0,
            is_flown=False,
            escaping=False,
        )
        verdicts.append(float(path[-1, 1]))
    unknown, slow, fast, absurd = verdicts
    assert slow < unknown - 60.0 < unknown + 60.0 < fast
    assert absurd == unknown


def test_a_list_that_is_better_than_what_is_flown_passes():
    bench = Bench(uav=(0.0, -150.0))
    bench.monitor.set_flown(NEARER)
    assert bench.offer(NEAR)
    bench.monitor.set_flown(NEAR)
    assert not bench.offer(NEARER)


@pytest.mark.parametrize(
    ("points", "reason"),
    [
        (np.empty((0, 2)), "without waypoints"),
        (np.array([[math.nan, 0.0]]), "not within 100000 m"),
        (np.array([[1e7, 0.0]]), "not within 100000 m"),
    ],
)
def test_what_is_no_list_is_refused(points, reason):
    bench = Bench()
    assert not bench.offer(points)
    assert reason in bench.monitor.reason


@pytest.mark.parametrize("name", ["helicopter", "UAV"])
def test_nothing_passes_while_a_position_is_old(name):
    bench = Bench()
    bench.fly(3.0, helicopter=name != "helicopter", uav=name != "UAV")
    assert bench.offer(SLOT)
    bench.fly(0.5, helicopter=name != "helicopter", uav=name != "UAV")
    assert not bench.offer(SLOT)
    assert f"{name} position 3.5 s old (limit 3 s)" in bench.monitor.reason


def test_nothing_passes_without_the_helicopters_gps_or_any_position():
    bench = Bench()
    bench.monitor.helicopter.phase = Phase.LOST
    assert not bench.offer(SLOT)
    assert bench.monitor.reason == "list refused: helicopter GPS lost"
    nobody = SeparationMonitor(MonitorParameters(), HelicopterModel())
    assert not nobody.passes(SLOT, 0.0, 0.0)
    assert nobody.reason == "list refused: no helicopter position"
    assert nobody.update(0.0) is None


def test_a_list_counts_as_flown_when_the_autopilot_has_it():
    bench = Bench()
    bench.monitor.set_flown(SLOT)
    assert bench.monitor.passes(SLOT - np.array((0.0, 100.0)), 7.0, 0.0)
    bench.monitor.set_uploaded(6.0)
    assert bench.monitor._flown.points is SLOT
    bench.monitor.set_uploaded(7.0)
    assert bench.monitor._flown.points[0, 1] == -350.0


def crossing(**changes):
    """Return a bench with a UAV that meets the helicopter in 30 s."""
    bench = Bench(uav=(600.0, -600.0), **changes)
    bench.uav = bench.uav._replace(vx_mps=0.0, vy_mps=20.0)
    bench.tell()
    bench.monitor.set_flown(np.array([[600.0, 3000.0]]))
    return bench


def until_sent_away(bench):
    """Fly until there is an escape; return it."""
    for _ in range(60):
        escapes = bench.fly(0.5)
        if escapes:
            return escapes[0]
    raise AssertionError("never sent away")


# Guard -------------------------------------------------------------------------------------------


def test_formation_is_left_alone():
    bench = Bench()
    assert bench.offer(SLOT)
    assert bench.fly(60.0) == []
    assert bench.monitor.alert is Alert.NONE
    assert bench.monitor.nearest.distance_m == pytest.approx(250.0, abs=1.0)


def test_a_uav_that_is_led_into_the_helicopter_is_sent_away():
    bench = crossing()
    escape = until_sent_away(bench)
    assert bench.now_s == pytest.approx(10.0, abs=1.0)  # 20 s before, and 4 s to lead it elsewhere
    assert bench.monitor.reason.startswith("sent away: ")
    assert escape.predicted_m > 200.0
    way = escape.points[0] - (600.0, -400.0)
    assert np.hypot(*way) > 1000.0
    assert way[1] < 0.5 * np.hypot(*way)  # not on across the helicopter's way


def test_an_escape_is_predicted_to_begin_when_the_uav_will_have_been_told():
    least = []
    for delay_s in (0.0, 1.0, 3.0):
        bench = crossing(escape_delay_s=delay_s)
        escape = until_sent_away(bench)
        begins = np.array((bench.uav.x_m, bench.uav.y_m))
        begins = begins + delay_s * np.array((bench.uav.vx_mps, bench.uav.vy_mps))
        assert np.hypot(*(escape.points[0] - begins)) == pytest.approx(1500.0, abs=1.0)
        least.append(escape.predicted_m)
    assert least[0] > least[1] + 5.0 > least[2] + 10.0


def test_nothing_else_passes_while_the_uav_is_sent_away_and_then_it_does():
    bench = crossing()
    until_sent_away(bench)
    assert bench.monitor.alert is Alert.ESCAPE
    assert not bench.offer(SLOT)
    assert bench.monitor.reason == "list refused: the UAV is being sent away"
    course = bench.monitor.escape.points[0] - (bench.uav.x_m, bench.uav.y_m)
    vx, vy = 20.0 * course / np.hypot(*course)
    bench.uav = bench.uav._replace(vx_mps=vx, vy_mps=vy)
    bench.fly(4.5)
    assert bench.monitor.alert is Alert.ESCAPE
    bench.fly(20.0)
    assert bench.monitor.alert is Alert.NONE
    assert bench.monitor.reason == ""
    assert bench.offer(bench.monitor._flown.points + np.array((10.0, 0.0)))


def test_an_escape_climbs_where_that_separates_more_and_not_into_the_helicopter():
    for above_m, climbs in ((0.0, True), (30.0, True), (-40.0, False)):
        bench = Bench(uav=(100.0, -150.0))
        bench.uav = bench.uav._replace(vx_mps=0.0, vy_mps=20.0)
        bench.monitor.set_altitudes(100.0 + above_m, 100.0)
        bench.tell()
        bench.monitor.set_flown(np.array([[100.0, 3000.0]]))
        (escape, *_) = bench.fly(1.0)
        assert (escape.climb_m > 0.0) is climbs


def test_another_way_out_is_taken_when_it_becomes_better_and_only_then():
    """Sent straight on before a helicopter that stops: it flies on instead, and overtakes."""
    bench = Bench(uav=(150.0, -60.0))
    bench.uav = bench.uav._replace(vx_mps=12.0)
    bench.tell()
    bench.monitor.set_flown(np.array([[3000.0, -60.0]]))
    (escape,) = bench.fly(0.5)
    held = np.array([[3000.0, bench.uav.y_m]])
    bench.monitor.escape = replace(escape, points=held)
    bench.monitor.set_flown(held)
    (other,) = bench.fly(2.5)
    assert other.points[0, 1] < -500.0
    course = other.points[0] - (bench.uav.x_m, bench.uav.y_m)
    vx, vy = 12.0 * course / np.hypot(*course)
    bench.uav = bench.uav._replace(vx_mps=vx, vy_mps=vy)
    assert bench.fly(10.0) == []


def test_a_uav_that_is_not_led_to_the_helicopters_speed_is_not_taken_to_reach_it():
    """Slower than the helicopter behind it, for long: it will be overtaken."""
    bench = Bench(uav=(300.0, -100.0))
    bench.uav = bench.uav._replace(vx_mps=12.0)
    bench.tell()
    bench.monitor.set_flown(np.array([[9000.0, -100.0]]))
    bench.monitor.update(0.0)
    believed_m = bench.monitor.nearest.distance_m
    assert believed_m > 200.0  # it has only begun to be led
    bench.fly(12.0)
    assert bench.monitor.nearest.distance_m < 110.0


def test_a_wind_that_is_no_number_is_not_taken():
    bench = Bench()
    bench.monitor.set_wind((3.0, -2.0))
    bench.monitor.set_wind((math.nan, 0.0))
    assert bench.monitor.outlook.wind_mps == (3.0, -2.0)


def test_a_conflict_that_the_planner_ends_in_time_is_no_reason_to_send_it_away():
    bench = crossing()
    assert bench.fly(9.0) == []  # in conflict for 3 s
    assert bench.monitor.nearest.distance_m < 100.0
    here = bench.uav.y_m
    bench.monitor.set_flown(np.array([[600.0, here], [6000.0, here]]))
    bench.uav = bench.uav._replace(vx_mps=20.0, vy_mps=0.0)
    assert bench.fly(20.0) == []


def test_the_uav_is_sent_away_when_the_helicopter_is_lost_for_long():
    bench = Bench()
    bench.offer(SLOT)
    bench.fly(5.0)
    bench.monitor.helicopter.phase = Phase.LOST  # its odometry is still told: extrapolated
    assert bench.fly(14.5) == []
    (escape,) = bench.fly(1.0)
    assert "helicopter's position lost for 16 s" in bench.monitor.reason
    assert np.hypot(*(escape.points[0] - (bench.leader.x_m, bench.leader.y_m))) > 1000.0
    silent = Bench()
    silent.offer(SLOT)
    assert silent.fly(14.5, helicopter=False) == []
    assert len(silent.fly(2.0, helicopter=False)) == 1


def test_a_uav_that_is_not_heard_is_sent_nowhere_until_it_is():
    bench = crossing()
    bench.fly(5.0)
    assert bench.fly(12.0, uav=False) == []
    bench.tell()
    assert len(bench.fly(1.0)) == 1


def test_a_withdrawn_list_is_not_guarded():
    bench = Bench(uav=(100.0, -300.0))
    bench.uav = bench.uav._replace(vx_mps=0.0, vy_mps=20.0)
    bench.tell()
    bench.monitor.set_flown(np.array([[100.0, 3000.0]]))
    bench.monitor.withdraw()
    assert bench.fly(10.0) == []
    assert bench.monitor.alert is Alert.NONE


def test_alerts_are_told_when_they_last():
    for aside, alert in ((-190.0, Alert.NONE), (-160.0, Alert.CAUTION), (-140.0, Alert.WARNING)):
        bench = Bench(uav=(0.0, aside))
        bench.monitor.set_flown(np.array([[4000.0, aside]]))
        bench.fly(1.5)
        assert bench.monitor.alert is Alert.NONE
        bench.fly(1.5)
        assert bench.monitor.alert is alert
        bench.uav = bench.uav._replace(y_m=-250.0)
        bench.tell()
        bench.monitor.set_flown(SLOT)
        bench.fly(0.5)
        assert bench.monitor.alert is Alert.NONE


def test_who_only_watches_says_it_and_does_nothing():
    bench = crossing()
    bench.monitor = SeparationMonitor(MonitorParameters(watch_only=True), HelicopterModel())
    bench.monitor.helicopter.phase = Phase.CRUISE
    bench.tell()
    assert bench.offer(np.array([[600.0, 3000.0]]))
    assert bench.monitor.reason.startswith("list refused: ")
    assert bench.monitor.counts["refused"] == 1
    assert bench.fly(15.0) == []
    assert bench.monitor.alert is Alert.WARNING


CONDITIONS = {Alert.NONE: -250.0, Alert.CAUTION: -160.0, Alert.WARNING: -140.0}


def bench_in(alert):
    """Return a bench whose monitor is in an alert."""
    if alert is Alert.ESCAPE:
        bench = Bench(uav=(100.0, -300.0))
        bench.uav = bench.uav._replace(vx_mps=0.0, vy_mps=20.0)
        bench.tell()
        bench.monitor.set_flown(np.array([[100.0, 3000.0]]))
        bench.fly(1.0)
    else:
        bench = Bench(uav=(0.0, CONDITIONS[alert]))
        bench.monitor.set_flown(np.array([[9000.0, CONDITIONS[alert]]]))
        bench.fly(4.0)
    assert bench.monitor.alert is alert
    return bench


def settle(bench, aside):
    bench.uav = Motion(bench.now_s, bench.leader.x_m, aside, 20.0, 0.0)
    bench.tell()
    bench.monitor.set_flown(np.array([[bench.leader.x_m + 9000.0, aside]]))
    bench.fly(8.0)


def conflict(bench):
    bench.uav = Motion(bench.now_s, bench.leader.x_m + 100.0, -250.0, 0.0, 20.0)
    bench.tell()
    bench.monitor.set_flown(np.array([[bench.leader.x_m + 100.0, 3000.0]]))
    bench.fly(1.0)


def lose(bench):
    bench.monitor.helicopter.phase = Phase.LOST
    bench.fly(17.0)


def withdraw(bench):
    bench.monitor.withdraw()
    bench.fly(1.0)


EVENTS = {
    "clear": lambda bench: settle(bench, -250.0),
    "caution": lambda bench: settle(bench, -160.0),
    "warning": lambda bench: settle(bench, -140.0),
    "conflict": conflict,
    "withdrawn": withdraw,
    "lost": lose,
}


@pytest.mark.parametrize("alert", list(Alert))
@pytest.mark.parametrize("event", list(EVENTS))
def test_every_alert_and_event(alert, event):
    """An escape ends when all is well or there is no list; else alerts follow the prediction."""
    bench = bench_in(alert)
    EVENTS[event](bench)
    escaping = alert is Alert.ESCAPE
    expected = {
        "clear": Alert.NONE,
        "caution": Alert.ESCAPE if escaping else Alert.CAUTION,
        "warning": Alert.ESCAPE if escaping else Alert.WARNING,
        "conflict": Alert.ESCAPE,
        "withdrawn": Alert.NONE,
        "lost": Alert.ESCAPE,
    }[event]
    assert bench.monitor.alert is expected


# Parameters and messages -------------------------------------------------------------------------


def test_thresholds_are_shares_of_the_least_separation():
    assert MonitorParameters(min_separation_m=100.0).thresholds() == {
        "min_separation_m": 100.0,
        "caution_separation_m": 85.0,
        "warning_separation_m": 75.0,
        "escape_separation_m": 65.0,
    }


@given(
    st.lists(
        st.tuples(st.floats(-4000.0, 4000.0), st.floats(-4000.0, 4000.0)), min_size=1, max_size=8
    ),
    st.sampled_from(list(Phase)),
)
def test_whatever_passes_keeps_what_was_asked_for_or_is_better(points, phase):
    """For any list: what the gate let pass is not nearer, in its own prediction, than asked."""
    bench = Bench()
    bench.monitor.helicopter.phase = phase
    bench.monitor.set_flown(SLOT)
    if bench.offer(np.array(points)):
        bench.fly(0.5)
        assert phase is not Phase.LOST
        assert bench.monitor.alert is not Alert.ESCAPE
