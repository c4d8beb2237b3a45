"""Where the other UAVs of the formation will be: on their lists, or straight on."""

from __future__ import annotations

import numpy as np

from sar_bridge.arduplane import l1_kernels
from sar_bridge.arduplane.l1_predictor import STEP_S, FollowerTuning, Route, Vector, follow
from sar_bridge.monitor.helicopter_hypotheses import Future
from sar_estimator.common.other_uavs import OtherUav, OtherUavs
from sar_estimator.common.reports import WaypointList
from sar_estimator.common.states import FloatArray


class OtherFutures:
    """Predicts other UAVs as one's own is predicted. ``told``: what is told of them.

    ``layer_m``: in altitude, by which those that are farther apart need nothing else.
    """

    def __init__(self, told: OtherUavs, *, layer_m: float, stale_s: float) -> None:
        """Know what ``told`` knows."""
        self.told = told
        self._layer_m, self._stale_s = layer_m, stale_s
        self._routes: dict[str, tuple[int, Route]] = {}

    def futures(
        self, now_s: float, times: FloatArray, altitude_m: float, wind_mps: Vector
    ) -> list[Future]:
        """Return a future for each that altitude does not keep apart, at times from now on [s].

        ``altitude_m``: one's own, NaN for unknown.
        """
        near = self.told.near(now_s, altitude_m, layer_m=self._layer_m, stale_s=self._stale_s)
        return [self._future(one, now_s, times, wind_mps) for one in near]

    def _future(self, one: OtherUav, now_s: float, times: FloatArray, wind_mps: Vector) -> Future:
        motion = one.motion
        if one.flown is None:
            here = motion.after(now_s - motion.time_s)
            places = l1_kernels.straight_on(times, here.x_m, here.y_m, motion.vx_mps, motion.vy_mps)
        else:
            skipped = round(max(now_s - motion.time_s, 0.0) / STEP_S)
            places = follow(
                motion,
                self._route(one, one.flown),
                tuning=FollowerTuning(),
                cruise_mps=motion.speed_mps,
                wind_mps=wind_mps,
                horizon_s=float(times[-1]) + skipped * STEP_S,
            )[skipped:]
        return Future(
            "flies on",
            places,
            np.zeros(len(times)),
            likely=True,
            who=one.name,
            most_mps2=FollowerTuning().most_mps2(wind_mps),
        )

    def _route(self, one: OtherUav, flown: WaypointList) -> Route:
        """Return the list that another flies as far as it has flown it."""
        known = self._routes.get(one.name)
        if known is None or known[0] != flown.list_id:
            known = flown.list_id, Route(flown.points, one.motion)
            self._routes[one.name] = known
        known[1].advance(one.motion)
        return known[1]
