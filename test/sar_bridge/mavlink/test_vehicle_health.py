"""What is told of the UAV beside its flight."""

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.vehicle_health import VehicleHealth


def test_battery_gps_radio_and_text_are_told():
    health = VehicleHealth()
    health.handle(mavlink.MAVLink_sys_status_message(0, 0, 0, 0, 24_130, 0, 81, 0, 0, 0, 0, 0, 0))
    assert health.values == {"battery_v": "24.1", "battery_percent": "81"}
    cells = [4000] * 6 + [65535] * 4
    health.handle(mavlink.MAVLink_battery_status_message(0, 0, 0, 0, cells, 0, 0, 0, 79))
    assert health.values == {"battery_v": "24.0", "battery_percent": "79"}
    health.handle(mavlink.MAVLink_gps_raw_int_message(0, 3, 0, 0, 0, 0, 0, 0, 0, 14))
    health.handle(mavlink.MAVLink_radio_status_message(180, 170, 0, 40, 40, 0, 0))
    health.handle(mavlink.MAVLink_statustext_message(4, b"Terrain: no data"))
    assert health.values["uav_satellites"] == "14"
    assert health.values["radio_rssi"] == "180"
    assert health.values["radio_noise"] == "40"
    assert health.text == "Terrain: no data"


def test_what_is_not_known_is_not_told():
    health = VehicleHealth()
    health.handle(mavlink.MAVLink_sys_status_message(0, 0, 0, 0, 65535, 0, -1, 0, 0, 0, 0, 0, 0))
    health.handle(mavlink.MAVLink_battery_status_message(0, 0, 0, 0, [65535] * 10, 0, 0, 0, -1))
    assert health.values == {}
    health.handle(mavlink.MAVLink_radio_status_message(255, 255, 0, 255, 0, 0, 0))
    assert health.values["radio_rssi"] == ""
