"""The guard: when a UAV is sent away from the helicopter, which way, and until when."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sar_bridge.arduplane.l1_predictor import STEP_S, Route, motion_at_end
from sar_bridge.monitor.escapes import Apart, Escape, Worth, climb_m, ends, worth
from sar_bridge.monitor.helicopter_hypotheses import Future
from sar_bridge.monitor.outlook import ClosestApproach, Outlook
from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common.states import Phase


@dataclass(frozen=True, slots=True)
class Look:
    """What is predicted of the list that is flown, at a time.

    ``nearest``: the closest approach to what is likely. ``soon``: to anything possible, the doubt
    against it; ``later``: to what is likely, the doubt in its favour. ``near``: all distances.
    ``lost_s``: for how long nothing sure is known of the helicopter. ``escaping``: whether it is a
    way out.
    """

    now_s: float
    route: Route
    futures: list[Future]
    near: list[Apart]
    nearest: ClosestApproach
    soon: ClosestApproach
    later: ClosestApproach
    lost_s: float
    escaping: bool


class Guard:
    """Watches the list that is flown."""

    def __init__(self, parameters: MonitorParameters, outlook: Outlook) -> None:
        """Nothing is wrong yet."""
        self._p, self._outlook = parameters, outlook
        self._escape_m = parameters.thresholds()["escape_separation_m"]
        self._conflict_since_s = self._clear_since_s = self._sure_s = math.inf
        self._chosen_s = -math.inf

    def look(self, route: Route, now_s: float, *, escaping: bool) -> Look:
        """Look at a route that is flown; farther ahead where a way out would be flown late."""
        p, outlook = self._p, self._outlook
        more_s = outlook.late_s(now_s)
        futures = outlook.futures(now_s)
        path = outlook.path(route, now_s, p.alert_horizon_s, is_flown=True, escaping=escaping)
        near = outlook.apart(path, futures)
        return Look(
            now_s,
            route,
            futures,
            near,
            nearest=outlook.closest(near, 0.0, p.alert_horizon_s, only_likely=True),
            soon=outlook.closest(near, -p.guard_sigmas, p.possible_horizon_s + more_s),
            later=outlook.closest(
                near, p.gate_sigmas, p.escape_horizon_s + more_s, only_likely=True
            ),
            lost_s=self._lost_for(now_s),
            escaping=escaping,
        )

    def _lost_for(self, now_s: float) -> float:
        """Return for how long nothing sure is known of the helicopter [s].

        What is told of it while its GPS is lost is only extrapolated.
        """
        helicopter = self._outlook.helicopter
        assert helicopter.motion is not None
        if helicopter.phase is not Phase.LOST:
            self._sure_s = helicopter.motion.time_s
        return now_s - self._sure_s

    def reason(self, look: Look) -> str:
        """Return what the UAV is to be sent away for; what is later, once it has lasted."""
        if look.later.distance_m >= self._escape_m:
            self._conflict_since_s = math.inf
        else:
            self._conflict_since_s = min(self._conflict_since_s, look.now_s)
        if look.soon.distance_m < self._escape_m:
            return str(look.soon)
        if look.now_s - self._conflict_since_s >= self._p.escape_after_s:
            return str(look.later)
        if look.lost_s > self._p.lost_s:
            return f"helicopter's position lost for {look.lost_s:.0f} s"
        return ""

    def way_out(self, look: Look) -> Escape:
        """Return the way by which the UAV is sent away."""
        self._chosen_s = look.now_s
        self._clear_since_s = math.inf
        return self._best_way(look)[0]

    def is_clear(self, look: Look) -> bool:
        """Whether all has been well for long enough to hand back."""
        least_m = min(look.soon.distance_m, look.later.distance_m)
        if self._outlook.unknown(look.now_s) or least_m < self._p.min_separation_m:
            self._clear_since_s = math.inf
            return False
        self._clear_since_s = min(self._clear_since_s, look.now_s)
        return look.now_s - self._clear_since_s >= self._p.clear_s

    def better_way(self, look: Look) -> Escape | None:
        """Return a way out that is clearly worth more than the one being flown, if it is time."""
        waiting = look.now_s - self._chosen_s < self._p.rechoose_s
        if math.isfinite(self._clear_since_s) or waiting or self._outlook.unknown(look.now_s):
            return None
        self._chosen_s = look.now_s
        best, value_m = self._best_way(look)
        return best if value_m > self._worth(look.near).value_m + self._p.better_way_m else None

    def _worth(self, near: list[Apart]) -> Worth:
        """Return what a path is worth; where the helicopter is lost all that is possible lasts."""
        p = self._p
        lost = self._outlook.helicopter.phase is Phase.LOST
        return worth(near, p.guard_sigmas, p.alert_horizon_s if lost else p.escape_horizon_s)

    def _best_way(self, look: Look) -> tuple[Escape, float]:
        """Return the escape that is worth most, at this height or climbing, and its worth [m]."""
        p, outlook = self._p, self._outlook
        delay_s = outlook.delay_s(look.now_s)
        flown = outlook.path(
            look.route, look.now_s, delay_s + STEP_S, is_flown=True, escaping=look.escaping
        )
        here = motion_at_end(flown, look.now_s + delay_s)
        found = []
        for end in ends(here, p.escape_reach_m):
            away = outlook.follow(here, Route(end, here), None, p.alert_horizon_s - delay_s)
            near = outlook.apart(np.vstack((flown[:-2], away)), look.futures)
            found.append((self._worth(near), near, end))
        best, near, end = max(found, key=lambda way: way[0].value_m)
        climb = climb_m(near, outlook.known_above_m, p.escape_climb_m, p.climb_mps)
        return Escape(look.now_s, end, climb, best.least_m), best.value_m
