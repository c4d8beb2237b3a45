"""What is told of the UAV beside its flight: battery, its GPS, the radio, texts. Pure."""

from __future__ import annotations

from pymavlink.dialects.v20 import ardupilotmega as mavlink

UNKNOWN_MV, UNKNOWN_PERCENT = 65535, -1
UNKNOWN_RSSI = 255


class VehicleHealth:
    """Folds messages into figures by name, as texts; ``text``: the newest that the UAV told."""

    def __init__(self) -> None:
        """Have heard nothing."""
        self.values: dict[str, str] = {}
        self.text = ""

    def handle(self, message: mavlink.MAVLink_message) -> None:
        """Take a message of the UAV's, or of the radio's."""
        kind = message.get_type()
        if kind == "SYS_STATUS":
            self._battery(message.voltage_battery, message.battery_remaining)
        elif kind == "BATTERY_STATUS":
            volts = [cell for cell in message.voltages if cell != UNKNOWN_MV]
            self._battery(sum(volts) if volts else UNKNOWN_MV, message.battery_remaining)
        elif kind == "GPS_RAW_INT":
            self.values["uav_fix"] = str(message.fix_type)
            self.values["uav_satellites"] = str(message.satellites_visible)
        elif kind == "RADIO_STATUS":
            for name, value in (
                ("radio_rssi", message.rssi),
                ("radio_remote_rssi", message.remrssi),
                ("radio_noise", message.noise),
            ):
                self.values[name] = "" if value == UNKNOWN_RSSI else str(value)
        elif kind == "STATUSTEXT":
            self.text = message.text

    def _battery(self, millivolts: int, percent: int) -> None:
        if millivolts != UNKNOWN_MV:
            self.values["battery_v"] = f"{1e-3 * millivolts:.1f}"
        if percent != UNKNOWN_PERCENT:
            self.values["battery_percent"] = str(percent)
