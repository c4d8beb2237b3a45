"""The simulated autopilot: flight modes and a mission, over a guidance and a kinematic UAV.

It keeps ArduPlane's conventions: item 0 is home; a mission's end means RTL; a mission taken in AUTO
is not flown before the leg being flown ends or an item is made current; a leg that is begun by
DO_SET_MISSION_CURRENT runs from the old target, or from here where that one's finish line lies
behind, and on the leg after it only the target is headed for (Plane::set_next_WP).
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, replace

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.mission_items import MissionItem
from sar_estimator.common.constants import G_MPS2
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.pose import Pose
from sar_estimator.common.states import Motion
from sar_sim.autopilot.guidance import Guidance, Leg, Point
from sar_sim.autopilot.presets import make_guidance
from sar_sim.autopilot.uav import UavState, ground_motion, step
from sar_sim.scenario.scenario import Uav, Wind

PLAIN, CALM = Uav(), Wind()
OSCILLATION_LOSS = 0.4
TURN_RADIUS_M = 300.0
FAR_M = 50_000.0
WIND_ESTIMATE_S = 15.0


class FlightMode(enum.IntEnum):
    """ArduPlane's numbers of the modes that are simulated."""

    AUTO = 10
    RTL = 11
    LOITER = 12
    GUIDED = 15


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle to fly: clockwise for a radius above 0 [m]."""

    centre: Point
    radius_m: float


class SimAutopilot:
    """One airborne UAV and its autopilot; advance it with ``step``."""

    def __init__(
        self,
        start: Pose,
        *,
        speed_mps: float,
        datum: Datum,
        uav: Uav = PLAIN,
        wind: Wind = CALM,
        altitude_m: float = 150.0,
    ) -> None:
        """Begin airborne at ``start`` in GUIDED, flying straight on."""
        self._uav, self._datum = uav, datum
        self._guidance: Guidance
        self._guidance, self._limits, self._turn_share = make_guidance(uav)
        self.wind_mps = self.wind_estimate_mps = wind.vector_mps
        heading = start.heading_rad
        wx, wy = self.wind_mps
        across = wy * math.cos(heading) - wx * math.sin(heading)
        drift = math.asin(across / speed_mps)
        self.state = UavState(0.0, start.x_m, start.y_m, heading - drift, speed_mps)
        self._moving = self.state, self.wind_mps, ground_motion(self.state, self.wind_mps)
        self.altitude_m = altitude_m
        self.mode = FlightMode.GUIDED
        self.airspeed_mps = speed_mps / uav.airspeed_ratio
        self.items: list[MissionItem] = []
        self.current = 0
        self.reached: list[int] = []
        far = start.offset(FAR_M)
        self._points: list[Point | None] = []
        self.home = (start.x_m, start.y_m)
        self._leg = Leg(self.home, (far.x_m, far.y_m))
        self._track_next = False
        self._circle: Circle | None = None
        self._demand_radps = 0.0
        self._since_s = math.inf
        self._owed_m = 0.0
        self._oscillating = False

    @property
    def motion(self) -> Motion:
        """The UAV's motion over ground."""
        if self._moving[0] is not self.state or self._moving[1] is not self.wind_mps:
            motion = ground_motion(self.state, self.wind_mps)
            self._moving = self.state, self.wind_mps, motion
        return self._moving[2]

    @property
    def roll_rad(self) -> float:
        """Bank, positive to the right [rad]."""
        turn = self.state.turn_rate_radps * self.state.airspeed_mps
        return -math.atan(turn / (G_MPS2 * self._turn_share))

    @property
    def uav(self) -> Uav:
        """How it was set up."""
        return self._uav

    # Modes and mission -------------------------------------------------------------------------

    def set_mode(self, mode: FlightMode) -> None:
        """Change the flight mode; AUTO without a mission is refused by staying as it is."""
        if mode is FlightMode.AUTO:
            if len(self.items) < 2:
                return
            if self.mode is not FlightMode.AUTO:
                self.mode = mode
                self._track_next = False
                self._start(self.current or 1)
            return
        self.mode = mode
        centre = self.home if mode is FlightMode.RTL else self._here
        self._circle = Circle(centre, self._uav.loiter_radius_m)

    def load(self, items: list[MissionItem]) -> None:
        """Take a new mission; in AUTO the leg being flown keeps its old target."""
        self.items = list(items)
        self._points = [None] * len(items)

    def truncate(self, count: int) -> None:
        """Drop the items from ``count`` on."""
        del self.items[count:]
        del self._points[count:]

    def replace_item(self, seq: int, item: MissionItem) -> None:
        """Put an item in the place of another, or behind the last."""
        self.items[seq : seq + 1] = [item]
        self._points[seq : seq + 1] = [None]

    def set_current(self, seq: int) -> bool:
        """Fly to item ``seq`` next; return whether there is such an item."""
        if not 0 < seq < len(self.items):
            return False
        self.current = seq
        if self.mode is FlightMode.AUTO:
            if not self._guidance.starts_at_target:
                self._track_next = False
            self._start(seq)
            self._track_next = False
        return True

    def _point(self, seq: int) -> Point:
        """Return where an item is [m]: worked out when it is first flown to, as most never are."""
        found = self._points[seq]
        if found is None:
            item = self.items[seq]
            x, y, _ = self._datum.to_local(item.latitude_e7 / 1e7, item.longitude_e7 / 1e7)
            found = self._points[seq] = x, y
        return found

    @property
    def _here(self) -> Point:
        return self.state.x_m, self.state.y_m

    def _flown_index(self, seq: int) -> int | None:
        """Return the item that is flown when ``seq`` comes up: jumps lead on."""
        for _ in range(len(self.items)):
            if not 0 < seq < len(self.items):
                return None
            if self.items[seq].command != mavlink.MAV_CMD_DO_JUMP:
                return seq
            seq = int(self.items[seq].params[0])
        return None

    def _start(self, seq: int) -> None:
        """Begin the leg to an item; go home where there is none."""
        found = self._flown_index(seq)
        if found is None:
            self.set_mode(FlightMode.RTL)
            return
        self.current = found
        item, target = self.items[found], self._point(found)
        if item.command == mavlink.MAV_CMD_NAV_LOITER_UNLIM:
            self._circle = Circle(target, item.params[2] or self._uav.loiter_radius_m)
            return
        self._circle = None
        begin = self._leg.target if self._track_next else self._here
        leg = Leg(
            begin,
            target,
            tuple(self._after(found)),
            tracked=self._track_next,
            accept_m=item.params[1],
        )
        if self._guidance.starts_at_target and leg.passed_by(self.motion):
            leg = replace(leg, begin=self._here)
        self._leg = leg
        self._track_next = True

    def _after(self, seq: int) -> list[Point]:
        """Return the points that are flown after an item."""
        points: list[Point] = []
        found = self._flown_index(seq + 1)
        while found is not None and len(points) < self._guidance.looks_ahead:
            points.append(self._point(found))
            found = self._flown_index(found + 1)
        return points

    # Flying ------------------------------------------------------------------------------------

    def owe(self, extra_m: float) -> None:
        """From the next turn on, fly this much farther than is made good [m]."""
        self._owed_m = extra_m
        self._oscillating = False

    def turn_no_tighter(self, radius_m: float) -> None:
        """From now on, turn with this radius [m] at the tightest: of the kinematic model only."""
        self._limits = self._limits._replace(min_radius_m=radius_m)

    def _flown_s(self, dt_s: float) -> float:
        """Return how long it would take to fly what is made good of ``dt_s`` [s]."""
        if self._owed_m <= 0.0:
            return dt_s
        turning = abs(self.state.turn_rate_radps) * TURN_RADIUS_M > self.state.airspeed_mps
        self._oscillating = self._oscillating or turning
        if not self._oscillating:
            return dt_s
        self._owed_m -= OSCILLATION_LOSS * self.state.airspeed_mps * dt_s
        return (1.0 - OSCILLATION_LOSS) * dt_s

    def step(self, dt_s: float) -> None:
        """Fly for ``dt_s`` [s]."""
        share = dt_s / WIND_ESTIMATE_S
        (x_mps, y_mps), (now_x_mps, now_y_mps) = self.wind_estimate_mps, self.wind_mps
        self.wind_estimate_mps = (
            x_mps + share * (now_x_mps - x_mps),
            y_mps + share * (now_y_mps - y_mps),
        )
        self._since_s += dt_s
        if self._since_s >= self._guidance.period_s - 1e-9:
            self._since_s = 0.0
            self._navigate()
        uav = self._uav
        indicated = min(max(self.airspeed_mps, uav.airspeed_min_mps), uav.airspeed_max_mps)
        self.state = step(
            self.state,
            self._flown_s(dt_s),
            turn_rate_radps=self._demand_radps,
            airspeed_mps=uav.airspeed_ratio * indicated,
            limits=self._limits,
            wind_mps=self.wind_mps,
            clock_s=dt_s,
        )

    def _navigate(self) -> None:
        """Demand a turn rate; then leave the legs that are done, as ArduPlane does."""
        motion, airspeed = self.motion, self.state.airspeed_mps
        if self._circle is not None:
            around = self._circle
            self._demand_radps = self._guidance.around(
                around.centre, around.radius_m, motion, airspeed
            )
            return
        self._demand_radps = self._guidance.along(self._leg, motion, airspeed)
        while self._circle is None and self._guidance.leaves(self._leg, motion):
            if self.mode is FlightMode.AUTO:
                self.reached.append(self.current)
                self._start(self.current + 1)
            else:
                self.set_mode(FlightMode.RTL)
