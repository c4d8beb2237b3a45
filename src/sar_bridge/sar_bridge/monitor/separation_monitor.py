"""The independent separation monitor: a gate for waypoint lists, a guard that commands escapes.

Pure, and without any of the planner's code. From the motion of both aircraft it predicts where the
UAV will be that follows a list (``l1_predictor``), where the helicopter may be
(``helicopter_hypotheses``), and where the other UAVs will be (``other_futures``). *Gate*: a list
that breaks the least separation in prediction does not pass. *Guard*: when the list that is flown
leads close to another aircraft anyway, the UAV is sent away until it is clear. Positions are in the
map frame [m], times in seconds of one clock.
"""

from __future__ import annotations

from sar_bridge.arduplane.l1_predictor import FollowerTuning, Route, Vector
from sar_bridge.monitor.alerts import Alert, Alerts
from sar_bridge.monitor.escapes import Escape
from sar_bridge.monitor.gate import Gate, Offered
from sar_bridge.monitor.guard import Guard
from sar_bridge.monitor.helicopter_hypotheses import Helicopter
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.outlook import NO_APPROACH, Outlook
from sar_bridge.monitor.parameters import MonitorParameters
from sar_bridge.monitor.present import Present
from sar_estimator.common.other_uavs import OtherUavs
from sar_estimator.common.states import FloatArray, Motion


class SeparationMonitor:
    """Gate and guard. It is told what is known, and asked about lists, and what is to be done.

    ``nearest``: the closest approach of the list being flown, in prediction. ``reason``: why the
    newest list was refused, or the UAV was sent away. ``refused_id``: of the newest list where it
    did not pass, else 0. ``escape``: the way out being flown. ``thresholds``: the distances [m] of
    ``parameters``. ``outlook``: what is known and predicted of both aircraft. ``present``: what is
    wrong with them now.
    """

    def __init__(
        self,
        parameters: MonitorParameters,
        model: HelicopterModel,
        others: OtherUavs | None = None,
    ) -> None:
        """Know nothing yet."""
        self.parameters = parameters
        self.thresholds = parameters.thresholds()
        self.outlook = Outlook(parameters, model, others)
        self.nearest = NO_APPROACH
        self.reason = ""
        self.refused_id = 0
        self.escape: Escape | None = None
        self.present = Present(parameters, self.outlook)
        self._alerts = Alerts(parameters)
        self._gate = Gate(parameters, self.outlook)
        self._guard = Guard(parameters, self.outlook)
        self._flown: Route | None = None
        self._cleared: dict[int, Offered] = {}

    # What is known -----------------------------------------------------------------------------

    @property
    def helicopter(self) -> Helicopter:
        """The helicopter as last told of."""
        return self.outlook.helicopter

    @property
    def alert(self) -> Alert:
        """The state of the list being flown."""
        return self._alerts.alert

    @property
    def counts(self) -> dict[Alert | str, int]:
        """How often each alert began, and lists passed and were refused."""
        return self._alerts.counts

    @property
    def guarding(self) -> bool:
        """Whether a list is flown: a UAV that is not led is not sent away either."""
        return self._flown is not None

    @property
    def unseen(self) -> bool:
        """Whether one of the aircraft was never seen yet."""
        return self.outlook.unseen

    def set_uav(self, motion: Motion) -> None:
        """Take the UAV's newest motion."""
        if motion.is_finite():
            self.outlook.set_uav(motion)
            if self._flown is not None:
                self._flown.advance(motion)

    def set_wind(self, wind_mps: Vector) -> None:
        """Take where the wind blows to, x and y [m/s]."""
        self.outlook.set_wind(wind_mps)

    def set_tuning(self, tuning: FollowerTuning) -> None:
        """Take how the autopilot is tuned."""
        self.outlook.tuning = tuning

    def set_altitudes(self, uav_m: float, helicopter_m: float) -> None:
        """Take the altitudes of UAV and helicopter [m], NaN for unknown."""
        self.outlook.altitude_m = uav_m
        self.outlook.above_m = uav_m - helicopter_m

    def set_uploaded(self, list_id: int) -> None:
        """Take note that the autopilot flies a list."""
        cleared, uav = self._cleared.pop(list_id, None), self.outlook.uav
        if cleared is None or uav is None:
            return
        self._cleared = {one: held for one, held in self._cleared.items() if one > list_id}
        if self.escape is None:
            self._flown = cleared.route(uav)

    def set_flown(self, points: FloatArray) -> None:
        """Take note of the list, shape (n, 2) [m], that is flown, however it came to be."""
        if self.outlook.uav is not None:
            self._flown = Route(points, self.outlook.uav)

    def withdraw(self) -> None:
        """Take note that no list is flown any more: nothing is guarded."""
        self._flown = self.escape = None
        self._cleared.clear()
        self._alerts.alert, self.nearest, self.reason = Alert.NONE, NO_APPROACH, ""
        self.refused_id = 0

    # Gate and guard ----------------------------------------------------------------------------

    def passes(
        self, points: FloatArray, list_id: int, now_s: float, *, speed_mps: float | None = None
    ) -> bool:
        """Return whether a list, shape (n, 2) [m], may be uploaded; ``reason`` says why not.

        ``speed_mps``: the ground speed it is planned with, None where that is the helicopter's.
        """
        offered, escaping = Offered(points, speed_mps), self.escape is not None
        refusal = self._gate.refusal(offered, now_s, flown=self._flown, escaping=escaping)
        self.counts["refused" if refusal else "passed"] += 1
        if refusal:
            self.reason = refusal
            if not self.parameters.watch_only:
                self.refused_id = list_id
                return False
        elif not escaping:
            self.reason = ""
        self.refused_id = 0
        self._cleared[list_id] = offered
        return True

    def update(self, now_s: float) -> Escape | None:
        """Look at what is flown; return a new escape when the UAV is to be sent away."""
        uav = self.outlook.uav
        if self._flown is None or uav is None or self.unseen:
            self._alerts.set(Alert.NONE)
            return None
        if now_s - uav.time_s > self.parameters.stale_s:
            return None  # where it is is not known, and nothing would reach it
        look = self._guard.look(self._flown, now_s, escaping=self.escape is not None)
        self.nearest = look.nearest
        if self.escape is not None:
            if self._guard.is_clear(look):
                self.escape, self.reason = None, ""
                self._alerts.set(Alert.NONE)
                return None
            return self._take(self._guard.better_way(look))
        why = self._guard.reason(look)
        if why and not self.parameters.watch_only:
            self.reason = f"sent away: {why}"
            self._alerts.set(Alert.ESCAPE)
            return self._take(self._guard.way_out(look))
        self._alerts.watch(look.nearest.distance_m, now_s)
        return None

    def _take(self, escape: Escape | None) -> Escape | None:
        """Fly a way out, if there is a new one."""
        if escape is not None:
            assert self.outlook.uav is not None
            self.escape = escape
            self._cleared.clear()
            self._flown = Route(escape.points, self.outlook.uav)
        return escape
