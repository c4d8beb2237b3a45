"""Lists that replace one another in flight."""

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.arduplane.l1_predictor import FollowerTuning
from sar_bridge.mavlink.mission_items import WHEREVER_M, waypoint_items
from sar_bridge.mission.mission_slots import (
    CAPTURE_ITEMS,
    MOST_SLOT_ITEMS,
    SLOT_ITEMS,
    SLOT_STEP_ITEMS,
    SLOTS,
    CaptureWaypoints,
    MissionSlots,
    Write,
)
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.states import Motion

DATUM = Datum(37.8, -122.8)
LINE = np.column_stack((np.arange(100.0, 1000.0, 100.0), np.zeros(9)))
HERE = Motion(0.0, 50.0, 0.0, 20.0, 0.0)
TUNING = FollowerTuning()


def led_to(step):
    """Return the item that capture waypoints lead to: two waypoints reached at once, and a jump."""
    *reached, jump = step.items
    assert [item.command for item in reached] == [mavlink.MAV_CMD_NAV_WAYPOINT] * 2
    assert [item.params[1] for item in reached] == [WHEREVER_M] * 2
    assert jump.command == mavlink.MAV_CMD_DO_JUMP
    return jump.params[0]


def begun(points=LINE):
    slots = MissionSlots(altitude_m=150.0)
    return slots, slots.whole(points, DATUM)


def test_whole_mission_has_room_for_three_lists_and_ends_in_loiters():
    slots, items = begun()
    assert len(items) == 1 + SLOTS * SLOT_ITEMS
    assert items[: len(LINE) + 2] == waypoint_items(LINE, DATUM, 150.0)
    assert {item.command for item in items[10:]} == {mavlink.MAV_CMD_NAV_LOITER_UNLIM}
    assert slots.takes(LINE)


def test_nothing_is_written_where_the_autopilot_flies_or_is_led_to():
    slots, _ = begun()
    first = slots.fill(LINE + np.array((0.0, 1.0)), DATUM, 1)
    assert first.start == 1 + SLOT_ITEMS
    assert isinstance(slots.join(1, HERE, DATUM, within_s=1.0, tuning=TUNING), Write)
    second = slots.fill(LINE + np.array((0.0, 2.0)), DATUM, 1)
    assert second.start == 1 + 2 * SLOT_ITEMS
    assert isinstance(slots.join(1, HERE, DATUM, within_s=1.0, tuning=TUNING), Write)
    third = slots.fill(LINE, DATUM, 1)
    assert third.start == 1 + SLOT_ITEMS
    slots.join(1, HERE, DATUM, within_s=1.0, tuning=TUNING)
    assert slots.fill(LINE, DATUM, 1 + SLOT_ITEMS).start == 1


def test_new_list_is_joined_behind_the_waypoint_being_flown_to():
    slots, _ = begun()
    start = slots.fill(LINE + np.array((30.0, 0.5)), DATUM, 1).start
    step = slots.join(1, HERE, DATUM, within_s=1.0, tuning=TUNING)
    assert step.start == 2
    (jump,) = step.items
    assert jump.command == mavlink.MAV_CMD_DO_JUMP
    # 100 is being flown to; the new list's 130 comes after it.
    assert jump.params[:2] == (float(start), -1.0)


def test_a_waypoint_that_is_as_good_as_reached_is_not_counted_on():
    slots, _ = begun()
    start = slots.fill(LINE + np.array((30.0, 0.0)), DATUM, 1).start
    step = slots.join(1, Motion(0.0, 95.0, 0.0, 20.0, 0.0), DATUM, within_s=1.0, tuning=TUNING)
    assert step.start == 3
    assert step.items[0].params[0] == start + 1


def test_list_that_leads_elsewhere_is_made_current():
    slots, _ = begun()
    start = slots.fill(LINE + np.array((0.0, 40.0)), DATUM, 1).start
    step = slots.join(1, HERE, DATUM, within_s=1.0, tuning=TUNING)
    assert isinstance(step, CaptureWaypoints)
    assert led_to(step) == start


def test_jump_that_came_too_late_is_noticed():
    slots, _ = begun()
    start = slots.fill(LINE, DATUM, 1).start
    assert slots.join(1, HERE, DATUM, within_s=1.0, tuning=TUNING).start == 2
    assert slots.missed(1, HERE, DATUM, within_s=0.5) is None
    assert slots.missed(start + 1, HERE, DATUM, within_s=0.5) is None
    beyond = Motion(1.0, 150.0, 0.0, 20.0, 0.0)
    assert led_to(slots.missed(2, beyond, DATUM, within_s=0.5)) == start + 1
    assert slots.missed(2, beyond, DATUM, within_s=0.5) is None


def test_nothing_is_known_of_an_item_outside_the_lists():
    slots, _ = begun()
    slots.fill(LINE, DATUM, 0)
    for current in (0, len(LINE) + 1, SLOT_ITEMS * SLOTS + 50):
        assert isinstance(
            slots.join(current, HERE, DATUM, within_s=0.0, tuning=TUNING), CaptureWaypoints
        )


def test_a_list_that_comes_back_is_joined_where_it_first_passes():
    loop = np.vstack((LINE, LINE[::-1] + np.array((0.0, 5.0))))
    slots, _ = begun()
    start = slots.fill(loop, DATUM, 1).start
    assert slots.join(1, HERE, DATUM, within_s=0.0, tuning=TUNING).items[0].params[0] == start + 1


def row(count):
    return np.column_stack((np.arange(count) * 20.0, np.zeros(count)))


@pytest.mark.parametrize("count", [SLOT_ITEMS - 4, SLOT_ITEMS, 100, MOST_SLOT_ITEMS - 4])
def test_banks_are_as_large_as_the_first_list_needs(count):
    slots, items = begun(row(count))
    size = (len(items) - 1) // SLOTS
    assert len(items) == 1 + SLOTS * size
    assert count + CAPTURE_ITEMS < size <= max(SLOT_ITEMS, count + CAPTURE_ITEMS + SLOT_STEP_ITEMS)
    assert slots.takes(row(size - CAPTURE_ITEMS - 1))
    assert not slots.takes(row(size - CAPTURE_ITEMS))
    assert slots.fill(LINE, DATUM, 1).start == 1 + size
    slots.whole(LINE, DATUM)
    assert not slots.takes(row(SLOT_ITEMS))


def test_a_list_longer_than_any_bank_is_a_mission_of_its_own():
    slots, items = begun(row(MOST_SLOT_ITEMS))
    assert len(items) == MOST_SLOT_ITEMS + 2
    assert not slots.takes(LINE)
    slots.whole(LINE, DATUM)
    assert slots.takes(LINE)
    slots.forget()
    assert not slots.takes(LINE)


def test_a_point_whose_leg_would_be_over_is_not_entered():
    """The list bends to the side on which the UAV passes: ArduPlane would turn back for it."""
    slots, _ = begun()
    bend = np.array([[204.0, 0.0], [206.0, -13.0], [230.0, -60.0], [270.0, -140.0]])
    begin = slots.fill(bend, DATUM, 2).start
    beside = Motion(0.0, 110.0, -20.0, 8.0, 0.0)
    lead = slots._lead(2, beside, 1.0)
    assert (lead.kept, lead.joined) == (2, 2)
    assert led_to(slots.join(2, beside, DATUM, within_s=1.0, tuning=TUNING)) == begin


def test_a_list_that_turns_off_sharply_is_made_current():
    slots, _ = begun()
    aside = np.column_stack((np.full(9, 101.0), np.arange(0.0, 900.0, 100.0)))
    begin = slots.fill(aside, DATUM, 1).start
    step = slots.join(1, Motion(0.0, 40.0, 0.0, 20.0, 0.0), DATUM, within_s=1.0, tuning=TUNING)
    assert isinstance(step, CaptureWaypoints)
    assert led_to(step) == begin


def test_a_leg_entered_by_a_jump_begins_where_it_was_entered_from():
    slots, _ = begun()
    turned = np.column_stack((np.arange(130.0, 1000.0, 100.0), np.linspace(0.0, 80.0, 9)))
    begin = slots.fill(turned, DATUM, 1).start
    slots.join(1, HERE, DATUM, within_s=1.0, tuning=TUNING)
    # 25 m to the left of the leg (100, 0) -> (130, 0): as far beside it the point is passed.
    slots.fill(turned + np.array((30.0, 0.0)), DATUM, begin)
    beside = slots._beside(begin, turned[0], np.array((90.0, 25.0)))
    assert beside == pytest.approx((0.0, 25.0))


def test_a_list_that_bends_before_a_far_waypoint_is_not_joined_behind_it():
    far = np.array([[400.0, 0.0], [500.0, 0.0], [900.0, 0.0]])
    slots, _ = begun(far)
    weave = np.array([[100.0, 0.0], [160.0, 20.0], [220.0, 40.0], [300.0, 15.0], [420.0, 0.0]])
    begin = slots.fill(np.vstack((weave, far[1:] + 50.0)), DATUM, 1).start
    step = slots.join(1, HERE, DATUM, within_s=1.0, tuning=TUNING)
    assert isinstance(step, CaptureWaypoints)
    assert led_to(step) == begin


def test_a_run_in_stands_behind_the_list_it_leads_to_and_begins_its_leg_where_the_list_does():
    slots, _ = begun()
    aside = LINE + np.array((-70.0, 40.0))
    start = slots.fill(aside, DATUM, 1).start
    step = slots.join(1, HERE, DATUM, within_s=1.0, tuning=TUNING)
    # In a second the UAV is at 70, beyond the first point, 30.
    assert led_to(step) == start + 1
    assert step.start == start + SLOT_ITEMS - CAPTURE_ITEMS
    begin = step.items[1]
    x, y, _ = DATUM.to_local(begin.latitude_e7 / 1e7, begin.longitude_e7 / 1e7)
    assert (x, y) == pytest.approx((30.0, 40.0), abs=0.1)


def test_a_run_in_is_flown_at_the_height_of_its_list():
    slots, _ = begun()
    slots.fill(LINE + np.array((0.0, 40.0)), DATUM, 1, climb_m=60.0)
    step = slots.join(1, HERE, DATUM, within_s=1.0, tuning=TUNING)
    assert [item.altitude_m for item in step.items[:2]] == [210.0, 210.0]
