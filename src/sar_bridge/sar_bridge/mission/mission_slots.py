"""Lists that replace one another in flight without the autopilot ever showing half of one.

ArduPilot writes an uploaded item at once into the mission it is flying. The mission is therefore
kept in *slots*: one is flown, a new list is written into one that nothing leads to (a partial
upload), and the UAV is then led over to it. Where the new list goes on from the waypoint being
flown to, a single jump behind that one does it, and the leg being flown stays as it is.

Elsewhere an item has to be made current. ArduPlane begins that leg at the old target, or where the
UAV is, and on the leg behind it only heads for the end instead of tracking the line: among the
close waypoints of a turn that swings the UAV tens of metres aside. So what is made current are
*capture waypoints*: two waypoints so easily accepted that both are reached at once, wherever the
UAV is, and a jump. The second stands where the leg of the list begins that the UAV is abeam of:
that leg is tracked from there, like any other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.arduplane.l1_predictor import FollowerTuning
from sar_bridge.arduplane.list_entry import Entry, entry_of
from sar_bridge.mavlink.mission_items import (
    FloatArray,
    MissionItem,
    reached_at_once,
    waypoint_items,
)
from sar_bridge.mission.transition_check import WORTH_M, Track
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.states import Motion

SLOTS = 3
SLOT_ITEMS = 64
SLOT_STEP_ITEMS = 16
MOST_SLOT_ITEMS = 224  # what every board that flies ArduPlane holds: some 700 items
NEAR_M = 25.0
GAP_M = 10.0
AHEAD_M = 10.0
FARTHEST_M = 120.0
ASIDE_M = 40.0
SHARPEST = math.cos(math.radians(75.0))
FOREVER = -1.0
CAPTURE_ITEMS = 3


@dataclass(frozen=True, slots=True)
class Write:
    """Items to put at ``start`` and after it."""

    start: int
    items: tuple[MissionItem, ...]


@dataclass(frozen=True, slots=True)
class CaptureWaypoints(Write):
    """To be put at ``start``, then made current: the leg being flown is given up."""


def jump_to(seq: int) -> MissionItem:
    """Return the item that leads to another, always."""
    params = (float(seq), FOREVER, 0.0, 0.0)
    return MissionItem(
        mavlink.MAV_CMD_DO_JUMP, 0, 0, 0.0, frame=mavlink.MAV_FRAME_MISSION, params=params
    )


@dataclass(frozen=True, slots=True)
class _Lead:
    """A jump behind item ``kept`` to point ``joined`` of a list.

    ``through``: the points flown to before, from the leg that begins at ``begin`` on.
    """

    kept: int
    joined: int
    through: list[FloatArray]
    begin: tuple[float, float]


NOWHERE: tuple[int, FloatArray] = (0, np.zeros(2))


class MissionSlots:
    """What the autopilot's mission holds, and where the next list goes. Item 0 is home."""

    def __init__(self, *, altitude_m: float) -> None:
        """Nothing is held yet."""
        self._altitude_m = altitude_m
        self._points: list[FloatArray] = [np.empty((0, 2))] * SLOTS
        self._altitudes_m = [altitude_m] * SLOTS
        self._size = SLOT_ITEMS
        self._led_to: int | None = None
        self._filled = 0
        self._jump_at: int | None = None
        self._entered = NOWHERE

    def _begin(self, slot: int) -> int:
        return 1 + slot * self._size

    def slot_of(self, seq: int) -> int:
        """Return the slot that an item is in."""
        return (max(seq, 1) - 1) // self._size

    def takes(self, points: FloatArray) -> bool:
        """Whether a list goes into a slot of what is held; else it takes a whole mission."""
        return self._led_to is not None and _needed(points) <= self._size

    def whole(self, points: FloatArray, datum: Datum, *, climb_m: float = 0.0) -> list[MissionItem]:
        """Return a whole mission with a list, shape (n, 2) [m], in its first slot.

        The slots are as large as it needs; one longer than any slot is a mission of its own.
        """
        altitude = self._altitude_m + climb_m
        items = waypoint_items(points, datum, altitude)
        self._points = [np.empty((0, 2))] * SLOTS
        self._points[0], self._altitudes_m[0] = points, altitude
        self._filled, self._jump_at, self._entered = 0, None, NOWHERE
        steps = -(-_needed(points) // SLOT_STEP_ITEMS)
        self._size = max(SLOT_ITEMS, steps * SLOT_STEP_ITEMS)
        self._led_to = 0 if self._size <= MOST_SLOT_ITEMS else None
        if self._led_to is None:
            return items
        spare = 1 + SLOTS * self._size - len(items)
        return [*items, *([items[-1]] * spare)]

    def forget(self) -> None:
        """Count on nothing: what the autopilot holds is not known any more."""
        self._led_to = self._jump_at = None

    def fill(
        self, points: FloatArray, datum: Datum, current: int, *, climb_m: float = 0.0
    ) -> Write:
        """Return what writes a list into a slot that neither is flown nor led to."""
        taken = {self.slot_of(current), self._led_to}
        self._filled = next(slot for slot in range(SLOTS) if slot not in taken)
        altitude = self._altitude_m + climb_m
        self._points[self._filled], self._altitudes_m[self._filled] = points, altitude
        if self.slot_of(self._entered[0]) == self._filled:
            self._entered = NOWHERE
        items = waypoint_items(points, datum, altitude)
        return Write(self._begin(self._filled), tuple(items[1:]))

    def _point(self, seq: int) -> FloatArray | None:
        """Return the waypoint an item stands for; None for a loiter, a jump and what is unknown."""
        if seq < 1 or (self._jump_at is not None and seq == self._jump_at):
            return None
        slot = self.slot_of(seq)
        at = seq - self._begin(slot)
        if slot >= SLOTS or at >= len(self._points[slot]):
            return None
        return self._points[slot][at]

    def join(
        self,
        current: int,
        uav: Motion,
        datum: Datum,
        *,
        within_s: float,
        tuning: FollowerTuning,
    ) -> Write:
        """Return what leads over to the list written last, the UAV flying to item ``current``.

        ``within_s``: how long it may take until that is in its place. ``tuning``: the autopilot's
        lateral guidance.
        """
        points, begin = self._points[self._filled], self._begin(self._filled)
        entry = entry_of(points, uav.after(within_s))
        lead = self._lead(current, uav, within_s)
        if lead is not None:
            away_m = math.dist(_place(lead.through[-1]), (uav.x_m, uav.y_m))
            track = Track(points[entry.at :], entry.begin, uav, tuning, until_m=away_m)
            legs = np.vstack((*lead.through, points[lead.joined :]))
            if track.apart_m(legs, lead.begin) > WORTH_M:
                lead = None
        if lead is None:
            return self._capture(self._filled, entry, uav, datum)
        self._led_to, self._jump_at = self._filled, lead.kept + 1
        self._entered = (begin + lead.joined, lead.through[-1])
        return Write(lead.kept + 1, (jump_to(begin + lead.joined),))

    def _capture(self, slot: int, entry: Entry, uav: Motion, datum: Datum) -> CaptureWaypoints:
        """Return what leads over to a list, given up the leg being flown."""
        self._led_to, self._jump_at = slot, None
        seq = self._begin(slot) + entry.at
        self._entered = (seq, np.array(entry.begin))
        start = self._begin(slot + 1) - CAPTURE_ITEMS
        places = np.array(((uav.x_m, uav.y_m), entry.begin))
        altitude = self._altitudes_m[slot]
        return CaptureWaypoints(start, (*reached_at_once(places, datum, altitude), jump_to(seq)))

    def _lead(self, current: int, uav: Motion, within_s: float) -> _Lead | None:
        """Return how a jump leads over to the list written last; None where it cannot."""
        points = self._points[self._filled]
        here = np.array((uav.x_m, uav.y_m))
        through: list[FloatArray] = []
        for kept in (current, current + 1):
            target = self._point(kept)
            same_slot = self.slot_of(kept + 1) == self.slot_of(current)
            if target is None or not same_slot:
                return None
            through.append(target)
            if math.hypot(*(target - here)) < within_s * uav.speed_mps:
                continue
            passing = target + self._beside(current, target, here)
            course = target - self._leg_begin(kept, here)
            joined = _joined(np.vstack((here, points)), target, passing, course)
            if joined is None:
                return None
            return _Lead(kept, joined, through, _place(self._leg_begin(current, here)))
        return None

    def _leg_begin(self, seq: int, here: FloatArray) -> FloatArray:
        """Return where the leg to an item begins; here where that is not known."""
        if seq == self._entered[0]:
            return self._entered[1]
        before = self._point(seq - 1)
        return here if before is None else before

    def _beside(self, current: int, target: FloatArray, here: FloatArray) -> FloatArray:
        """Return how far beside a waypoint the UAV will pass it: as far as beside its leg now."""
        end = self._point(current)
        if end is None or not (way := end - self._leg_begin(current, here)).any():
            return np.zeros_like(target)
        across = _across(way)
        beside: FloatArray = float((here - end) @ across) * across
        return beside

    def missed(
        self, current: int, uav: Motion, datum: Datum, *, within_s: float
    ) -> CaptureWaypoints | None:
        """Return what leads over after all where the UAV was past the jump before it was there."""
        at = self._jump_at
        if at is None or self._led_to is None or not at <= current:
            return None
        if self.slot_of(current) != self.slot_of(at):
            return None
        entry = entry_of(self._points[self._led_to], uav.after(within_s))
        return self._capture(self._led_to, entry, uav, datum)


def _needed(points: FloatArray) -> int:
    """Return how many items a list takes in its slot, with its loiter and capture waypoints."""
    return len(points) + 1 + CAPTURE_ITEMS


def _place(point: FloatArray) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def _across(way: FloatArray) -> FloatArray:
    """Return the unit vector to the left of a way, shape (2,)."""
    across: FloatArray = np.array((-way[1], way[0])) / max(math.hypot(*way), 1e-9)
    return across


def _joined(
    line: FloatArray,
    target: FloatArray,
    passing: FloatArray,
    course: FloatArray,
) -> int | None:
    """Return which point of a list, behind the UAV's position in ``line``, comes after ``target``.

    None where the list does not lead past it, or elsewhere before that. ``passing``: where the UAV
    will be when it passes the target, ``course``: a vector along its way there. A point whose leg
    from the target would be over by then is left out: ArduPlane would begin that leg where the UAV
    is, and turn back for the point. So is one that lies too far aside.
    """
    begin, way = line[:-1], np.diff(line, axis=0)
    lengths = np.maximum(np.hypot(way[:, 0], way[:, 1]), 1e-9)
    share = np.clip(((target - begin) * way).sum(axis=1) / lengths**2, 0.0, 1.0)
    off = np.hypot(*(begin + share[:, None] * way - target).T)
    stations = np.concatenate(([0.0], np.cumsum(lengths)))
    # The first place that is near: a list may come back to where it has been.
    near = np.flatnonzero(off <= NEAR_M)
    if near.size == 0:
        return None
    leg = int(near[0])
    while leg + 1 < len(off) and off[leg + 1] < off[leg]:
        leg += 1
    at = stations[leg] + share[leg] * lengths[leg]
    before = line[1:][stations[1:] < at]
    if (np.abs((before - line[0]) @ _across(target - line[0])) > ASIDE_M).any():
        return None
    legs = line[1:] - target
    left_m = ((line[1:] - passing) * legs).sum(axis=1) / np.maximum(np.hypot(*legs.T), 1e-9)
    onward = legs @ course >= SHARPEST * np.hypot(*legs.T) * np.hypot(*course)
    after = np.flatnonzero((stations[1:] > at + GAP_M) & (left_m > AHEAD_M) & onward)
    if after.size == 0 or stations[1 + after[0]] > at + FARTHEST_M:
        return None
    return int(after[0])
