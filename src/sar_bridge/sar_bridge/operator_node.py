"""``operator``: what an operator asks of the graph, without the ros2 command line."""

from __future__ import annotations

import argparse
import sys

import rclpy
from rclpy.utilities import remove_ros_args
from std_srvs.srv import Trigger

from sar_bridge.services import SERVICES
from sar_estimator.common import topics
from sar_estimator.common.completion import add_completion
from sar_estimator.common.node_support import start_ros


def main(argv: list[str] | None = None) -> int:
    """Call one service; 0 when it was done, 1 when it was refused, 2 when nobody answered."""
    parser = argparse.ArgumentParser(prog="operator", description=__doc__)
    parser.add_argument("action", choices=SERVICES)
    parser.add_argument("--timeout", type=float, default=10.0, help="seconds to wait for an answer")
    add_completion(parser)
    args = parser.parse_args(remove_ros_args(sys.argv)[1:] if argv is None else argv)
    start_ros()
    try:
        node = rclpy.create_node("operator")
        client = node.create_client(Trigger, topics.name_of(SERVICES[args.action]))
        if not client.wait_for_service(timeout_sec=args.timeout):
            sys.stderr.write(f"operator: {SERVICES[args.action]}: no such service is running\n")
            return 2
        future = client.call_async(Trigger.Request())
        rclpy.spin_until_future_complete(node, future, timeout_sec=args.timeout)
        if not future.done():
            sys.stderr.write(f"operator: {SERVICES[args.action]}: no answer\n")
            return 2
        answer = future.result()
    finally:
        rclpy.try_shutdown()
    sys.stdout.write(f"{args.action}: {answer.message}\n")
    return 0 if answer.success else 1


if __name__ == "__main__":
    sys.exit(main())
