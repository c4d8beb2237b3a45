"""Node ``record``: every topic of the graph into a bag (rosbag2, MCAP)."""

from __future__ import annotations

import contextlib
import sys
from functools import partial
from pathlib import Path

from pydantic.dataclasses import dataclass
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosbags.rosbag2 import WriterError

from sar_estimator.bags.bag import BagWriter, known_type
from sar_estimator.bags.message_types import get_message
from sar_estimator.common import topics
from sar_estimator.common.checked import CHECKED
from sar_estimator.common.component_node import publisher
from sar_estimator.common.conversions import diagnostics
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import now_s, report_each_second, run_node

DISCOVERY_PERIOD_S = 0.25
FLUSH_PERIOD_S = 0.9


@dataclass(frozen=True, config=CHECKED)
class RecordParameters:
    """Parameters of the node.

    bag: folder that is created.
    """

    bag: str = ""


PARAMETERS = (RecordParameters,)


class RecordNode(Node):
    """Subscribes to topics as they appear and writes what arrives, as it arrives."""

    def __init__(self) -> None:
        """Open the bag."""
        super().__init__("record")
        folder = parameters(self, RecordParameters).bag
        if not folder:
            raise ValueError("parameter bag: expected a folder that does not exist yet")
        try:
            self._bag = BagWriter(Path(folder))
        except WriterError as error:
            raise ValueError(f"parameter bag: {error}") from error
        self._seen: set[str] = set()
        self._waiting: list[tuple[str, str, bytes, bool]] = []
        self._failure = ""
        self._diagnostics = publisher(self, topics.DIAGNOSTICS)
        wall = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(DISCOVERY_PERIOD_S, self._discover, clock=wall)
        self.create_timer(FLUSH_PERIOD_S, self._flush, clock=wall)
        report_each_second(self, self._tell)
        self._discover()

    def close(self) -> None:
        """Finish the bag."""
        with contextlib.suppress(OSError):
            self._bag.close()

    def _flush(self) -> None:
        """Lose no more than a second when the power is cut; a full disk ends the recording."""
        if not self._failure:
            try:
                self._bag.flush()
            except OSError as error:
                self._fail(error)

    def _fail(self, error: OSError) -> None:
        self._failure = f"nothing is recorded any more: {error.strerror or error}"
        self.get_logger().error(self._failure)

    def _tell(self) -> None:
        values: dict[str, object] = {"messages": self._bag.messages}
        self._diagnostics.publish(
            diagnostics(now_s(self), "record", problem=self._failure, values=values)
        )

    def _discover(self) -> None:
        for topic, kinds in self.get_topic_names_and_types():
            if topic in self._seen or len(kinds) != 1 or not known_type(kinds[0]):
                continue
            publishers = self.get_publishers_info_by_topic(topic)
            if publishers:
                self._seen.add(topic)
                self._subscribe(topic, kinds[0], publishers[0].qos_profile)

    def _subscribe(self, topic: str, kind: str, offered: QoSProfile) -> None:
        latched = offered.durability == DurabilityPolicy.TRANSIENT_LOCAL
        self._bag.add_topic(topic, kind, latched=latched)
        reliable = offered.reliability == ReliabilityPolicy.RELIABLE
        qos = QoSProfile(
            depth=1000,
            reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
            durability=offered.durability if latched else DurabilityPolicy.VOLATILE,
        )
        callback = partial(self._write, topic, kind, latched)
        self.create_subscription(get_message(kind), topic, callback, qos, raw=True)

    def _write(self, topic: str, kind: str, latched: bool, data: bytes) -> None:  # noqa: FBT001
        if self._failure:
            return
        self._waiting.append((topic, kind, data, latched))
        stamp = now_s(self)
        if stamp == 0.0:
            return  # simulated time that has not begun: the recording begins with it
        try:
            for one, its_kind, content, lasting in self._waiting:
                self._bag.write(one, its_kind, content, stamp, latched=lasting)
        except OSError as error:
            self._fail(error)
        self._waiting.clear()


def main() -> int:
    """Run the node."""
    return run_node("record", RecordNode)


if __name__ == "__main__":
    sys.exit(main())
