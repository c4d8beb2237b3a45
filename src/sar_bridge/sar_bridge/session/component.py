"""The bridge as a component: lists and speeds in, MAVLink in and out, telemetry out."""

from __future__ import annotations

import math

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address
from sar_bridge.mavlink.link import GROUND_COMPONENT, GROUND_SYSTEM
from sar_bridge.mavlink.transponder import Transponder
from sar_bridge.mavlink.vehicle_health import VehicleHealth
from sar_bridge.session.ground_stations import Bridge, GroundStations, Traffic
from sar_bridge.session.list_transfer import Messages
from sar_bridge.session.liveness import Liveness
from sar_bridge.session.session import AutopilotSession
from sar_estimator.common import topics
from sar_estimator.common.component import NOTICES, Answer, Component, Notice, Outputs
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.lateness import Lateness
from sar_estimator.common.reports import Health, UavReport, UavStatus, Uploaded, WaypointList

LINK = "mavlink"
"""The topic of messages that go to the autopilot."""
STATIONS = "stations"
"""The topic of what goes to ground stations: number of the station, packet or message."""
OWN = Address(GROUND_SYSTEM, GROUND_COMPONENT)
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
        topics.ADSB,
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
        own: Address = OWN,
        stations: int = 0,
        helicopter_icao: str = "",
    ) -> None:
        """Fly lists at an altitude above home; see the node's parameters.

        ``own``: its address; ``stations``: how many ground stations there may be. Raises
        ``ValueError`` for an ICAO address that is none.
        """
        super().__init__()
        self.session = AutopilotSession(
            altitude_m=altitude_m, target_system=target_system, link_timeout_s=link_timeout_s
        )
        self.stations = GroundStations(own, stations)
        self.vehicle = VehicleHealth()
        self._transponder = Transponder(helicopter_icao)
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
        self._lateness = Lateness()
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
        if 0.0 < self._started_s <= waypoints.time_s:  # one from before is latched, not late
            self._lateness.add(self.ros_s - waypoints.time_s, self.ros_s)
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
        return self._own(messages)

    def _on_alive(self, nodes: tuple[Health, ...], now_s: float) -> Outputs:
        for node in nodes:
            self._liveness.hear(node.name, now_s)
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
        passed = self.stations.pass_on(message, now_s, busy=session.transfer.active)
        out: Outputs = [(STATIONS, one) for one in passed]
        if not self.stations.is_ours(message):
            return out
        out += self._hear_vehicle(message)
        messages, moved = session.handle(message, now_s=now_s, ros_s=self.ros_s, datum=self._datum)
        out += self._own(messages)
        if moved:
            telemetry = session.state.telemetry
            assert telemetry is not None
            report = UavReport(
                telemetry.motion,
                telemetry.yaw_rad,
                telemetry.altitude_m,
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

    def _hear_vehicle(self, message: mavlink.MAVLink_message) -> Outputs:
        """Take what is told of the UAV, by its autopilot, and of the radio, by that.

        Return the helicopter's position where the UAV's ADS-B receiver hears it.
        """
        address = self.session.address
        of_uav = address is not None and message.get_srcSystem() == address.system
        if of_uav or message.get_type() == "RADIO_STATUS":
            self.vehicle.handle(message)
        seen = self._transponder.heard(message, self.ros_s, self._datum) if of_uav else None
        return [] if seen is None else [(topics.ADSB, seen)]

    def receive_station(
        self, station: int, message: mavlink.MAVLink_message, now_s: float
    ) -> Outputs:
        """Take a message from a ground station; return what it leads to."""
        bridge = self._bridge()
        if bridge is None:
            return []
        return self._spread(self.stations.take(station, message, now_s, bridge), now_s)

    def _bridge(self) -> Bridge | None:
        """Return what the ground stations have to respect; None before an autopilot was heard."""
        session = self.session
        if session.address is None:
            return None
        return Bridge(
            session.address,
            flown=session.leading,
            busy=session.transfer.active,
            silent=bool(session.heartbeats.withheld(leading=session.leading)),
        )

    def _spread(self, traffic: Traffic, now_s: float) -> Outputs:
        """Return where traffic goes, after the session was told of what it does."""
        if traffic.mission_changed:
            self.session.transfer.forget_mission()
        if traffic.item_chosen:
            self.session.take_away("a waypoint was chosen by a ground station")
        if traffic.rates_changed:
            self.session.streams.again()
        out: Outputs = [(STATIONS, one) for one in traffic.to_stations]
        if traffic.to_autopilot:
            out.append((LINK, traffic.to_autopilot))
        return out + self._own(self.session.transfer.hold(self.stations.writing, now_s))

    def _own(self, messages: Messages) -> Outputs:
        """Return messages of the bridge's own; a list among them goes before what stations read."""
        out, bridge = _sent(messages), self._bridge()
        if bridge is not None and bridge.busy:
            out += [(STATIONS, one) for one in self.stations.make_way(bridge).to_stations]
        return out

    def tick(self, now_s: float) -> Outputs:
        """Send what is due; tell the autopilot's status when it is another."""
        if self._started_s == 0.0:
            self._started_s = self.ros_s  # the first time a simulated clock is known
        self.session.heartbeats.silent = self._liveness.silent(now_s)
        out = self._own(self.session.tick(now_s))
        for traffic in self.stations.tick(now_s, self._bridge()):
            out += self._spread(traffic, now_s)
        out += self._own(self.session.transfer.hold(self.stations.writing, now_s))
        status = self.session.status(now_s)
        if status != self._sent_state:
            self._sent_state = status
            out.append((topics.UAV_STATE, status))
        news = self.session.heartbeats.news(leading=self.session.leading)
        return out if news is None else [*out, (NOTICES, news)]

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
            "stations": self.stations.heard(now_s),
            "heartbeat_age_s": _figure(now_s - session.state.heartbeat_s),
            "airspeed_mps": _figure(session.state.wind.airspeed_mps),
            **self.vehicle.values,
            "uav_text": self.vehicle.text,
            "list_late_s": f"{self._lateness.value_s(self.ros_s):.1f}",
            "upload_ms": "" if accepted is None else f"{1e3 * accepted.duration_s:.0f}",
        }
        dead, problem = not session.connected(now_s), session.problem(now_s)
        if not problem and self.stations.same_address:
            own = self.stations.own
            problem = f"a ground station has this node's address {own.system}.{own.component}"
        return Health(self.name, problem, values, severe=dead)


def _figure(value: float) -> str:
    return f"{value:.1f}" if 0.0 < value < math.inf else ""


def _sent(messages: Messages) -> Outputs:
    return [(LINK, messages)] if messages else []
