"""``play``: a bag's messages onto their topics again, at a chosen rate, with ``/clock``."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rosbags.interfaces import Connection, QosDurability
from rosgraph_msgs.msg import Clock

from sar_estimator.bags.bag import BAG_ERRORS, open_bag
from sar_estimator.bags.former import as_now, is_former, now_on
from sar_estimator.bags.message_types import get_message
from sar_estimator.common import topics
from sar_estimator.common.component_node import publisher
from sar_estimator.common.conversions import to_stamp
from sar_estimator.common.node_support import LATCHED, RELIABLE, start_ros
from sar_sim.world.wires import ALL_WIRES

START_DELAY_S = 1.0
CLOCK_PERIOD_S = 0.05


class PlayNode(Node):
    """Publishes a bag."""

    def __init__(self, bag: Path, *, rate: float, chosen: list[str]) -> None:
        """Play topics in ``chosen`` (all when empty) at ``rate`` times their own pace."""
        super().__init__("play")
        self._bag, self._rate, self._chosen = bag, rate, chosen
        self._clock_sender = self.create_publisher(Clock, topics.CLOCK, RELIABLE)

    def _publisher(self, connection: Connection) -> Publisher:
        offered = getattr(connection.ext, "offered_qos_profiles", ())
        latched = any(qos.durability is QosDurability.TRANSIENT_LOCAL for qos in offered)
        kind = get_message(connection.msgtype)
        return self.create_publisher(kind, connection.topic, LATCHED if latched else RELIABLE)

    def _former(self, topic: str) -> Publisher:
        """Return the publisher of a topic that carried JSON, as it is now."""
        return publisher(self, topic, ALL_WIRES)

    def play(self) -> int:
        """Play to the end, what carried JSON as it is now; return how many messages were played."""
        count = 0
        with open_bag(self._bag) as reader:
            connections = [
                item
                for item in reader.connections
                if item.topic != topics.CLOCK and (not self._chosen or item.topic in self._chosen)
            ]
            if not connections:
                raise ValueError(f"{self._bag}: none of the chosen topics is in it")
            senders = {
                item.id: self._publisher(item) for item in connections if not is_former(item)
            }
            former = {topic: self._former(topic) for item in connections for topic in now_on(item)}
            time.sleep(START_DELAY_S)
            begun, first_s, told_s = time.monotonic(), reader.start_time * 1e-9, -1.0
            for connection, timestamp, raw in reader.messages(connections=connections):
                at_s = timestamp * 1e-9
                while rclpy.ok():
                    ahead = begun + (at_s - first_s) / self._rate - time.monotonic()
                    clock_s = min(at_s, at_s - ahead * self._rate)
                    if clock_s - told_s >= CLOCK_PERIOD_S or ahead <= 0.0:
                        told_s = max(told_s, clock_s)
                        self._clock_sender.publish(Clock(clock=to_stamp(told_s)))
                    if ahead <= 0.0:
                        break
                    time.sleep(min(ahead, CLOCK_PERIOD_S / self._rate))
                if not rclpy.ok():
                    break
                if connection.id in senders:
                    senders[connection.id].publish(bytes(raw))
                else:
                    message = reader.deserialize(raw, connection.msgtype)
                    for topic, one in as_now(connection.topic, connection.msgtype, message):
                        former[topic].publish(one)
                count += 1
        return count


def main(argv: list[str] | None = None) -> int:
    """Play a bag; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="play", description=__doc__)
    parser.add_argument("bag", type=Path)
    parser.add_argument("--rate", type=float, default=1.0, help="times the recorded pace")
    parser.add_argument("--topics", nargs="+", default=[], help="only these")
    args, ros_args = parser.parse_known_args(argv)
    if args.rate <= 0.0:
        parser.error(f"--rate {args.rate}: expected more than 0")
    start_ros(args=ros_args)
    try:
        node = PlayNode(args.bag, rate=args.rate, chosen=args.topics)
        count = node.play()
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    except BAG_ERRORS as error:
        sys.stderr.write(f"play: {args.bag}: {error}\n")
        return 2
    finally:
        rclpy.try_shutdown()
    sys.stdout.write(f"{args.bag}: {count} messages played\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
