"""Node ``launch``: hears the diagnostics of the nodes of a flight."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from sar_estimator.common import topics
from sar_estimator.common.component_node import subscribe
from sar_estimator.common.conversions import from_stamp
from sar_estimator.common.node_support import start_ros
from sar_sim.jobs.processes import folder_bytes
from sar_sim.launch.launch_plan import leg_flown

HANGS_S = 10.0
SILENT_S = 2.0


class Watcher(Node):
    """Hears the nodes' diagnostics, for the progress line. ``uavs``: the UAVs' names."""

    def __init__(self, uavs: Sequence[str] = ("",)) -> None:
        """Subscribe to what all share, and to what is of every UAV."""
        super().__init__("launch")
        self.uavs = tuple(uavs)
        self.values: dict[str, dict[str, str]] = {}
        self.problems: dict[str, str] = {}
        self.heard_s: dict[str, float] = {}
        self._newest_s = 0.0
        self._last_s = self._since_s = -math.inf
        for uav in dict.fromkeys(("", *uavs)):
            topic = topics.of_uav(topics.DIAGNOSTICS, uav)
            subscribe(self, topic, partial(self._on, f"{uav}/" if uav else ""))

    def _on(self, of: str, message: DiagnosticArray) -> None:
        self._newest_s = from_stamp(message.header.stamp)
        now = time.monotonic()
        if now - self._last_s > SILENT_S:
            self._since_s = now
        self._last_s = now
        for status in message.status:
            name = of + status.name
            self.heard_s[name] = now
            self.values[name] = {item.key: item.value for item in status.values}
            self.values[name]["time_s"] = str(message.header.stamp.sec)
            bad = int.from_bytes(status.level, "little") > 0
            self.problems[name] = status.message if bad else ""

    def listen(self, timeout_s: float) -> None:
        """Take what is heard within ``timeout_s`` [s]."""
        rclpy.spin_once(self, timeout_sec=timeout_s)

    def close(self) -> None:
        """Hear nothing more; this process has done with ROS."""
        self.destroy_node()
        rclpy.try_shutdown()

    def hangs(self, name: str) -> bool:
        """Whether a node has said nothing for long while others have all the time."""
        now = time.monotonic()
        silent_s = now - max(self.heard_s.get(name, now), self._since_s)
        return silent_s > HANGS_S and now - self._last_s < SILENT_S

    def time_s(self, speed: float) -> float:
        """Return the graph's time [s], carried on at a speed while nothing is heard."""
        silent_s = time.monotonic() - self._last_s
        carried_on = SILENT_S < silent_s < math.inf
        return self._newest_s + (speed * silent_s if carried_on else 0.0)

    def line(self, bag: Path) -> str:
        """Return progress in one line."""
        planners = {
            uav: self.values.get(f"{uav}/planner" if uav else "planner", {}) for uav in self.uavs
        }
        first = planners[self.uavs[0]]
        corner = int(first.get("corner") or 0)
        leg = leg_flown(corner, first.get("rule", ""), first.get("phase", ""))
        parts = [f"t {first.get('time_s', '–')} s", f"leg {leg}", f"corner k={corner}"]
        for uav, planner in planners.items():
            parts += [uav] if uav else []
            parts += [
                f"rule {planner.get('rule', '–')}",
                f"L {planner.get('lag_m') or '–'} m",
                f"separation {planner.get('separation_m') or '–'} m",
            ]
        parts.append(f"bag {folder_bytes(bag) / 1e6:.1f} MB")
        worst = next((f"{name}: {text}" for name, text in self.problems.items() if text), "")
        return "  ".join([*parts, worst]).rstrip()


def start_watching(uavs: Sequence[str]) -> Watcher:
    """Start ROS, which leaves signals to the launcher, and watch the UAVs of these names."""
    start_ros(signal_handler_options=SignalHandlerOptions.NO)
    return Watcher(uavs)
