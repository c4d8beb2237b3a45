"""Reads the autopilot's parameters that others need, under ArduPlane's newer or older names."""

from __future__ import annotations

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from sar_bridge.mavlink.addressed import Address

PERIOD_S = 1.5
TRIES = 5
# The newer name: the older one, and the factor that the older one's unit takes.
NAMES: dict[str, tuple[str, float]] = {
    "NAVL1_PERIOD": ("NAVL1_PERIOD", 1.0),
    "NAVL1_DAMPING": ("NAVL1_DAMPING", 1.0),
    "WP_RADIUS": ("WP_RADIUS", 1.0),
    "WP_MAX_RADIUS": ("WP_MAX_RADIUS", 1.0),
    "WP_LOITER_RAD": ("WP_LOITER_RAD", 1.0),
    "ROLL_LIMIT_DEG": ("LIM_ROLL_CD", 0.01),
    "AIRSPEED_CRUISE": ("TRIM_ARSPD_CM", 0.01),
    "AIRSPEED_MIN": ("ARSPD_FBW_MIN", 1.0),
    "AIRSPEED_MAX": ("ARSPD_FBW_MAX", 1.0),
    "FS_GCS_ENABL": ("FS_GCS_ENABL", 1.0),
    "FS_LONG_TIMEOUT": ("FS_LONG_TIMEOUT", 1.0),
    "FS_LONG_ACTN": ("FS_LONG_ACTN", 1.0),
}
OLDER = {old: (name, factor) for name, (old, factor) in NAMES.items()}


class ParameterReader:
    """Asks for each parameter until it is told, or ``TRIES`` times. Pure; times in seconds.

    ``values``: what is known, under the newer names and in their units.
    """

    def __init__(self, target: Address) -> None:
        """Read from ``target``."""
        self.target = target
        self.values: dict[str, float] = {}
        self._asked_s = float("-inf")
        self._tries = 0

    @property
    def done(self) -> bool:
        """Whether nothing more is to be expected."""
        return self._tries > TRIES or len(self.values) == len(NAMES)

    def again(self) -> None:
        """Read everything anew: the autopilot may not be what it was."""
        self.values = {}
        self._tries, self._asked_s = 0, float("-inf")

    def handle(self, message: mavlink.MAVLink_message) -> None:
        """Take a PARAM_VALUE, asked for or not."""
        if message.get_type() != "PARAM_VALUE":
            return
        name, factor = message.param_id, 1.0
        if name not in NAMES and name in OLDER:
            name, factor = OLDER[name]
        value = message.param_value * factor
        if name in NAMES:
            self.values[name] = value

    def tick(self, now_s: float) -> list[mavlink.MAVLink_message]:
        """Return the requests that are due."""
        if self.done or now_s - self._asked_s < PERIOD_S:
            return []
        self._asked_s = now_s
        self._tries += 1
        if self.done:
            return []
        missing = [name for name in NAMES if name not in self.values]
        # A name that the autopilot has not is not answered: both are asked for.
        asked = dict.fromkeys([*missing, *(NAMES[name][0] for name in missing)])
        return [
            mavlink.MAVLink_param_request_read_message(
                self.target.system, self.target.component, name.encode(), -1
            )
            for name in asked
        ]
