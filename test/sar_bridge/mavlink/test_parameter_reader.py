"""Reading the autopilot's parameters."""

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address
from sar_bridge.mavlink.parameter_reader import NAMES, TRIES, ParameterReader

NEWER = {
    "NAVL1_PERIOD": 12.0,
    "NAVL1_DAMPING": 0.75,
    "WP_RADIUS": 50.0,
    "WP_MAX_RADIUS": 0.0,
    "WP_LOITER_RAD": -70.0,
    "ROLL_LIMIT_DEG": 45.0,
    "AIRSPEED_CRUISE": 20.0,
    "AIRSPEED_MIN": 12.0,
    "AIRSPEED_MAX": 28.0,
    "FS_GCS_ENABL": 1.0,
    "FS_LONG_TIMEOUT": 5.0,
    "FS_LONG_ACTN": 1.0,
}
OLDER = {
    **{name: NEWER[name] for name in ("NAVL1_PERIOD", "NAVL1_DAMPING", "WP_RADIUS")},
    **{name: NEWER[name] for name in ("WP_MAX_RADIUS", "WP_LOITER_RAD", "FS_GCS_ENABL")},
    **{name: NEWER[name] for name in ("FS_LONG_TIMEOUT", "FS_LONG_ACTN")},
    "LIM_ROLL_CD": 4500.0,
    "TRIM_ARSPD_CM": 2000.0,
    "ARSPD_FBW_MIN": 12.0,
    "ARSPD_FBW_MAX": 28.0,
}


def answer(reader, held, *, now=0.0):
    for request in reader.tick(now):
        value = held.get(request.param_id.rstrip("\0"))
        if value is not None:
            told = mavlink.MAVLink_param_value_message(
                request.param_id.encode(), value, mavlink.MAV_PARAM_TYPE_REAL32, 900, 1
            )
            reader.handle(told)


@pytest.mark.parametrize("held", [NEWER, OLDER])
def test_newer_and_older_names_give_the_same(held):
    reader = ParameterReader(Address(1, 1))
    answer(reader, held)
    assert reader.values == pytest.approx(NEWER)
    assert reader.done
    assert set(NEWER) == set(NAMES)


def test_what_is_missing_is_asked_for_again_and_given_up():
    reader = ParameterReader(Address(1, 1))
    partly = {name: NEWER[name] for name in ("NAVL1_PERIOD", "ROLL_LIMIT_DEG")}
    asked = 0
    for tick in range(100):
        requests = reader.tick(0.5 * tick)
        asked += bool(requests)
        if requests and tick > 3:
            assert "NAVL1_PERIOD" not in {request.param_id.rstrip("\0") for request in requests}
        answer_all = {r.param_id.rstrip("\0") for r in requests} & set(partly)
        for name in answer_all:
            kind = mavlink.MAV_PARAM_TYPE_REAL32
            reader.handle(
                mavlink.MAVLink_param_value_message(name.encode(), partly[name], kind, 900, 1)
            )
    assert asked == TRIES
    assert reader.done
    assert reader.values == partly


def test_a_changed_parameter_is_noticed_and_reading_begins_again_on_request():
    reader = ParameterReader(Address(1, 1))
    answer(reader, NEWER)
    answer_now = mavlink.MAVLink_param_value_message(
        b"NAVL1_PERIOD", 18.0, mavlink.MAV_PARAM_TYPE_REAL32, 900, 1
    )
    reader.handle(answer_now)
    assert reader.values["NAVL1_PERIOD"] == 18.0
    reader.again()
    assert not reader.done
    answer(reader, OLDER, now=1.0)
    assert reader.done
