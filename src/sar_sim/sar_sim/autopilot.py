"""The simulated autopilot: flight modes, a mission, and a path follower, over a kinematic UAV.

It keeps ArduPlane's conventions: item 0 is home, a mission's end means RTL, a leg that is made
current begins at the present position.
"""

from __future__ import annotations

import enum
import math
from dataclasses import replace

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mission_items import MissionItem
from sar_estimator.geodesy import Datum
from sar_estimator.plane import Pose, wrap_angle
from sar_estimator.states import Motion
from sar_sim.scenario import Uav, Wind
from sar_sim.uav import UavLimits, UavState, ground_motion, step

Point = tuple[float, float]
OSCILLATION_LOSS = 0.4
TURN_RADIUS_M = 300.0


class FlightMode(enum.IntEnum):
    """ArduPlane's numbers of the modes that are simulated."""

    AUTO = 10
    RTL = 11
    LOITER = 12
    GUIDED = 15


def lookahead_point(points: list[Point], here: Point, first: int, reach_m: float) -> Point:
    """Return the point ``reach_m`` [m] along a polyline from the foot of ``here`` on leg ``first``.

    Leg ``first`` runs from point ``first`` to ``first + 1``; beyond the end the last leg goes on.
    """
    (ax, ay), (bx, by) = points[first], points[first + 1]
    length = max(1e-9, math.hypot(bx - ax, by - ay))
    at = ((here[0] - ax) * (bx - ax) + (here[1] - ay) * (by - ay)) / length + reach_m
    while at > length and first + 2 < len(points):
        at -= length
        first += 1
        (ax, ay), (bx, by) = points[first], points[first + 1]
        length = max(1e-9, math.hypot(bx - ax, by - ay))
    return ax + (bx - ax) * at / length, ay + (by - ay) * at / length


class SimAutopilot:
    """One airborne UAV and its autopilot; advance it with ``step``."""

    def __init__(
        self,
        start: Pose,
        *,
        speed_mps: float,
        uav: Uav,
        wind: Wind,
        datum: Datum,
        altitude_m: float,
    ) -> None:
        """Begin airborne at ``start`` in GUIDED, flying straight on."""
        self._uav, self._datum = uav, datum
        self._limits = UavLimits(uav.min_radius_m, uav.accel_limit_mps2, uav.roll_lag_s)
        towards = math.radians(270.0 - wind.from_deg)
        self._wind = (wind.speed_mps * math.cos(towards), wind.speed_mps * math.sin(towards))
        heading = start.heading_rad
        drift = math.asin(
            (self._wind[1] * math.cos(heading) - self._wind[0] * math.sin(heading)) / speed_mps
        )
        self.state = UavState(0.0, start.x_m, start.y_m, heading - drift, speed_mps)
        self.altitude_m = altitude_m
        self.mode = FlightMode.GUIDED
        self.airspeed_mps = speed_mps
        self.items: list[MissionItem] = []
        self.current = 0
        self.reached: list[int] = []
        far = start.offset(50_000.0)
        self._home = (start.x_m, start.y_m)
        self._route: list[Point] = [self._home, (far.x_m, far.y_m)]
        self._leg = 0
        self._circle: Point | None = None
        self._owed_m = 0.0
        self._oscillating = False

    @property
    def motion(self) -> Motion:
        """The UAV's motion over ground."""
        return ground_motion(self.state, self._wind)

    def set_mode(self, mode: FlightMode) -> None:
        """Change the flight mode; AUTO without a mission is refused by staying as it is."""
        if mode is FlightMode.AUTO:
            if len(self.items) < 2:
                return
            if self.mode is not FlightMode.AUTO:
                self.mode = mode
                self.set_current(self.current or 1)
            return
        self.mode = mode
        here = (self.state.x_m, self.state.y_m)
        self._circle = self._home if mode is FlightMode.RTL else here

    def load(self, items: list[MissionItem]) -> None:
        """Take a new mission; in AUTO the leg being flown keeps its old target."""
        self.items = list(items)

    def set_current(self, seq: int) -> bool:
        """Fly to item ``seq`` from the present position; return whether there is such an item."""
        if not 0 < seq < len(self.items):
            return False
        self.current = seq
        if self.mode is FlightMode.AUTO:
            here = (self.state.x_m, self.state.y_m)
            self._route = [here, *(self._point(item) for item in self.items[seq:])]
            self._leg = 0
            self._circle = None
        return True

    def _point(self, item: MissionItem) -> Point:
        x, y, _ = self._datum.to_local(item.latitude_e7 / 1e7, item.longitude_e7 / 1e7)
        return x, y

    def owe(self, extra_m: float) -> None:
        """From the next turn on, fly this much farther than is made good [m]."""
        self._owed_m = extra_m
        self._oscillating = False

    def _made_good(self, dt_s: float) -> float:
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
        if self._circle is None:
            self._advance_leg()
        rate = self._follow_circle() if self._circle is not None else self._follow_route()
        time_s = self.state.time_s + dt_s
        moved = step(
            self.state,
            self._made_good(dt_s),
            turn_rate_radps=rate,
            airspeed_mps=self.airspeed_mps,
            limits=self._limits,
            wind_mps=self._wind,
        )
        self.state = replace(moved, time_s=time_s)

    def _advance_leg(self) -> None:
        """Pass on to the next leg once its end is behind; then loiter or go home."""
        here = np.array((self.state.x_m, self.state.y_m))
        while True:
            a, b = np.array(self._route[self._leg]), np.array(self._route[self._leg + 1])
            if float((here - b) @ (b - a)) < 0.0:
                return
            if self.mode is FlightMode.AUTO:
                self.reached.append(self.current)
            if self._leg + 2 < len(self._route):
                self._leg += 1
                self.current += 1
            elif self.mode is FlightMode.AUTO and self._ends_in_loiter():
                self._circle = self._route[-1]
                return
            else:
                self.set_mode(FlightMode.RTL)
                return

    def _ends_in_loiter(self) -> bool:
        return bool(self.items) and (self.items[-1].command == mavlink.MAV_CMD_NAV_LOITER_UNLIM)

    def _rate_towards(self, x_m: float, y_m: float) -> float:
        """Turn rate [rad/s] of the arc over ground through a point; behind, as tight as can be."""
        motion = self.motion
        dx, dy = x_m - motion.x_m, y_m - motion.y_m
        off = wrap_angle(math.atan2(dy, dx) - motion.course_rad)
        if abs(off) > math.pi / 2.0:
            return math.copysign(motion.speed_mps / self._limits.min_radius_m, off)
        return 2.0 * motion.speed_mps * math.sin(off) / max(1.0, math.hypot(dx, dy))

    def _follow_route(self) -> float:
        here = (self.state.x_m, self.state.y_m)
        reach = max(self._uav.lookahead_m, 3.0 * self._uav.roll_lag_s * self.state.airspeed_mps)
        return self._rate_towards(*lookahead_point(self._route, here, self._leg, reach))

    def _follow_circle(self) -> float:
        """Circle the loiter point clockwise: aim at the circle a little ahead."""
        assert self._circle is not None
        cx, cy = self._circle
        radius = self._uav.loiter_radius_m
        dx, dy = self.state.x_m - cx, self.state.y_m - cy
        if math.hypot(dx, dy) > 2.0 * radius:
            return self._rate_towards(cx, cy)
        ahead = math.atan2(dy, dx) - 0.4
        return self._rate_towards(cx + radius * math.cos(ahead), cy + radius * math.sin(ahead))
