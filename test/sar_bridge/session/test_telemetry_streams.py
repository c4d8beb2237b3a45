"""Telemetry is asked for again while positions are late."""

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.session.telemetry_streams import STREAMS_HZ, TelemetryStreams


def test_it_is_asked_for_while_positions_are_late_and_not_too_often():
    streams = TelemetryStreams()
    asked = [len(streams.due(-1.0, 0.1 * i)) for i in range(50)]
    assert [i for i, count in enumerate(asked) if count] == [0, 20, 40]
    assert set(asked) == {0, len(STREAMS_HZ)}
    assert streams.due(100.0, 100.3) == []


def test_each_is_asked_for_at_its_own_rate():
    found = {command.params[0]: command.params[1] for command in TelemetryStreams().due(0.0, 9.0)}
    assert found[mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT] == 2e5
    assert found[mavlink.MAVLINK_MSG_ID_WIND] == 1e6
