"""The simulated world: a helicopter (flown or recorded), its GPS receiver, and the UAVs."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace

import numpy as np

from sar_estimator.common import topics
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.pose import Pose
from sar_estimator.common.reports import UavReport
from sar_sim.autopilot.autopilot import SimAutopilot
from sar_sim.autopilot.wind import Gusts
from sar_sim.scenario.faults import clock_error_s
from sar_sim.scenario.formation import Member
from sar_sim.scenario.scenario import Scenario
from sar_sim.world.detour import detoured
from sar_sim.world.faulty_receiver import FaultyReceiver
from sar_sim.world.gps import FixSource, NoReceiver, Reception, RecordedTrack, SimulatedGps
from sar_sim.world.helicopter import CornerTruth, Helicopter
from sar_sim.world.human_helicopter import flown_by

STEP_S = 0.1


class World:
    """Advances in steps of ``STEP_S``; time counts from 0, at ``epoch_s`` of the ROS clock.

    ``helicopter`` is None where a recorded track is played. ``autopilots``: of the UAVs, by name.
    """

    def __init__(
        self,
        scenario: Scenario,
        track: list[Fix] | None = None,
        *,
        live: tuple[Datum, Pose] | None = None,
    ) -> None:
        """Set the world up.

        A ``track`` takes the place of the simulated helicopter. With ``live``, the map's origin and
        the present pose of a real helicopter, there are only the UAVs, and no end.
        """
        self.scenario = scenario
        self.datum = scenario.datum
        self.helicopter: Helicopter | None = None
        self.epoch_s = 0.0
        self.source: FixSource
        if live is not None:
            self.datum, leader = live
            self.source, self.end_s = NoReceiver(), math.inf
        elif track is None:
            corner = scenario.corner
            self.helicopter = detoured(
                flown_by(scenario.pilot, scenario.pattern, corner.speed_mps, corner.accel_mps2),
                scenario.finds,
                scenario.pilot,
                speed_mps=corner.speed_mps,
                accel_mps2=corner.accel_mps2,
            )
            self.end_s = self.helicopter.end_s
            self.source = SimulatedGps(self.helicopter, scenario.gps, self.datum)
            leader = self.helicopter.start
        else:
            good = [fix for fix in track if fix.has_fix and math.isfinite(fix.time_s)]
            if len(good) < 2:
                raise ValueError("helicopter track: expected at least two fixes")
            self.datum = Datum(good[0].latitude_deg, good[0].longitude_deg, good[0].altitude_m)
            recorded = RecordedTrack(good)
            self.source, self.epoch_s, self.end_s = recorded, recorded.start_s, recorded.end_s
            leader = _first_heading(good, self.datum)
        if any(fault.component == "gps" for fault in scenario.faults):
            self.source = FaultyReceiver(self.source, scenario.faults, scenario.gps.seed)
        self.autopilots = {
            member.name: self._autopilot_of(i, member, leader)
            for i, member in enumerate(scenario.formation)
        }
        self._gusts = Gusts(scenario.wind)
        self._steps = 0
        self._extra = [
            np.random.default_rng(scenario.uav.seed + i) for i in range(len(self.autopilots))
        ]
        self._to_come = deque(self.corners)

    def _autopilot_of(self, number: int, member: Member, leader: Pose) -> SimAutopilot:
        """Return a UAV's autopilot, where it starts beside the helicopter, in its own layer."""
        scenario = self.scenario
        across_m = member.slot.across_on(scenario.pattern.terms, 0) * scenario.corner.spacing_m
        lag_m = scenario.uav.lag_m if member.lag_m is None else member.lag_m
        return SimAutopilot(
            leader.offset(-lag_m, -across_m),
            speed_mps=scenario.corner.speed_mps,
            uav=scenario.uav,
            wind=scenario.wind,
            datum=self.datum,
            altitude_m=scenario.altitude_m(number),
        )

    @property
    def autopilot(self) -> SimAutopilot:
        """The first UAV's."""
        return next(iter(self.autopilots.values()))

    @property
    def time_s(self) -> float:
        """Time since the start [s]."""
        return self._steps * STEP_S

    @property
    def true_s(self) -> float:
        """The time that a clock without faults shows [s]."""
        return self.epoch_s + self.time_s

    @property
    def ros_s(self) -> float:
        """The time that the laptop's clock shows, and the ROS clock with it [s]."""
        return self.true_s + self._clock_error_s

    @property
    def _clock_error_s(self) -> float:
        return clock_error_s(self.scenario.faults, self.time_s)

    @property
    def finished(self) -> bool:
        """Whether the helicopter's flight is over."""
        return self.time_s >= self.end_s

    @property
    def corners(self) -> list[CornerTruth]:
        """The corners as flown; none on a recorded track."""
        return [] if self.helicopter is None else self.helicopter.corners

    def step(self) -> list[Reception]:
        """Advance by one step; return what the receiver gave, stamped with the ROS clock."""
        self._steps += 1
        time_s = self.time_s
        if self._to_come and self._to_come[0].onset_time_s <= time_s:
            self._to_come.popleft()
            for rng, autopilot in zip(self._extra, self.autopilots.values(), strict=True):
                self._disturb(rng, autopilot)
        wind_mps = self._gusts.step(STEP_S)
        for autopilot in self.autopilots.values():
            autopilot.wind_mps = wind_mps
            autopilot.step(STEP_S)
        return [self._stamped(item) for item in self.source.due(time_s)]

    def _disturb(self, rng: np.random.Generator, autopilot: SimAutopilot) -> None:
        """Have a UAV fly a corner worse than it should, as the scenario says."""
        uav = self.scenario.uav
        autopilot.owe(float(rng.uniform(uav.extra_path_min_m, uav.extra_path_max_m)))
        if uav.widest_radius_m > uav.min_radius_m:
            autopilot.turn_no_tighter(float(rng.uniform(uav.min_radius_m, uav.widest_radius_m)))

    def _stamped(self, item: Reception) -> Reception:
        """Return what the receiver gave with its time by the ROS clock."""
        fix = item.fix
        epoch_s = self.epoch_s if self.helicopter is not None else 0.0
        time_s = fix.time_s + epoch_s + self._clock_error_s
        return item if time_s == fix.time_s else replace(item, fix=replace(fix, time_s=time_s))

    def truth(self, ros_time_s: float, *, uav: bool = True) -> list[tuple[str, UavReport]]:
        """Return the true motions by topic; ``uav``: whether UAVs are flown here."""
        found = []
        for name, autopilot in self.autopilots.items() if uav else ():
            flown = autopilot.motion.stamped(ros_time_s)
            report = UavReport(flown, autopilot.state.heading_rad)
            found.append((topics.of_uav(topics.TRUE_UAV, name), report))
        if self.helicopter is not None:
            motion = self.helicopter.motion(self.time_s).stamped(ros_time_s)
            yaw = self.helicopter.heading_rad(self.time_s)
            found.append((topics.TRUE_HELICOPTER, UavReport(motion, yaw)))
        return found


def _first_heading(fixes: list[Fix], datum: Datum) -> Pose:
    for fix in fixes[1:]:
        x, y, _ = datum.to_local(fix.latitude_deg, fix.longitude_deg)
        if math.hypot(x, y) > 20.0:
            return Pose(0.0, 0.0, math.atan2(y, x))
    return Pose(0.0, 0.0, 0.0)
