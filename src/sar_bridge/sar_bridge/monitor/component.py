"""The monitor as a component: it stands between planner and bridge."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from sar_bridge.arduplane.l1_predictor import FollowerTuning
from sar_bridge.monitor.alerts import Alert
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.parameters import MonitorParameters
from sar_bridge.monitor.separation_monitor import SeparationMonitor
from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES, Component, Notice, Outputs, keep
from sar_estimator.common.other_uavs import OtherUavs
from sar_estimator.common.reports import (
    Health,
    HelicopterReport,
    MonitorReport,
    UavReport,
    UavStatus,
    Uploaded,
    WaypointList,
)
from sar_estimator.common.states import CornerEstimate, FloatArray, list_id_at

LED_MODES = ("AUTO", "GUIDED")
RATES_HZ = (1.0, 50.0)


class MonitorComponent(Component):
    """Hands lists on that may pass, and sends the UAV away.

    ``monitor``: what decides.
    """

    name = "monitor"
    outputs = (topics.CLEARED, topics.MONITOR, topics.DIAGNOSTICS)

    def __init__(
        self,
        parameters: MonitorParameters,
        model: HelicopterModel,
        *,
        rate_hz: float = 2.0,
        others: Sequence[str] = (),
    ) -> None:
        """Know nothing. ``rate_hz``: of the guard. ``others``: the other UAVs' names.

        Raises ``ValueError`` for what cannot be.
        """
        super().__init__()
        if not RATES_HZ[0] <= rate_hz <= RATES_HZ[1]:
            raise ValueError(f"parameter guard_rate_hz = {rate_hz}: expected 1 to 50")
        self.period_s = 1.0 / rate_hz
        told = OtherUavs(others)
        self.monitor = SeparationMonitor(parameters, model, told)
        self._covariance: FloatArray | None = None
        self._uav_m = self._helicopter_m = math.nan
        self._led = self._armed = False
        self._too_near = ""
        self._early: WaypointList | None = None
        self._told: tuple[object, ...] = ()
        self.inputs = {
            topics.WAYPOINTS: self._on_list,
            topics.HELICOPTER_ODOMETRY: self._on_helicopter,
            topics.FIX_TIME: keep(self.monitor.outlook.timing.hear_fix),
            topics.LEG: keep(self.monitor.helicopter.set_leg),
            topics.CORNER: self._on_covariance,
            topics.PREDICTION: self._on_corner,
            topics.PHASE: keep(self.monitor.helicopter.set_phase),
            topics.UAV_ODOMETRY: self._on_uav,
            topics.WIND: keep(self.monitor.set_wind),
            topics.UAV_STATE: self._on_status,
            topics.UPLOADED: self._on_uploaded,
            topics.AUTOPILOT: self._on_autopilot,
            topics.ADSB: keep(self.monitor.present.hear),
            **told.inputs,
        }

    @property
    def is_leading(self) -> bool:
        """Whether the UAV flies in a mode in which it is led."""
        return self._led

    # What is known -----------------------------------------------------------------------------

    def start(self, now_s: float) -> Outputs:  # noqa: ARG002
        """Tell that nothing is wrong yet."""
        return self._state_outputs()

    def _on_helicopter(self, report: HelicopterReport, _now_s: float) -> Outputs:
        self._helicopter_m = report.altitude_m
        self.monitor.set_altitudes(self._uav_m, self._helicopter_m)
        self.monitor.helicopter.set_motion(
            report.motion, report.position_sigma_m, report.velocity_sigma_mps
        )
        return []

    def _on_covariance(self, covariance: FloatArray, _now_s: float) -> Outputs:
        self._covariance = covariance
        return []

    def _on_corner(self, corner: CornerEstimate, _now_s: float) -> Outputs:
        if self._covariance is not None:
            corner = replace(corner, covariance=self._covariance)
        self.monitor.helicopter.corner = corner
        return []

    def _on_uav(self, report: UavReport, _now_s: float) -> Outputs:
        self._uav_m = report.altitude_m
        self.monitor.set_altitudes(self._uav_m, self._helicopter_m)
        self.monitor.set_uav(report.motion)
        return []

    def _on_status(self, status: UavStatus, _now_s: float) -> Outputs:
        self._led, self._armed = status.mode in LED_MODES, status.armed
        return []

    def _on_uploaded(self, uploaded: Uploaded, now_s: float) -> Outputs:
        self.monitor.outlook.timing.flown(uploaded.list_id, now_s)
        self.monitor.set_uploaded(uploaded.list_id)
        return []

    def _on_autopilot(self, values: dict[str, float], _now_s: float) -> Outputs:
        self.monitor.set_tuning(FollowerTuning.read(values))
        return []

    # Gate and guard ----------------------------------------------------------------------------

    def _on_list(self, waypoints: WaypointList, now_s: float) -> Outputs:
        """Hand a list on when it may pass; a withdrawal always does."""
        monitor, self._early = self.monitor, None
        timing = monitor.outlook.timing
        timing.use(now_s)
        if len(waypoints.points) == 0:
            monitor.withdraw()
            return [(topics.CLEARED, waypoints), *self._state_outputs()]
        found: Outputs = []
        if monitor.unseen:
            self._early = waypoints
        elif monitor.passes(
            waypoints.points, waypoints.list_id, now_s, speed_mps=waypoints.speed_mps
        ):
            found.append((topics.CLEARED, waypoints))
            timing.give(waypoints.list_id, now_s)
        else:
            found.append((NOTICES, Notice("warning", monitor.reason)))
        return found + self._state_outputs()

    def tick(self, now_s: float) -> Outputs:
        """Look at what is flown."""
        found: Outputs = []
        timing = self.monitor.outlook.timing
        timing.use(now_s)
        if self._early is not None and not self.monitor.unseen:
            found += self._on_list(self._early, now_s)
        present = self.monitor.present
        present.forget_old(now_s)
        self._too_near = present.too_near(now_s) if self._armed else ""
        if not self._led:
            return found + self._state_outputs()
        escape = self.monitor.update(now_s)
        if escape is not None:
            away = WaypointList(
                list_id_at(escape.time_s), escape.time_s, escape.points, climb_m=escape.climb_m
            )
            found.append((topics.CLEARED, away))
            timing.give(away.list_id, now_s)
            found.append((NOTICES, Notice("error", self.monitor.reason)))
        return found + self._state_outputs()

    def _state_outputs(self) -> Outputs:
        """Return the state when it has changed."""
        monitor = self.monitor
        wrong = self._too_near, monitor.present.adsb
        state = monitor.alert, monitor.reason, monitor.refused_id, *monitor.counts.values(), *wrong
        if state == self._told:
            return []
        self._told = state
        report = MonitorReport(
            str(monitor.alert),
            monitor.reason,
            monitor.refused_id,
            watch_only=monitor.parameters.watch_only,
            thresholds=dict(monitor.thresholds),
            counts={str(name): count for name, count in monitor.counts.items()},
            too_near=self._too_near,
            adsb=monitor.present.adsb,
        )
        return [(topics.MONITOR, report)]

    def set_clock_back(self) -> None:
        """Forget what has not come yet."""
        self.monitor.outlook.timing.set_clock_back()

    def health(self, now_s: float) -> Health:
        """Return the alert, how near a conflict is, and how late the monitor is."""
        monitor, timing = self.monitor, self.monitor.outlook.timing
        alert = "" if monitor.alert is Alert.NONE else f"{monitor.alert}: {monitor.nearest}"
        nearest_m = monitor.nearest.distance_m
        values: dict[str, Any] = {
            "alert": monitor.alert,
            "nearest_m": f"{nearest_m:.0f}" if math.isfinite(nearest_m) else "",
            **{str(name): count for name, count in monitor.counts.items()},
            **monitor.thresholds,
            **timing.values(now_s),
            "delay_s": f"{monitor.outlook.delay_s(now_s):.1f}",
        }
        severe = monitor.escape is not None
        problem = monitor.reason or alert or self._too_near or monitor.present.adsb
        problem = problem or timing.problem(now_s, monitor.parameters.late_fix_s)
        return Health(self.name, problem, values, severe=severe)
