"""The gate: which waypoint lists may be uploaded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sar_bridge.arduplane.l1_predictor import STEP_S, Route, motion_at_end
from sar_bridge.monitor.escapes import Apart
from sar_bridge.monitor.helicopter_hypotheses import Future
from sar_bridge.monitor.outlook import NO_APPROACH, ClosestApproach, Outlook
from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common.states import FloatArray, Motion

FARTHEST_M = 100_000.0
SAME_M = 1.0  # no nearer, as near as two predictions of one way can be told apart
LESS_SHARE = 0.75  # of what is missing on the list that is flown: clearly less than that


@dataclass(frozen=True, slots=True)
class Offered:
    """A list, shape (n, 2) [m], and the ground speed it is planned with, None for V."""

    points: FloatArray
    speed_mps: float | None

    def route(self, uav: Motion) -> Route:
        """Return it as flown by a UAV from where it is."""
        return Route(self.points, uav, speed_mps=self.speed_mps)


@dataclass(frozen=True, slots=True)
class Judged:
    """How a path breaks what is asked for, the doubt in its favour.

    ``nearest``: its closest approach, ``NO_APPROACH`` where it breaks nothing. ``short_m``: what is
    missing of the least separation, the mean over the horizon [m].
    """

    nearest: ClosestApproach
    short_m: float

    def is_better(self, other: Judged, by_m: float) -> bool:
        """Whether it comes less near by so much, or no nearer and less is missing on the way."""
        farther_m = self.nearest.distance_m - other.nearest.distance_m
        less_short = self.short_m < LESS_SHARE * other.short_m
        return farther_m > by_m or (farther_m >= -SAME_M and less_short)


class Gate:
    """Says why a list may not pass."""

    def __init__(self, parameters: MonitorParameters, outlook: Outlook) -> None:
        """Judge by an outlook."""
        self._p, self._outlook = parameters, outlook
        self._escape_m = parameters.thresholds()["escape_separation_m"]

    def refusal(
        self, offered: Offered, now_s: float, *, flown: Route | None, escaping: bool
    ) -> str:
        """Return why a list may not pass, empty when it may; ``flown``: the list that is.

        One that is better than what is flown passes even where it breaks the least separation: it
        comes less near, or no nearer and less is missing of the least separation on the way.
        """
        points, outlook = offered.points, self._outlook
        if len(points) == 0:
            return "list without waypoints"
        if not np.isfinite(points).all() or np.abs(points).max() > FARTHEST_M:
            return f"list with a waypoint that is not within {FARTHEST_M:g} m"
        away = "the UAV is being sent away" if escaping else ""
        if obstacle := away or outlook.unknown(now_s):
            return f"list refused: {obstacle}"
        assert outlook.uav is not None
        futures = outlook.futures(now_s)
        ahead = self._judged(self._path(offered, now_s, flown), futures)
        if ahead.nearest is NO_APPROACH:
            return ""
        held = flown or Route(np.empty((0, 2)), outlook.uav)
        before = self._judged(self._path_on(held, now_s, is_flown=flown is not None), futures)
        better = ahead.is_better(before, self._p.better_list_m)
        return "" if better else f"list refused: {ahead.nearest}"

    def _path_on(self, route: Route, now_s: float, *, is_flown: bool) -> FloatArray:
        """Return where the UAV will be on a route from now on."""
        horizon_s = self._p.horizon_s
        return self._outlook.path(route, now_s, horizon_s, is_flown=is_flown, escaping=False)

    def _path(self, offered: Offered, now_s: float, flown: Route | None) -> FloatArray:
        """Return where the UAV will be on a list that is offered.

        Where lists come late to the autopilot, it flies on so much longer on the one that it has.
        """
        outlook, late_s = self._outlook, self._outlook.late_s(now_s)
        assert outlook.uav is not None
        if flown is None or late_s < STEP_S:
            return self._path_on(offered.route(outlook.uav), now_s, is_flown=False)
        before = outlook.path(flown, now_s, late_s + STEP_S, is_flown=True, escaping=False)
        here = motion_at_end(before, now_s + late_s)
        after = outlook.path(
            offered.route(here),
            here.time_s,
            max(self._p.horizon_s - late_s, STEP_S),
            is_flown=False,
            escaping=False,
            uav=here,
        )
        return np.vstack((before[:-2], after))

    def _judged(self, path: FloatArray, futures: list[Future]) -> Judged:
        """Return how a path breaks what is asked for."""
        near = self._outlook.apart(path, futures)
        nearest = self._nearest(near)
        return Judged(nearest, 0.0 if nearest is NO_APPROACH else self._short_m(near))

    def _short_m(self, near: list[Apart]) -> float:
        """Return what is missing of the least separation from all that is likely [m], mean."""
        p = self._p
        likely = [one.distance_m + p.gate_sigmas * one.sigma_m for one in near if one.future.likely]
        if not likely:
            return 0.0
        least = np.min(likely, axis=0)
        return float(np.maximum(p.min_separation_m - least, 0.0).mean())

    def _nearest(self, near: list[Apart]) -> ClosestApproach:
        """Return the approach that breaks what is asked for; ``NO_APPROACH`` where none does."""
        p, outlook = self._p, self._outlook
        likely = outlook.closest(near, p.gate_sigmas, p.horizon_s, only_likely=True)
        any_soon = outlook.closest(near, p.gate_sigmas, p.possible_horizon_s)
        if any_soon.distance_m < self._escape_m:
            return min(likely, any_soon, key=lambda one: one.distance_m)
        return likely if likely.distance_m < p.min_separation_m else NO_APPROACH
