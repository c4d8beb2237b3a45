"""The circle that the UAV flies about a mark. Pure.

The UAV leaves the formation by a way that keeps the separation from all that the helicopter may
do, and does not cross ahead of it; it circles the mark until it is called back. The circle is given
to the autopilot as waypoints, a good lap of them at a time, so that the monitor knows it as any
other list.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from sar_estimator.common.pose import Pose, wrap_angle
from sar_estimator.common.reports import Mark
from sar_estimator.common.states import Motion, Phase
from sar_planner.guidance.turn_radius import TurnRadius
from sar_planner.guidance.waypoint_lists import Listed, PathListing, WaypointLists
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.circle_entry import TWO_PI, entries
from sar_planner.paths.flight_path import Arc, FlightPath, Straight
from sar_planner.prediction.free_flight import FreeFlight, Possible, least_apart_m
from sar_planner.prediction.situation import Situation
from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.strategy import StrategyReport

LAPS = 1.25
SPACING_M = 60.0
"""Between waypoints: 1.5 m aside of a circle of 300 m, and a list that is uploaded soon."""
RENEWED_LAPS = 0.5
LOOKED_S = 60.0
WATCH_S = 1.0
WIDER_M = (0.0, 100.0, 200.0, 400.0)
AWAY_RAD, AWAY_M = (0.0, 0.7, -0.7), (300.0, 900.0)
FEW = 4
OFF_M, FLOWN_STEPS = 150.0, 76


@dataclass(frozen=True, slots=True)
class OrbitState:
    """What is flown about a mark; ``path`` is None while no safe way was found yet.

    ``around``: 1 to the left, -1 to the right. ``circle_m``: the circle's radius. ``flown_m``:
    along the path. ``is_stale``: another path is due: the mark was moved, or this one is not flown.
    """

    mark: Mark
    path: FlightPath | None = None
    around: float = 1.0
    circle_m: float = 0.0
    flown_m: float = 0.0
    looked_s: float = -math.inf
    tried_s: float = -math.inf
    problem: str = ""
    is_stale: bool = False


class _Way(NamedTuple):
    """A way onto a circle, and how far it keeps from the helicopter [m]."""

    apart_m: float
    path: FlightPath
    around: float
    circle_m: float


class Orbit:
    """Leads the UAV about a mark while ``state`` is not None."""

    def __init__(
        self,
        situation: Situation,
        corner: CornerParameters,
        mission: MissionParameters,
        lists: WaypointLists,
        turns: TurnRadius,
    ) -> None:
        """Lead to nowhere yet; turn as ``turns`` has learnt.

        Raises ``ValueError`` for a circle that is too small.
        """
        least_m = corner.separation_m + mission.separation_margin_m
        least_m = max(least_m, corner.turn_radius_m)
        if mission.orbit_radius_m < least_m:
            raise ValueError(
                f"parameter orbit_radius_m = {mission.orbit_radius_m:g}: expected at least "
                f"{least_m:g}, min_separation_m and its margin: the helicopter may hover inside"
            )
        self._s, self._corner, self._mission, self._lists = situation, corner, mission, lists
        self._turns = turns
        self._free = FreeFlight(situation, corner)
        self.state: OrbitState | None = None

    def set_reaction(self, reaction_s: float) -> None:
        """Plan with another time [s] from a decision to the autopilot flying the list."""
        self._mission = replace(self._mission, reaction_s=reaction_s)

    @property
    def flying(self) -> bool:
        """Whether the UAV is on its way to the circle, or on it."""
        return self.state is not None and self.state.path is not None

    def begin(self, mark: Mark) -> None:
        """Lead the UAV about a mark as soon as there is a safe way."""
        self.state = OrbitState(mark)

    def move(self, mark: Mark) -> None:
        """Lead the UAV about the mark where it is now, as soon as there is a safe way.

        Until then it stays on its circle.
        """
        if self.state is not None:
            self.state = replace(self.state, mark=mark)
            self.again()

    def end(self) -> None:
        """Lead it there no more."""
        self.state = None

    def again(self) -> None:
        """Find a way anew: the one that was told of is not flown."""
        if self.state is not None:
            self.state = replace(self.state, tried_s=-math.inf, is_stale=True)

    @property
    def stays_for(self) -> str:
        """Why there is no leg to fly beside, empty where there is one."""
        leg, low_high = self._s.leg, self._mission.speed_range
        if leg is None or self._s.phase is not Phase.CRUISE or not self._free.flies_straight:
            what = "not straight on" if self._s.phase is Phase.CRUISE else str(self._s.phase)
            return f"the helicopter is {what}: there is no leg to fly beside yet"
        low, high = (share * self._corner.speed_mps for share in low_high)
        if not low <= leg.speed_mps <= high:
            return f"helicopter's speed {leg.speed_mps:.1f} m/s: expected {low:.1f} to {high:.1f}"
        return ""

    @property
    def report(self) -> StrategyReport:
        """What it tells of itself."""
        state, speed = self.state, self._corner.speed_mps
        if state is None or state.path is None:
            return StrategyReport(Mode.ORBIT)
        ahead = min(state.flown_m + speed * self._mission.speed_lead_s, state.path.length_m)
        course = state.path.pose_at(ahead).heading_rad
        return StrategyReport(Mode.ORBIT, speed_mps=speed, course_rad=course, problem=state.problem)

    def update(self, now_s: float) -> Listed | None:
        """Return a new list where one is due."""
        uav = self._s.uav
        self._free.watch()
        if self.state is None or uav is None:
            return None
        if self.state.path is None:
            return self._find_way(now_s, uav)
        state = self._flown(self.state, uav)
        if now_s - state.looked_s < WATCH_S:
            self.state = state
            return None
        self.state = state = replace(state, looked_s=now_s)
        if self._is_lost(state, uav, now_s):
            return self._find_way(now_s, uav)
        return self._circled_on(state, uav, now_s)

    # Steps -------------------------------------------------------------------------------------

    def _is_lost(self, state: OrbitState, uav: Motion, now_s: float) -> bool:
        """Whether the path is not what is flown, or leads too near the helicopter."""
        assert state.path is not None
        rest = state.path.cut(state.flown_m)
        off_m = math.hypot(uav.x_m - rest.start.x_m, uav.y_m - rest.start.y_m)
        ahead = rest.cut(0.0, min(rest.length_m, LOOKED_S * self._corner.speed_mps))
        near_m = least_apart_m(self._possible(now_s), ahead, now_s, self._corner.speed_mps)
        return state.is_stale or off_m > OFF_M or near_m < self._corner.separation_m

    def _circled_on(self, state: OrbitState, uav: Motion, now_s: float) -> Listed | None:
        """Add to the circle before it ends; one that was widened may be narrowed then."""
        assert state.path is not None
        if state.path.length_m - state.flown_m >= RENEWED_LAPS * TWO_PI * state.circle_m:
            return None
        if state.circle_m > self._mission.orbit_radius_m:
            return self._find_way(now_s, uav)
        path = _around(state.path.cut(state.flown_m), state.circle_m, state.around)
        return self._listed(replace(state, path=path, flown_m=0.0))

    def _flown(self, state: OrbitState, uav: Motion) -> OrbitState:
        """Return how far along its path the UAV is, near where it was."""
        assert state.path is not None
        last_m = min(state.flown_m + OFF_M, state.path.length_m)
        along_m = np.linspace(state.flown_m, last_m, FLOWN_STEPS)
        off = state.path.points(along_m) - (uav.x_m, uav.y_m)
        nearest = int(np.square(off).sum(axis=1).argmin())
        return replace(state, flown_m=float(along_m[nearest]))

    def _find_way(self, now_s: float, uav: Motion) -> Listed | None:
        """Take the shortest safe way onto the circle; the safest where a path is flown already.

        Where the helicopter is in the circle, and not in its middle, a wider one is flown; where
        none will do, the UAV flies away from it first.
        """
        state, mission = self.state, self._mission
        assert state is not None
        if now_s - state.tried_s < mission.retry_s:
            return None
        self.state = state = replace(state, tried_s=now_s)
        start = uav.after(now_s - uav.time_s + mission.reaction_s).pose
        possible = self._possible(now_s + mission.reaction_s)
        wanted_m = self._corner.separation_m + mission.separation_margin_m
        best: _Way | None = None
        for wider_m, prefixes in (*((one, None) for one in WIDER_M), (0.0, self._away(start))):
            circle_m = mission.orbit_radius_m + wider_m
            ways = self._ways(start, circle_m, prefixes)
            way = self._best_way(ways, possible, circle_m, now_s, wanted_m)
            if way is not None and (best is None or way.apart_m > best.apart_m):
                best = way
            if best is not None and best.apart_m >= wanted_m:
                break
        if best is None or (best.apart_m < wanted_m and state.path is None):
            problem = f"no safe way to mark {state.mark.number} yet"
            self.state = replace(state, problem=problem)
            return None
        problem = ""
        if best.apart_m < wanted_m:
            problem = f"comes within {best.apart_m:.0f} m of the helicopter"
        elif best.circle_m > mission.orbit_radius_m:
            problem = f"circles at {best.circle_m:g} m: the helicopter is inside"
        return self._listed(
            replace(
                state,
                path=best.path,
                around=best.around,
                circle_m=best.circle_m,
                flown_m=0.0,
                problem=problem,
                is_stale=False,
            )
        )

    def _away(self, start: Pose) -> list[FlightPath]:
        """Return ways that lead away from the helicopter; none where it is not known."""
        helicopter = self._s.helicopter
        if helicopter is None:
            return []
        away = math.atan2(start.y_m - helicopter.y_m, start.x_m - helicopter.x_m)
        found = []
        for aside in AWAY_RAD:
            turn = wrap_angle(away + aside - start.heading_rad)
            for straight_m in AWAY_M:
                arc = Arc(self._turns.believed.radius_m, turn)
                found.append(FlightPath.of(start, (arc, Straight(straight_m))))
        return found

    def _ways(
        self, start: Pose, circle_m: float, prefixes: list[FlightPath] | None
    ) -> list[tuple[FlightPath, float]]:
        """Return ways onto a circle and the side they are flown to, the shortest first."""
        assert self.state is not None
        mark = self.state.mark.x_m, self.state.mark.y_m
        turn_m = self._turns.believed.radius_m
        if prefixes is None:
            return entries(start, mark, circle_m=circle_m, turn_m=turn_m)
        found = []
        for first in prefixes:
            for way, around in entries(first.end, mark, circle_m=circle_m, turn_m=turn_m)[:FEW]:
                found.append((first.then(way), around))
        return sorted(found, key=lambda one: one[0].length_m)

    def _best_way(
        self,
        ways: list[tuple[FlightPath, float]],
        possible: tuple[Possible, ...],
        circle_m: float,
        now_s: float,
        wanted_m: float,
    ) -> _Way | None:
        """Return the first way that keeps ``wanted_m``, else the safest; None for no way."""
        start_s = now_s + self._mission.reaction_s
        stays, most_m = self._free.keeps_its_place, 2.0 * LOOKED_S * self._corner.speed_mps
        best: _Way | None = None
        for way, around in ways:
            path = _around(way, circle_m, around)
            # Beside one that stays where it is no way helps that only puts the circle off.
            looked = path if stays else path.cut(0.0, min(path.length_m, most_m))
            if self._free.is_cut_off_by(looked, now_s):
                continue
            apart_m = least_apart_m(possible, looked, start_s, self._corner.speed_mps)
            if best is None or apart_m > best.apart_m:
                best = _Way(apart_m, path, around, circle_m)
            if apart_m >= wanted_m:
                break
        return best

    def _listed(self, state: OrbitState) -> Listed | None:
        self.state = state
        assert state.path is not None
        assert self._s.uav is not None
        listing = PathListing(
            str(Mode.ORBIT), state.path, self._corner.speed_mps, spacing_m=SPACING_M
        )
        return self._lists.make(listing, self._s.uav)

    # The helicopter ----------------------------------------------------------------------------

    def _possible(self, now_s: float) -> tuple[Possible, ...]:
        """Return what the helicopter may do; that it comes is believed when the order is new."""
        assert self.state is not None
        mark = self.state.mark
        return self._free.possible(now_s, (mark.x_m, mark.y_m), comes=self.state.path is None)


def _around(path: FlightPath, circle_m: float, around: float) -> FlightPath:
    """Return a path with the circle behind it."""
    return path.then(FlightPath.of(path.end, (Arc(circle_m, around * LAPS * TWO_PI),)))
