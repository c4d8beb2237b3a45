"""The figures of merit of one flight."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from sar_estimator.common.checked import read
from sar_estimator.common.pose import Pose
from sar_planner.parameters.mission import MissionParameters
from sar_sim.report.coverage import Coverage, FloatArray, IdealSlot, ideal_tracks, measure
from sar_sim.report.flight_data import FlightData, Track
from sar_sim.scenario.scenario import Sensor
from sar_sim.world.helicopter import CornerTruth

SAMPLE_S = 0.1


def separation(data: FlightData) -> tuple[FloatArray, FloatArray]:
    """Return times [s] and horizontal distances [m] while both aircraft were tracked."""
    return apart_over_time(data.helicopter, data.uav)


def apart_over_time(one: Track, other: Track) -> tuple[FloatArray, FloatArray]:
    """Return times [s] and horizontal distances [m] while two tracks last."""
    first = max(one.times_s[0], other.times_s[0])
    last = min(one.times_s[-1], other.times_s[-1])
    if last <= first:
        return np.empty(0), np.empty(0)
    times = np.arange(first, last, SAMPLE_S)
    gap = one.at(times) - other.at(times)
    return times, np.hypot(gap[:, 0], gap[:, 1])


def least_apart_m(one: Track, other: Track) -> float:
    """Return the least horizontal distance of two tracks [m], infinite where none is common."""
    return float(apart_over_time(one, other)[1].min(initial=math.inf))


def true_lag_m(data: FlightData, corner: CornerTruth) -> float:
    """Return L(k) [m]: the true along-track lag when the helicopter begins to slow."""
    onset = corner.onset
    x, y = data.uav.at(np.array([corner.onset_time_s]))[0]
    return -onset.along(float(x), float(y))


def extra_path_m(data: FlightData, k: int) -> float | None:
    """Return how much farther than planned the UAV flew at corner ``k`` [m].

    From its position when the helicopter began to slow to the finish line across the end of the
    planned path; None when it did not cross it.
    """
    record, path = data.planned[k].last, data.planned[k].curve
    if len(path) < 2:
        return None
    end, before = path[-1], path[-2]
    heading = math.atan2(end[1] - before[1], end[0] - before[0])
    finish = Pose(float(end[0]), float(end[1]), heading)
    onset = record.onset_time_s
    track = data.uav.between(onset, onset + 3.0 * record.length_m / record.speed_mps)
    if len(track) < 2:
        return None
    along = np.array([finish.along(x, y) for x, y in track.xy_m])
    near = np.array([abs(finish.across(x, y)) < 150.0 for x, y in track.xy_m])
    crossed = np.flatnonzero((along[1:] >= 0.0) & (along[:-1] < 0.0) & near[1:])
    crossed = crossed[track.times_s[crossed] - onset > 0.5 * record.length_m / record.speed_mps]
    if crossed.size == 0:
        return None
    last = int(crossed[0])
    share = -along[last] / (along[last + 1] - along[last])
    steps = np.hypot(*np.diff(track.xy_m[: last + 2], axis=0).T)
    steps[-1] *= share
    begun = (track.times_s[0] - onset) * record.speed_mps
    return float(steps.sum() + begun - record.length_m)


def detection_delay_s(data: FlightData, corner: CornerTruth) -> float | None:
    """Return how long after the true onset the corner was first planned [s]."""
    planned = data.planned.get(corner.k)
    if planned is None:
        return None
    return planned.first.estimated_at_s - corner.onset_time_s


def coverage(flights: Sequence[FlightData]) -> Coverage | None:
    """Return the coverage of all UAVs of a flight, of the legs as flown; None without a corner."""
    data = flights[0]
    if data.corners:
        stops = [corner.crossing_m for corner in data.corners]
        left_s = [corner.stop_time_s for corner in data.corners]
    else:
        last = [item.last for _, item in sorted(data.planned.items())]
        stops, left_s = [one.stop[:2] for one in last], [one.stop_time_s for one in last]
    tracks = [one.uav.xy_m for one in flights if len(one.uav) > 1]
    if not stops or len(data.helicopter) < 2 or len(tracks) < len(flights):
        return None
    sensor = read(Sensor, data.scenario.get("sensor", {}), "sensor", texts=True)
    points = np.vstack((data.helicopter.xy_m[0], stops, data.helicopter.xy_m[-1]))
    first_s, *_, last_s = data.helicopter.times_s
    times_s = np.array([first_s, *left_s, last_s])
    return measure(
        data.helicopter.xy_m,
        tracks,
        ideal_tracks(points, [ideal_slot(one, times_s) for one in flights]),
        radius_m=sensor.radius_m,
        footprint=sensor.footprint,
    )


class _Asked(NamedTuple):
    """What a UAV was flown with for a time."""

    mission: MissionParameters
    spacing_m: float

    @classmethod
    def of(cls, record: dict[str, Any]) -> _Asked:
        """Read what was recorded."""
        mission = read(MissionParameters, record["mission"], "mission", texts=True)
        return cls(mission, float(record["corner"]["spacing_m"]))


def ideal_slot(data: FlightData, times_s: FloatArray) -> IdealSlot:
    """Return where a UAV had its place on the legs between some times, shape (legs + 1,) [s].

    On each leg it is the slot that was asked for half-way through it, or first of all. Raises
    ``LookupError`` where none was told.
    """
    begun_s = [time_s for time_s, _ in data.missions]
    missions = [_Asked.of(record) for _, record in data.missions]
    middles = 0.5 * (times_s[1:] + times_s[:-1])
    across = []
    for leg, middle_s in enumerate(middles):
        asked = missions[max(0, bisect_right(begun_s, middle_s) - 1)]
        across.append(asked.spacing_m * asked.mission.slot.across_on(asked.mission.terms, leg))
    return IdealSlot(across)


def formation_metrics(flights: Sequence[FlightData], area: Coverage | None) -> dict[str, Any]:
    """Return ``flight_metrics`` of the first UAV, and of every one by name in ``uavs``.

    ``uavs_apart_m``: the least horizontal distance of two UAVs [m], None for one alone.
    """
    apart = [least_apart_m(one.uav, other.uav) for one, other in combinations(flights, 2)]
    return {
        **flight_metrics(flights[0], area),
        "uavs": {one.name: flight_metrics(one, area) for one in flights if one.name},
        "uavs_apart_m": min(apart, default=None),
    }


def flight_metrics(data: FlightData, area: Coverage | None) -> dict[str, Any]:
    """Return everything that goes into ``metrics.json``; lists are by corner, from k = 1."""
    times, distances = separation(data)
    planned = [data.planned[k] for k in sorted(data.planned)]
    truths = {corner.k: corner for corner in data.corners}
    errors, first_errors = [], []
    for k in sorted(data.planned):
        item = data.planned[k]
        if k in truths:
            stop = truths[k].stop
            errors.append(math.dist(item.last.stop[:2], stop[:2]))
            first_errors.append(math.dist(item.first.stop[:2], stop[:2]))
    measured = [item.last.lag_m for item in planned]
    lags = [true_lag_m(data, corner) for corner in data.corners] if data.corners else measured
    best = int(distances.argmin()) if distances.size else None
    return {
        "simulated": data.simulated,
        "duration_s": float(data.helicopter.times_s[-1] - data.helicopter.times_s[0]),
        "corners": len(truths) if data.simulated else len(planned),
        "lag_m": lags,
        "lag_measured_m": measured,
        "rules": [item.last.rule for item in planned],
        "next_lag_predicted_m": [item.last.next_lag_m for item in planned],
        "extra_path_m": [extra_path_m(data, k) for k in sorted(data.planned)],
        "min_separation_m": None if best is None else float(distances[best]),
        "min_separation_s": None if best is None else float(times[best] - times[0]),
        "coverage_percent": None if area is None else area.percent,
        "coverage_of_flown_percent": None if area is None else area.reached_percent,
        "overlap_percent": None if area is None else area.overlap_percent,
        "claimed_km2": None if area is None else area.claimed_m2 / 1e6,
        "detection_delay_s": [detection_delay_s(data, corner) for corner in data.corners],
        "monitor": {
            "thresholds": dict(data.monitor.thresholds),
            "counts": dict(data.monitor.counts),
        },
        "corner_error_m": errors,
        "first_corner_error_m": first_errors,
    }
