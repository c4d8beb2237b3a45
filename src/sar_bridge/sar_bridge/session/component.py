"""The bridge as a component: lists and speeds in, MAVLink in and out, telemetry out."""

from __future__ import annotations

import math

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.session.list_transfer import Messages
from sar_bridge.session.liveness import Liveness
from sar_bridge.session.session import AutopilotSession
from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES, Answer, Component, Notice, Outputs
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.reports import Health, UavReport, UavStatus, Uploaded, WaypointList

LINK = "mavlink"
"""The topic of messages that go to the autopilot."""
WATCHED = ("planner", "monitor")


class BridgeComponent(Component):
    """Joins a session with an autopilot to the graph; times are of a monotonic clock [s].

    ``ros_s``: the graph's clock [s], to be set before every call. ``link_breaks``: how often the
    link has broken, likewise. ``session``: what is fed.
    """

    name = "bridge"
    outputs = (
        topics.UAV_ODOMETRY,
        topics.UAV_CLOCK,
        topics.UAV_STATE,
        topics.UPLOADED,
        topics.AUTOPILOT,
        topics.WIND,
        topics.DIAGNOSTICS,
    )
    period_s = 0.05

    def __init__(
        self,
        *,
        altitude_m: float,
        target_system: int = 0,
        node_timeout_s: float = 4.0,
        link_timeout_s: float = 3.0,
    ) -> None:
        """Fly lists at an altitude above home; see the node's parameters."""
        super().__init__()
        self.session = AutopilotSession(
            altitude_m=altitude_m, target_system=target_system, link_timeout_s=link_timeout_s
        )
        self.ros_s = 0.0
        self.link_breaks = 0
        self._liveness = Liveness(WATCHED, node_timeout_s)
        self._datum: Datum | None = None
        self._started_s = 0.0
        self._early_list: WaypointList | None = None
        self._sent_state: UavStatus | None = None
        self._sent_boot_s = 0.0
        self._sent_upload: object = None
        self._sent_autopilot: dict[str, float] = {}
        self.inputs = {
            topics.CLEARED: self._on_list,
            topics.SPEED: self._on_speed,
            topics.DATUM: self._on_datum,
            topics.DIAGNOSTICS: self._on_alive,
        }
        self.services = {topics.RETURN_HOME: self._return_home}

    # From the graph ----------------------------------------------------------------------------

    def _on_datum(self, datum: Datum, now_s: float) -> Outputs:
        self._datum = datum
        return [] if self._early_list is None else self._take_list(self._early_list, datum, now_s)

    def _on_list(self, waypoints: WaypointList, now_s: float) -> Outputs:
        if not (np.isfinite(waypoints.points).all() and math.isfinite(waypoints.climb_m)):
            text = "waypoint list with a position that is no number: refused"
            return [(NOTICES, Notice("error", text))]
        if self._datum is not None:
            return self._take_list(waypoints, self._datum, now_s)
        self._early_list = waypoints
        return []

    def _take_list(self, waypoints: WaypointList, datum: Datum, now_s: float) -> Outputs:
        """Upload a list; one from before this bridge's start never changes the mode."""
        self._early_list = None
        messages = self.session.set_list(
            waypoints.points,
            waypoints.list_id,
            datum,
            now_s,
            climb_m=waypoints.climb_m,
            may_engage=0.0 < self._started_s <= waypoints.time_s,
        )
        return _sent(messages)

    def _on_alive(self, names: tuple[str, ...], now_s: float) -> Outputs:
        for name in names:
            self._liveness.hear(name, now_s)
        return []

    def _on_speed(self, speed_mps: float, now_s: float) -> Outputs:
        return _sent(self.session.set_speed(speed_mps, now_s)) if math.isfinite(speed_mps) else []

    def _return_home(self, now_s: float) -> Answer:
        commands = self.session.return_home(now_s)
        success = bool(commands) and self.session.connected(now_s)
        message = "RTL commanded" if success else "no autopilot heard"
        return Answer(success, message, _sent(commands))

    # From and to the autopilot -----------------------------------------------------------------

    def receive(self, message: mavlink.MAVLink_message, now_s: float) -> Outputs:
        """Take a message from the autopilot; return what goes back, and what is published."""
        session = self.session
        messages, moved = session.handle(message, now_s=now_s, ros_s=self.ros_s, datum=self._datum)
        out = _sent(messages)
        if moved:
            telemetry = session.state.telemetry
            assert telemetry is not None
            report = UavReport(
                telemetry.motion,
                telemetry.yaw_rad,
                telemetry.up_m,
                telemetry.pitch_rad,
                telemetry.roll_rad,
                telemetry.climb_mps,
            )
            out.append((topics.UAV_ODOMETRY, report))
        if session.state.boot_s != self._sent_boot_s:
            self._sent_boot_s = session.state.boot_s
            out.append((topics.UAV_CLOCK, self._sent_boot_s))
        accepted = session.accepted
        if accepted is not self._sent_upload and accepted is not None:
            self._sent_upload = accepted
            upload_ms = round(1e3 * accepted.duration_s, 1)
            out.append((topics.UPLOADED, Uploaded(accepted.list_id, accepted.items, upload_ms)))
        return out

    def tick(self, now_s: float) -> Outputs:
        """Send what is due; tell the autopilot's status when it is another."""
        if self._started_s == 0.0:
            self._started_s = self.ros_s  # the first time a simulated clock is known
        self.session.silent = self._liveness.silent(now_s)
        out = _sent(self.session.tick(now_s))
        status = self.session.status(now_s)
        if status != self._sent_state:
            self._sent_state = status
            out.append((topics.UAV_STATE, status))
        return out

    # What is known -----------------------------------------------------------------------------

    def report(self, now_s: float) -> Outputs:  # noqa: ARG002
        """Tell the autopilot's parameters when they are others, and the wind."""
        session, out = self.session, Outputs()
        parameters = dict(session.parameters) if session.parameters_complete else {}
        if parameters and parameters != self._sent_autopilot:
            self._sent_autopilot = parameters
            out.append((topics.AUTOPILOT, parameters))
        if session.state.wind.vector_mps is not None:
            out.append((topics.WIND, session.state.wind.vector_mps))
        return out

    def health(self, now_s: float) -> Health:
        """Return how link and session are; a dead link is severe."""
        session, accepted = self.session, self.session.accepted
        values = {
            "mode": session.state.mode,
            "armed": session.state.armed,
            "current_item": session.state.current_item,
            "reboots": session.state.clock.reboots,
            "link_breaks": self.link_breaks,
            "upload_ms": "" if accepted is None else f"{1e3 * accepted.duration_s:.0f}",
        }
        dead = not session.connected(now_s)
        return Health(self.name, session.problem(now_s), values, severe=dead)


def _sent(messages: Messages) -> Outputs:
    return [(LINK, messages)] if messages else []
