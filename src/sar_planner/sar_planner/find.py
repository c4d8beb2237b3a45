"""What was found: marks, and the circle that the UAV flies about one. Pure.

The UAV leaves the formation by a way that keeps the separation from all that the helicopter may
do, and does not cross ahead of it; it circles the mark until it is called back. The circle is given
to the autopilot as waypoints, a good lap of them at a time, so that the monitor knows it as any
other list.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sar_estimator.common.pose import Pose, wrap_angle
from sar_estimator.common.reports import Mark
from sar_estimator.common.states import Motion
from sar_planner.guidance.waypoint_lists import Listed, PathListing, WaypointLists
from sar_planner.parameters.corner import CornerParameters
from sar_planner.parameters.mission import MissionParameters
from sar_planner.paths.circle_entry import TWO_PI, entries
from sar_planner.paths.flight_path import Arc, FlightPath
from sar_planner.prediction.forecast import Forecast, Stretch, cruising
from sar_planner.prediction.situation import Situation
from sar_planner.strategies.active_corner import Mode
from sar_planner.strategies.strategy import StrategyReport

LAPS = 1.25
SPACING_M = 60.0
"""Between waypoints: 1.5 m aside of a circle of 300 m, and a list that is uploaded soon."""
RENEWED_LAPS = 0.5
LOOKED_S = 60.0
WATCH_S = 1.0
FRONT_M = 1000.0
"""Ahead of the helicopter, within which the UAV does not cross its track."""
FRONT_STEP_S, APART_STEP_S = 2.0, 0.5
STANDING_MPS = 5.0
HEADS_RAD = math.radians(40.0)
OFF_M, FLOWN_STEPS = 150.0, 76
MOST_MARKS = 50


class Marks:
    """What was marked, in the order of its numbers."""

    def __init__(self, same_m: float) -> None:
        """Know none; one within ``same_m`` [m] of another is that one, moved."""
        self._same_m = same_m
        self.all: tuple[Mark, ...] = ()

    @property
    def newest(self) -> Mark | None:
        """The mark that was set or moved last: that one is orbited."""
        return max(self.all, key=lambda one: (one.time_s, one.number), default=None)

    def add(self, time_s: float, x_m: float, y_m: float) -> Mark:
        """Set a mark, or move one that is there already."""
        off = [math.hypot(one.x_m - x_m, one.y_m - y_m) for one in self.all]
        number = len(self.all) + 1
        if off and (min(off) <= self._same_m or len(off) >= MOST_MARKS):
            number = 1 + off.index(min(off))
        mark = Mark(number, time_s, x_m, y_m)
        self.all = (*self.all[: number - 1], mark, *self.all[number:])
        return mark


@dataclass(frozen=True, slots=True)
class OrbitState:
    """What is flown about a mark; ``path`` is None while no safe way was found yet.

    ``around``: 1 to the left, -1 to the right. ``flown_m``: along the path. ``is_moved``: the mark
    is elsewhere than the path's circle.
    """

    mark: Mark
    path: FlightPath | None = None
    around: float = 1.0
    flown_m: float = 0.0
    looked_s: float = -math.inf
    tried_s: float = -math.inf
    problem: str = ""
    is_moved: bool = False


class Orbit:
    """Leads the UAV about a mark while ``state`` is not None."""

    def __init__(
        self,
        situation: Situation,
        corner: CornerParameters,
        mission: MissionParameters,
        lists: WaypointLists,
    ) -> None:
        """Lead to nowhere yet. Raises ``ValueError`` for a circle that is too small."""
        least_m = corner.separation_m + mission.separation_margin_m
        least_m = max(least_m, corner.turn_radius_m)
        if mission.orbit_radius_m < least_m:
            raise ValueError(
                f"parameter orbit_radius_m = {mission.orbit_radius_m:g}: expected at least "
                f"{least_m:g}, min_separation_m and its margin: the helicopter may hover inside"
            )
        self._s, self._corner, self._mission, self._lists = situation, corner, mission, lists
        self.state: OrbitState | None = None

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
            self.state = replace(self.state, mark=mark, tried_s=-math.inf, is_moved=True)

    def end(self) -> None:
        """Lead it there no more."""
        self.state = None

    def again(self) -> None:
        """Find a way anew: the one that was flown is not flown any more."""
        if self.state is not None:
            self.state = OrbitState(self.state.mark)

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
        if self.state is None or uav is None:
            return None
        if self.state.path is None:
            return self._find_way(now_s, uav)
        state = self._flown(self.state, uav)
        if now_s - state.looked_s < WATCH_S:
            self.state = state
            return None
        state = self.state = replace(state, looked_s=now_s)
        assert state.path is not None
        rest = state.path.cut(state.flown_m)
        at = rest.start
        lost = math.hypot(uav.x_m - at.x_m, uav.y_m - at.y_m) > OFF_M
        ahead = rest.cut(0.0, min(rest.length_m, LOOKED_S * self._corner.speed_mps))
        near_m = self._apart_m(ahead, now_s, self._forecasts(now_s))
        if state.is_moved or lost or near_m < self._corner.separation_m:
            return self._find_way(now_s, uav)
        lap_m = TWO_PI * self._mission.orbit_radius_m
        if rest.length_m < RENEWED_LAPS * lap_m:
            return self._listed(replace(state, path=self._around(rest, state.around), flown_m=0.0))
        return None

    # Steps -------------------------------------------------------------------------------------

    def _flown(self, state: OrbitState, uav: Motion) -> OrbitState:
        """Return how far along its path the UAV is, near where it was."""
        assert state.path is not None
        last_m = min(state.flown_m + OFF_M, state.path.length_m)
        along_m = np.linspace(state.flown_m, last_m, FLOWN_STEPS)
        off = state.path.points(along_m) - (uav.x_m, uav.y_m)
        nearest = int(np.square(off).sum(axis=1).argmin())
        return replace(state, flown_m=float(along_m[nearest]))

    def _around(self, path: FlightPath, around: float) -> FlightPath:
        """Return a path with the circle behind it."""
        arc = Arc(self._mission.orbit_radius_m, around * LAPS * TWO_PI)
        return path.then(FlightPath.of(path.end, (arc,)))

    def _find_way(self, now_s: float, uav: Motion) -> Listed | None:
        """Take the shortest safe way onto the circle; the safest where a path is flown already."""
        state, mission = self.state, self._mission
        assert state is not None
        if now_s - state.tried_s < mission.retry_s:
            return None
        self.state = state = replace(state, tried_s=now_s)
        start = uav.after(now_s - uav.time_s + mission.reaction_s).pose
        ways = entries(
            start,
            (state.mark.x_m, state.mark.y_m),
            circle_m=mission.orbit_radius_m,
            turn_m=self._corner.turn_radius_m,
        )
        wanted_m = self._corner.separation_m + mission.separation_margin_m
        start_s = now_s + mission.reaction_s
        forecasts = self._forecasts(start_s)
        best: tuple[float, FlightPath, float] | None = None
        for way, around in ways:
            path = self._around(way, around)
            looked = path.cut(0.0, min(path.length_m, 2.0 * LOOKED_S * self._corner.speed_mps))
            if self._cuts_in_front(looked, now_s):
                continue
            apart_m = self._apart_m(looked, start_s, forecasts)
            if best is None or apart_m > best[0]:
                best = apart_m, path, around
            if apart_m >= wanted_m:
                break
        if best is None or (best[0] < wanted_m and state.path is None):
            problem = f"no safe way to mark {state.mark.number} yet"
            self.state = replace(state, problem=problem)
            return None
        apart_m, path, around = best
        problem = "" if apart_m >= wanted_m else f"comes within {apart_m:.0f} m of the helicopter"
        return self._listed(
            replace(state, path=path, around=around, flown_m=0.0, problem=problem, is_moved=False)
        )

    def _listed(self, state: OrbitState) -> Listed | None:
        self.state = state
        assert state.path is not None
        assert self._s.uav is not None
        listing = PathListing(
            str(Mode.ORBIT), state.path, self._corner.speed_mps, spacing_m=SPACING_M
        )
        return self._lists.make(listing, self._s.uav)

    # The helicopter ----------------------------------------------------------------------------

    def _forecasts(self, now_s: float) -> Sequence[Forecast]:
        """Return what the helicopter may do: as on its leg, straight on, stand, go to the mark.

        That it goes to the mark is believed when the order is new, and later while it heads there:
        else a UAV on its circle would make way for a helicopter that searches on.
        """
        helicopter, state = self._s.helicopter, self.state
        assert state is not None
        if helicopter is None:
            return ()
        now = helicopter.after(now_s - helicopter.time_s)
        speed = now.speed_mps
        standing = Forecast((Stretch(now_s, now.pose, 0.0),), now.pose, now_s, 0.0)
        found = [*self._s.forecasts(now_s), cruising(now_s, now.pose, speed), standing]
        dx, dy = state.mark.x_m - now.x_m, state.mark.y_m - now.y_m
        away_m, fast = math.hypot(dx, dy), max(speed, self._corner.speed_mps)
        towards = Pose(now.x_m, now.y_m, math.atan2(dy, dx))
        heads = abs(wrap_angle(towards.heading_rad - now.course_rad)) < HEADS_RAD
        if state.path is not None and not (heads and speed > STANDING_MPS):
            return found
        there = Stretch(now_s + away_m / fast, towards.offset(away_m), 0.0)
        going = Stretch(now_s, towards, fast)
        return [*found, Forecast((going, there), towards, now_s, fast)]

    def _apart_m(self, path: FlightPath, start_s: float, forecasts: Sequence[Forecast]) -> float:
        """Return the least distance of a path to anything the helicopter may do [m]."""
        speed = self._corner.speed_mps
        return min(
            (_least_m(path, forecast, start_s, speed) for forecast in forecasts),
            default=math.inf,
        )

    def _cuts_in_front(self, path: FlightPath, now_s: float) -> bool:
        """Whether a path crosses the helicopter's track ahead of it, near it."""
        helicopter = self._s.helicopter
        if helicopter is None or helicopter.speed_mps < STANDING_MPS:
            return False
        now = helicopter.after(now_s - helicopter.time_s)
        times = np.arange(0.0, path.length_m / self._corner.speed_mps, FRONT_STEP_S)
        course = now.course_rad
        along = np.array((math.cos(course), math.sin(course)))
        flown = path.points(times * self._corner.speed_mps) - (now.x_m, now.y_m)
        ahead = flown @ along - now.speed_mps * times
        beside = flown @ np.array((-along[1], along[0]))
        crossed = beside[:-1] * beside[1:] < 0.0
        return bool((crossed & (ahead[1:] > 0.0) & (ahead[1:] < FRONT_M)).any())


def _least_m(path: FlightPath, forecast: Forecast, start_s: float, speed_mps: float) -> float:
    """Return the least distance [m] to one forecast, while the path is flown and no longer."""
    times = np.arange(0.0, path.length_m / speed_mps, APART_STEP_S)
    gaps = path.points(times * speed_mps) - forecast.positions(start_s + times)
    return math.sqrt(float(np.square(gaps).sum(axis=1).min(initial=math.inf)))


class Finding:
    """Marks, and who is led about them: ``marks``, ``orbit``."""

    def __init__(self, situation: Situation, mission: MissionParameters, orbit: Orbit) -> None:
        """Know nothing."""
        self._s, self._stale_s = situation, mission.stale_s
        self.marks = Marks(mission.same_mark_m)
        self.orbit = orbit

    def mark(self, now_s: float, place: tuple[float, float] | None = None) -> Mark | None:
        """Mark a place [m]; without one, where the helicopter is, else the UAV; None for nowhere.

        A mark that is being orbited and is moved is followed.
        """
        for motion in (self._s.helicopter, self._s.uav):
            fresh = motion is not None and now_s - motion.time_s <= self._stale_s
            if place is None and motion is not None and fresh:
                place = motion.x_m, motion.y_m
        if place is None:
            return None
        mark = self.marks.add(now_s, *place)
        orbited = self.orbit.state
        if orbited is not None and orbited.mark.number == mark.number:
            self.orbit.move(mark)
        return mark

    def order(self, obstacle: str) -> str:
        """Begin to orbit the newest mark, unless there is an obstacle; return why not."""
        mark = self.marks.newest
        if obstacle or mark is None:
            return obstacle or "nothing is marked"
        self.orbit.begin(mark)
        return ""

    def resume(self) -> str:
        """End the orbit; return why not, empty when ended."""
        if self.orbit.state is None:
            return "no mark is orbited"
        self.orbit.end()
        return ""
