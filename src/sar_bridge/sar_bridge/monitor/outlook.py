"""What the monitor knows of both aircraft, and what it predicts of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sar_bridge.arduplane import l1_kernels
from sar_bridge.arduplane.l1_predictor import STEP_S, FollowerTuning, Route, Vector, follow
from sar_bridge.monitor.escapes import Apart, apart
from sar_bridge.monitor.helicopter_hypotheses import Future, Helicopter
from sar_bridge.monitor.helicopter_model import HelicopterModel
from sar_bridge.monitor.other_futures import OtherFutures
from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common.lateness import Punctuality, counted_s
from sar_estimator.common.other_uavs import OtherUavs
from sar_estimator.common.states import FloatArray, Motion, Phase

PLANNED_SHARE = 0.4  # of the helicopter's speed, within which a list's own is believed


@dataclass(frozen=True, slots=True)
class ClosestApproach:
    """A closest approach in prediction: distance [m], in how long [s], and what would lead to it.

    Distances are bounds: the doubt is taken off, or added, already.
    """

    distance_m: float
    in_s: float
    future: str

    def __str__(self) -> str:
        """Say it."""
        return f"{self.distance_m:.0f} m in {self.in_s:.0f} s if {self.future}"


NO_APPROACH = ClosestApproach(math.inf, 0.0, "")


class Outlook:
    """Both aircraft as they were told of last, and where they may be.

    ``tuning``: of the autopilot's guidance. ``above_m``: the UAV's height above the helicopter,
    ``altitude_m``: its altitude, NaN where they are not known. ``others``: the other UAVs.
    ``timing``: how old fixes are when they are looked at, and how long lists take from here to the
    autopilot.
    """

    def __init__(
        self, parameters: MonitorParameters, model: HelicopterModel, others: OtherUavs | None = None
    ) -> None:
        """Know nothing yet."""
        self.others = OtherFutures(
            others or OtherUavs(()),
            layer_m=parameters.layer_separation_m,
            stale_s=parameters.lost_s,
        )
        self.timing = Punctuality()
        self.altitude_m = math.nan
        self.helicopter = Helicopter(model)
        self.tuning = FollowerTuning()
        self.uav: Motion | None = None
        self.wind_mps: Vector = (0.0, 0.0)
        self.above_m = math.nan
        self._p = parameters
        count = round(parameters.horizon_s / STEP_S) + 1
        self._times: FloatArray = STEP_S * np.arange(count, dtype=np.float64)
        self._off_mps = 0.0

    @property
    def known_above_m(self) -> float:
        """The UAV's height above the helicopter; the same altitude where it is not known."""
        return 0.0 if math.isnan(self.above_m) else self.above_m

    def set_uav(self, motion: Motion) -> None:
        """Take the UAV's newest motion."""
        if self.uav is not None and motion.time_s > self.uav.time_s:
            share = -math.expm1((self.uav.time_s - motion.time_s) / self._p.matched_s)
            cruise = self.helicopter.cruise_mps
            beside = self.tuning.made_good_mps(motion.course_rad, cruise, self.wind_mps)
            off = motion.speed_mps - beside
            self._off_mps += share * (off - self._off_mps)
        self.uav = motion

    def set_wind(self, wind_mps: Vector) -> None:
        """Take where the wind blows to, x and y [m/s]."""
        if math.isfinite(math.hypot(*wind_mps)):
            self.wind_mps = wind_mps

    @property
    def unseen(self) -> bool:
        """Whether one of the aircraft was never seen yet."""
        return self.uav is None or self.helicopter.motion is None

    def unknown(self, now_s: float) -> str:
        """Return which position is missing or old, empty when both are known."""
        for name, motion in (("helicopter", self.helicopter.motion), ("UAV", self.uav)):
            if motion is None:
                return f"no {name} position"
            age = now_s - motion.time_s
            if age > self._p.stale_s:
                return f"{name} position {age:.1f} s old (limit {self._p.stale_s:g} s)"
        return "helicopter GPS lost" if self.helicopter.phase is Phase.LOST else ""

    def delay_s(self, now_s: float) -> float:
        """Return in how long [s] the UAV flies what is sent to it now, a multiple of ``STEP_S``."""
        p = self._p
        late_s, most_s = self.timing.lists.value_s(now_s), min(p.most_delay_s, p.escape_horizon_s)
        return STEP_S * round(counted_s(late_s, p.escape_delay_s, most_s) / STEP_S)

    def late_s(self, now_s: float) -> float:
        """Return by how much that is longer than ``escape_delay_s`` [s]."""
        return self.delay_s(now_s) - STEP_S * round(self._p.escape_delay_s / STEP_S)

    def futures(self, now_s: float) -> list[Future]:
        """Return where helicopter and other UAVs may be, every ``STEP_S`` from now on."""
        others = self.others.futures(now_s, self._times, self.altitude_m, self.wind_mps)
        return self.helicopter.futures(now_s, self._times) + self._unseen(now_s) + others

    def _unseen(self, now_s: float) -> list[Future]:
        """Return what the helicopter may have begun since its newest fix, where fixes come late.

        One whose GPS is lost has such futures already.
        """
        since_s = min(self.timing.fixes.value_s(now_s), self._p.most_delay_s)
        if since_s < self._p.late_fix_s or self.helicopter.phase is Phase.LOST:
            return []
        found = self.helicopter.futures(now_s - since_s, self._times + since_s)
        return [one._replace(name=f"{one.name} unseen", likely=False) for one in found]

    def path(
        self,
        route: Route,
        now_s: float,
        horizon_s: float,
        *,
        is_flown: bool,
        escaping: bool,
        uav: Motion | None = None,
    ) -> FloatArray:
        """Return where the UAV will be on a route, every ``STEP_S`` from now on, shape (n, 2).

        It is taken to go to the speed planned for the route, or the helicopter's, as it is led,
        while it is seen to; where it does not, or is sent away, to keep its airspeed. ``uav``: from
        another motion than its newest, from that one's time on.
        """
        uav = uav or self.uav
        assert uav is not None
        matched = not escaping and abs(self._off_mps) < self._p.matched_mps
        late_s = min(max(now_s - uav.time_s, 0.0), self._p.lost_s)
        skipped = round(late_s / STEP_S)
        cruise_mps = self._matched_mps(route, is_flown=is_flown) if matched else None
        return self.follow(uav, route, cruise_mps, horizon_s + skipped * STEP_S)[skipped:]

    def follow(
        self, uav: Motion, route: Route, cruise_mps: float | None, horizon_s: float
    ) -> FloatArray:
        """Return where a UAV will be that follows a route from a motion."""
        return follow(
            uav,
            route,
            tuning=self.tuning,
            cruise_mps=cruise_mps,
            wind_mps=self.wind_mps,
            horizon_s=horizon_s,
        )

    def _matched_mps(self, route: Route, *, is_flown: bool) -> float:
        """Return the speed it is led with; one far from the helicopter's is not believed."""
        cruise, planned = self.helicopter.cruise_mps, route.speed_mps
        if planned is None or abs(planned - cruise) > PLANNED_SHARE * cruise:
            return cruise
        if not is_flown:
            return planned
        seen = cruise + self._off_mps
        return min(max(seen, (1.0 - PLANNED_SHARE) * cruise), (1.0 + PLANNED_SHARE) * cruise)

    def apart(self, path: FloatArray, futures: list[Future]) -> list[Apart]:
        """Return how near a path comes to every future, from step to step."""
        return apart(path, futures, self._p.follow_sigma_m, self.tuning.most_mps2(self.wind_mps))

    def closest(
        self, near: list[Apart], sigmas: float, horizon_s: float, *, only_likely: bool = False
    ) -> ClosestApproach:
        """Return the closest approach to any future, ``sigmas`` standard deviations added."""
        count = round(horizon_s / STEP_S) + 1
        found = NO_APPROACH
        for future, distance, sigma in near:
            if only_likely and not future.likely:
                continue
            least, i = l1_kernels.closest(distance, sigma, sigmas, count)
            if least < found.distance_m:
                found = ClosestApproach(least, float(self._times[i]), f"{future.who} {future.name}")
        return found
