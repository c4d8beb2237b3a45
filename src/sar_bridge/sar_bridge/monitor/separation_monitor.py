"""The independent separation monitor: a gate for waypoint lists, a guard that commands escapes.

Pure, and without any of the planner's code. From the motion of both aircraft it predicts where the
UAV will be that follows a list (``l1_predictor``) and where the helicopter may be
(``helicopter_hypotheses``). *Gate*: a list that breaks the least separation in prediction does not
pass. *Guard*: when the list that is flown leads close to the helicopter anyway, the UAV is sent
away until it is clear. Positions are in the map frame [m], times in seconds of one clock.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np

from sar_bridge.arduplane import l1_kernels
from sar_bridge.arduplane.l1_predictor import (
    STEP_S,
    FollowerTuning,
    Route,
    Vector,
    follow,
    motion_at_end,
)
from sar_bridge.monitor.escapes import Apart, Escape, Worth, apart, climb_m, ends, worth
from sar_bridge.monitor.helicopter_hypotheses import Future, Habits, Helicopter
from sar_estimator.common.states import FloatArray, Motion, Phase

CAUTION_SHARE, WARNING_SHARE, ESCAPE_SHARE = 0.85, 0.75, 0.65
BETTER_M = 5.0
BETTER_WAY_M = 15.0
RECHOOSE_S = 2.0
LED_MPS = 4.0
LED_S = 15.0
PLANNED_SHARE = 0.2
FARTHEST_M = 100_000.0


class Alert(enum.StrEnum):
    """How near a conflict is, in the order of severity."""

    NONE = "none"
    CAUTION = "caution"
    WARNING = "warning"
    ESCAPE = "escape"


ALERTS = tuple(Alert)


@dataclass(frozen=True, slots=True)
class MonitorParameters:
    """Thresholds, horizontal [m], and times [s].

    min_separation_m: no list passes that leads closer within horizon_s.
    gate_sigmas: standard deviations of both positions that are taken in a list's favour.
    follow_sigma_m: standard deviation of the UAV beside its predicted path.
    caution_separation_m, warning_separation_m: told when the list being flown leads closer within
    alert_horizon_s; None for a share of the least.
    escape_separation_m: the UAV is sent away when it leads closer; None for a share of the least.
    guard_sigmas: standard deviations that are taken against what is possible.
    horizon_s: how far ahead a list is looked at before it passes.
    alert_horizon_s: how far ahead the list being flown is looked at.
    escape_horizon_s: how far ahead what is likely of the helicopter is a reason to be sent away.
    possible_horizon_s: how far ahead anything possible of it is.
    alert_after_s: how long it must be so before it is told.
    escape_after_s: how long what is likely must be so, while the planner leads nowhere else.
    clear_s: how long all must be well before the planner leads again.
    escape_delay_s: from the choice of an escape until the UAV turns.
    escape_climb_m: how far it climbs where that separates more.
    escape_reach_m: how far away an escape ends.
    stale_s: age of a position from which on no list passes.
    lost_s: how long nothing sure may be known of the helicopter before the UAV is sent away.
    watch_only: say all this and do nothing, to see what a planner does by itself.
    """

    min_separation_m: float = 200.0
    gate_sigmas: float = 1.0
    follow_sigma_m: float = 5.0
    caution_separation_m: float | None = None
    warning_separation_m: float | None = None
    escape_separation_m: float | None = None
    guard_sigmas: float = 0.5
    horizon_s: float = 60.0
    alert_horizon_s: float = 40.0
    escape_horizon_s: float = 20.0
    possible_horizon_s: float = 10.0
    alert_after_s: float = 2.0
    escape_after_s: float = 4.0
    clear_s: float = 5.0
    escape_delay_s: float = 1.0
    escape_climb_m: float = 40.0
    escape_reach_m: float = 1500.0
    stale_s: float = 3.0
    lost_s: float = 15.0
    watch_only: bool = False

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for a value that cannot be meant."""
        for item in fields(self):
            value = getattr(self, item.name)
            if value is not None and not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"parameter {item.name} = {value}: expected 0 or more")
        steps = list(self.thresholds().items())
        for (upper, most), (lower, least) in pairwise(steps):
            if not 0.0 < least <= most:
                raise ValueError(
                    f"parameter {lower} = {least:g}: expected more than 0, at most {upper} = "
                    f"{most:g}"
                )
        if self.escape_delay_s > self.escape_horizon_s:
            raise ValueError(
                f"parameter escape_delay_s = {self.escape_delay_s}: expected at most "
                f"escape_horizon_s = {self.escape_horizon_s}"
            )
        if not STEP_S <= self.escape_horizon_s <= self.alert_horizon_s <= self.horizon_s <= 300.0:
            raise ValueError(
                f"parameter escape_horizon_s = {self.escape_horizon_s}: expected at most "
                f"alert_horizon_s = {self.alert_horizon_s}, that at most horizon_s = "
                f"{self.horizon_s}, and that at most 300"
            )

    def thresholds(self) -> dict[str, float]:
        """Return the distances [m] that something is told, or done, below; the largest first."""
        least = self.min_separation_m
        shares = (
            ("caution_separation_m", CAUTION_SHARE),
            ("warning_separation_m", WARNING_SHARE),
            ("escape_separation_m", ESCAPE_SHARE),
        )
        found = {"min_separation_m": least}
        for name, share in shares:
            value = getattr(self, name)
            found[name] = share * least if value is None else value
        return found


@dataclass(frozen=True, slots=True)
class Approach:
    """A closest approach in prediction: distance [m], in how long [s], and what would lead to it.

    Distances are bounds: the doubt is taken off, or added, already.
    """

    distance_m: float
    in_s: float
    future: str

    def __str__(self) -> str:
        """Say it."""
        return f"{self.distance_m:.0f} m in {self.in_s:.0f} s if the helicopter {self.future}"


@dataclass(frozen=True, slots=True)
class Offered:
    """A list, shape (n, 2) [m], and the ground speed it is planned with, None for V."""

    points: FloatArray
    speed_mps: float | None

    def route(self, uav: Motion) -> Route:
        """Return it as flown by a UAV from where it is."""
        return Route(self.points, uav, speed_mps=self.speed_mps)


def _distance(approach: Approach) -> float:
    return approach.distance_m


NO_APPROACH = Approach(math.inf, 0.0, "")


class SeparationMonitor:
    """Gate and guard. It is told what is known, and asked about lists, and what is to be done.

    ``alert``: the state of the list being flown. ``nearest``: its closest approach in prediction.
    ``reason``: why the newest list was refused, or the UAV was sent away. ``refused_id``: of
    the newest list where it did not pass, else 0. ``counts``: how often each alert began, and
    lists passed and were refused. ``thresholds``: the distances [m] of ``parameters``.
    """

    def __init__(self, parameters: MonitorParameters, habits: Habits) -> None:
        """Know nothing yet."""
        self.parameters = parameters
        self.helicopter = Helicopter(habits)
        self.tuning = FollowerTuning()
        self.uav: Motion | None = None
        self.wind_mps: Vector = (0.0, 0.0)
        self.above_m = 0.0
        self.alert = Alert.NONE
        self.nearest = NO_APPROACH
        self.reason = ""
        self.refused_id = 0
        self.escape: Escape | None = None
        self.counts = dict.fromkeys((*Alert, "passed", "refused"), 0)
        self.thresholds = parameters.thresholds()
        count = round(parameters.horizon_s / STEP_S) + 1
        self._times: FloatArray = STEP_S * np.arange(count, dtype=np.float64)
        self._flown: Route | None = None
        self._cleared: dict[int, Offered] = {}
        self._clear_since_s = math.inf
        self._near_since_s = self._conflict_since_s = math.inf
        self._sure_s = math.inf
        self._chosen_s = -math.inf
        self._off_mps = 0.0

    # What is known -----------------------------------------------------------------------------

    def set_uav(self, motion: Motion) -> None:
        """Take the UAV's newest motion."""
        if not motion.is_finite():
            return
        if self.uav is not None and motion.time_s > self.uav.time_s:
            share = -math.expm1((self.uav.time_s - motion.time_s) / LED_S)
            off = motion.speed_mps - self.helicopter.cruise_mps
            self._off_mps += share * (off - self._off_mps)
        self.uav = motion
        if self._flown is not None:
            self._flown.advance(motion)

    def set_wind(self, wind_mps: Vector) -> None:
        """Take where the wind blows to, x and y [m/s]."""
        if math.isfinite(math.hypot(*wind_mps)):
            self.wind_mps = wind_mps

    def set_uploaded(self, list_id: int) -> None:
        """Take note that the autopilot flies a list."""
        cleared = self._cleared.pop(list_id, None)
        if cleared is None or self.uav is None:
            return
        self._cleared = {one: held for one, held in self._cleared.items() if one > list_id}
        if self.escape is None:
            self._flown = cleared.route(self.uav)

    def set_flown(self, points: FloatArray) -> None:
        """Take note of the list, shape (n, 2) [m], that is flown, however it came to be."""
        if self.uav is not None:
            self._flown = Route(points, self.uav)

    def withdraw(self) -> None:
        """Take note that no list is flown any more: nothing is guarded."""
        self._flown = self.escape = None
        self._cleared.clear()
        self.alert, self.nearest, self.reason = Alert.NONE, NO_APPROACH, ""
        self.refused_id = 0

    @property
    def guarding(self) -> bool:
        """Whether a list is flown: a UAV that is not led is not sent away either."""
        return self._flown is not None

    @property
    def unseen(self) -> bool:
        """Whether one of the aircraft was never seen yet."""
        return self.uav is None or self.helicopter.motion is None

    def _unknown(self, now_s: float) -> str:
        """Return which position is missing or old, empty when both are known."""
        for name, motion in (("helicopter", self.helicopter.motion), ("UAV", self.uav)):
            if motion is None:
                return f"no {name} position"
            age = now_s - motion.time_s
            if age > self.parameters.stale_s:
                return f"{name} position {age:.1f} s old (limit {self.parameters.stale_s:g} s)"
        return "helicopter GPS lost" if self.helicopter.phase is Phase.LOST else ""

    # Gate --------------------------------------------------------------------------------------

    def passes(
        self, points: FloatArray, list_id: int, now_s: float, *, speed_mps: float | None = None
    ) -> bool:
        """Return whether a list, shape (n, 2) [m], may be uploaded; ``reason`` says why not.

        ``speed_mps``: the ground speed it is planned with, None where that is the helicopter's.
        One that is better than what is flown passes even where it breaks the least separation.
        """
        offered = Offered(points, speed_mps)
        refusal = self._refusal(offered, now_s)
        self.counts["refused" if refusal else "passed"] += 1
        if refusal:
            self.reason = refusal
            if not self.parameters.watch_only:
                self.refused_id = list_id
                return False
        elif self.escape is None:
            self.reason = ""
        self.refused_id = 0
        self._cleared[list_id] = offered
        return True

    def _refusal(self, offered: Offered, now_s: float) -> str:
        points = offered.points
        if len(points) == 0:
            return "list without waypoints"
        if not np.isfinite(points).all() or np.abs(points).max() > FARTHEST_M:
            return f"list with a waypoint that is not within {FARTHEST_M:g} m"
        away = "the UAV is being sent away" if self.escape is not None else ""
        if obstacle := away or self._unknown(now_s):
            return f"list refused: {obstacle}"
        assert self.uav is not None
        futures = self.helicopter.futures(now_s, self._times)
        ahead = self._near(offered.route(self.uav), futures, now_s)
        if ahead is NO_APPROACH:
            return ""
        held = self._flown or Route(np.empty((0, 2)), self.uav)
        flown = self._near(held, futures, now_s)
        better = ahead.distance_m > flown.distance_m + BETTER_M
        return "" if better else f"list refused: {ahead}"

    def _near(self, route: Route, futures: list[Future], now_s: float) -> Approach:
        """Return how a route breaks what the gate asks for; ``NO_APPROACH`` where it does not."""
        p = self.parameters
        near = self._apart(self._path(route, now_s, p.horizon_s), futures)
        likely = self._closest(near, p.gate_sigmas, p.horizon_s, only_likely=True)
        any_soon = self._closest(near, p.gate_sigmas, p.possible_horizon_s)
        if any_soon.distance_m < self.thresholds["escape_separation_m"]:
            return min(likely, any_soon, key=_distance)
        return likely if likely.distance_m < p.min_separation_m else NO_APPROACH

    def _path(self, route: Route, now_s: float, horizon_s: float) -> FloatArray:
        """Return where the UAV will be on a route, at the monitor's times from now on.

        It is taken to go to the speed planned for the route, or the helicopter's, as it is led,
        while it is seen to; where it does not, or is sent away, to keep its airspeed.
        """
        uav = self.uav
        assert uav is not None
        led = self.escape is None and abs(self._off_mps) < LED_MPS
        late_s = min(max(now_s - uav.time_s, 0.0), self.parameters.lost_s)
        skipped = round(late_s / STEP_S)
        cruise_mps = self._led_mps(route) if led else None
        return self._follow(uav, route, cruise_mps, horizon_s + skipped * STEP_S)[skipped:]

    def _follow(
        self, uav: Motion, route: Route, cruise_mps: float | None, horizon_s: float
    ) -> FloatArray:
        return follow(
            uav,
            route,
            tuning=self.tuning,
            cruise_mps=cruise_mps,
            wind_mps=self.wind_mps,
            horizon_s=horizon_s,
        )

    def _led_mps(self, route: Route) -> float:
        """Return the speed it is led with; one far from the helicopter's is not believed."""
        cruise, planned = self.helicopter.cruise_mps, route.speed_mps
        if planned is None or abs(planned - cruise) > PLANNED_SHARE * cruise:
            return cruise
        if route is not self._flown:
            return planned
        seen = cruise + self._off_mps
        return min(max(seen, (1.0 - PLANNED_SHARE) * cruise), (1.0 + PLANNED_SHARE) * cruise)

    def _apart(self, path: FloatArray, futures: list[Future]) -> list[Apart]:
        return apart(path, futures, self.parameters.follow_sigma_m)

    def _closest(
        self, near: list[Apart], sigmas: float, horizon_s: float, *, only_likely: bool = False
    ) -> Approach:
        """Return the closest approach to any future, ``sigmas`` standard deviations added."""
        count = round(horizon_s / STEP_S) + 1
        found = NO_APPROACH
        for future, distance, sigma in near:
            if only_likely and not future.likely:
                continue
            least, i = l1_kernels.closest(distance, sigma, sigmas, count)
            if least < found.distance_m:
                found = Approach(least, float(self._times[i]), future.name)
        return found

    # Guard -------------------------------------------------------------------------------------

    def update(self, now_s: float) -> Escape | None:
        """Look at what is flown; return a new escape when the UAV is to be sent away."""
        if self._flown is None or self.uav is None or self.helicopter.motion is None:
            self._set_alert(Alert.NONE)
            return None
        p = self.parameters
        if now_s - self.uav.time_s > p.stale_s:
            return None  # where it is is not known, and nothing would reach it
        futures = self.helicopter.futures(now_s, self._times)
        near = self._apart(self._path(self._flown, now_s, p.alert_horizon_s), futures)
        soon = self._closest(near, -p.guard_sigmas, p.possible_horizon_s)
        later = self._closest(near, p.gate_sigmas, p.escape_horizon_s, only_likely=True)
        self.nearest = self._closest(near, 0.0, p.alert_horizon_s, only_likely=True)
        lost_s = self._lost_for(now_s, self.helicopter.motion)
        if self.escape is not None:
            least_m = min(soon.distance_m, later.distance_m)
            return self._escaping(futures, near, least_m, now_s)
        why = self._conflict(soon, later, now_s)
        if not why and lost_s > p.lost_s:
            why = f"helicopter's position lost for {lost_s:.0f} s"
        if why and not p.watch_only:
            self.reason = f"sent away: {why}"
            return self._send_away(futures, now_s)
        self._tell(now_s)
        return None

    def _conflict(self, soon: Approach, later: Approach, now_s: float) -> str:
        """Return what the UAV is to be sent away for; what is later, once it has lasted."""
        escape_m = self.thresholds["escape_separation_m"]
        if later.distance_m >= escape_m:
            self._conflict_since_s = math.inf
        else:
            self._conflict_since_s = min(self._conflict_since_s, now_s)
        if soon.distance_m < escape_m:
            return str(soon)
        lasting = now_s - self._conflict_since_s >= self.parameters.escape_after_s
        return str(later) if lasting else ""

    def _tell(self, now_s: float) -> None:
        """Set the alert short of an escape: at once when it gets less, after a while when more."""
        p, near = self.parameters, self.nearest.distance_m
        alert = Alert.NONE
        if near < self.thresholds["caution_separation_m"]:
            alert = (
                Alert.WARNING if near < self.thresholds["warning_separation_m"] else Alert.CAUTION
            )
        if ALERTS.index(alert) <= ALERTS.index(self.alert):
            self._near_since_s = math.inf
            self._set_alert(alert)
            return
        self._near_since_s = min(self._near_since_s, now_s)
        if now_s - self._near_since_s >= p.alert_after_s:
            self._set_alert(alert)

    def _lost_for(self, now_s: float, motion: Motion) -> float:
        """Return for how long nothing sure is known of the helicopter [s].

        What is told of it while its GPS is lost is only extrapolated.
        """
        if self.helicopter.phase is not Phase.LOST:
            self._sure_s = motion.time_s
        return now_s - self._sure_s

    def _set_alert(self, alert: Alert) -> None:
        if alert is not self.alert:
            self.counts[alert] += 1
        self.alert = alert

    def _escaping(
        self, futures: list[Future], near: list[Apart], least_m: float, now_s: float
    ) -> Escape | None:
        """Hand back when all has been well for a while; else see whether another way is better.

        ``near``, ``least_m``: how far apart the way being flown keeps the two, and at least soon.
        """
        p = self.parameters
        known = not self._unknown(now_s)
        if known and least_m >= p.min_separation_m:
            self._clear_since_s = min(self._clear_since_s, now_s)
            if now_s - self._clear_since_s >= p.clear_s:
                self.escape, self.reason = None, ""
                self._set_alert(Alert.NONE)
            return None
        self._clear_since_s = math.inf
        if now_s - self._chosen_s < RECHOOSE_S or not known:
            return None
        self._chosen_s = now_s
        held = self._worth(near).value_m
        best, value_m = self._best_way(futures, now_s)
        return self._take(best) if value_m > held + BETTER_WAY_M else None

    def _send_away(self, futures: list[Future], now_s: float) -> Escape:
        self._set_alert(Alert.ESCAPE)
        self._chosen_s = now_s
        self._clear_since_s = math.inf
        return self._take(self._best_way(futures, now_s)[0])

    def _take(self, escape: Escape) -> Escape:
        assert self.uav is not None
        self.escape = escape
        self._cleared.clear()
        self._flown = Route(escape.points, self.uav)
        return escape

    def _worth(self, near: list[Apart]) -> Worth:
        """Return what a path is worth; where the helicopter is lost all that is possible lasts."""
        p = self.parameters
        lost = self.helicopter.phase is Phase.LOST
        return worth(near, p.guard_sigmas, p.alert_horizon_s if lost else p.escape_horizon_s)

    def _best_way(self, futures: list[Future], now_s: float) -> tuple[Escape, float]:
        """Return the escape that is worth most, at this height or climbing, and its worth [m]."""
        assert self._flown is not None
        p = self.parameters
        delay_s = STEP_S * round(p.escape_delay_s / STEP_S)
        flown = self._path(self._flown, now_s, delay_s + STEP_S)
        here = motion_at_end(flown, now_s + delay_s)
        found = []
        for end in ends(here, p.escape_reach_m):
            away = self._follow(here, Route(end, here), None, p.alert_horizon_s - delay_s)
            near = self._apart(np.vstack((flown[:-2], away)), futures)
            found.append((self._worth(near), near, end))
        best, near, end = max(found, key=lambda way: way[0].value_m)
        climb = climb_m(near, self.above_m, p.escape_climb_m)
        return Escape(now_s, end, climb, best.least_m), best.value_m
