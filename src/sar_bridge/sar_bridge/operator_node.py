"""``operator``: what an operator asks of the graph, without the ros2 command line."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from typing import Any

import rclpy
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.utilities import remove_ros_args
from std_srvs.srv import Trigger

from sar_bridge.services import SERVICES
from sar_estimator.common import topics
from sar_estimator.common.completion import add_completion
from sar_estimator.common.node_support import start_ros

SLOT = "slot"
SIDES = ("inside", "outside", "right", "left")


class Request:
    """A service, what it is asked, and what its answer says: whether it was done, and a text."""

    def __init__(
        self, kind: Any, service: str, asked: Any, said: Callable[[Any], tuple[bool, str]]
    ) -> None:
        """Ask nothing yet."""
        self.kind, self.service, self.asked, self.said = kind, service, asked, said


def trigger(action: str, uav: str) -> Request:
    """Return a request of one of the services by name."""
    service = topics.of_uav(SERVICES[action], uav)
    return Request(Trigger, service, Trigger.Request(), lambda it: (it.success, it.message))


def slot_change(side: str, tracks: int, uav: str) -> Request:
    """Return a request that a UAV takes another place in the formation."""
    text = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=side)
    count = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=tracks)
    asked = SetParametersAtomically.Request(
        parameters=[
            Parameter(name="slot_side", value=text),
            Parameter(name="slot_tracks", value=count),
        ]
    )
    service = f"{'/' if uav else ''}{uav}/planner/set_parameters_atomically"
    return Request(
        SetParametersAtomically,
        service,
        asked,
        lambda it: (it.result.successful, it.result.reason or f"{side} {tracks}"),
    )


def arguments(argv: list[str] | None) -> argparse.Namespace:
    """Return what was asked for on the command line."""
    parser = argparse.ArgumentParser(prog="operator", description=__doc__)
    parser.add_argument("action", choices=(*SERVICES, SLOT))
    parser.add_argument("side", nargs="?", choices=SIDES, help="of slot: where the UAV is to fly")
    parser.add_argument(
        "tracks", nargs="?", type=int, default=1, help="of slot: track spacings from the helicopter"
    )
    parser.add_argument("--uav", default="", metavar="NAME", help="which one, where there are more")
    parser.add_argument("--timeout", type=float, default=10.0, help="seconds to wait for an answer")
    add_completion(parser)
    args = parser.parse_args(remove_ros_args(sys.argv)[1:] if argv is None else argv)
    if (args.action == SLOT) != (args.side is not None):
        parser.error(f"{args.action}: expected " + ("a side" if args.side is None else "no side"))
    return args


def main(argv: list[str] | None = None) -> int:
    """Call one service; 0 when it was done, 1 when it was refused, 2 when nobody answered."""
    args = arguments(argv)
    if args.action == SLOT:
        request = slot_change(args.side, args.tracks, args.uav)
    else:
        request = trigger(args.action, args.uav)
    start_ros()
    try:
        node = rclpy.create_node("operator")
        client = node.create_client(request.kind, topics.name_of(request.service))
        if not client.wait_for_service(timeout_sec=args.timeout):
            sys.stderr.write(f"operator: {request.service}: no such service is running\n")
            return 2
        future = client.call_async(request.asked)
        rclpy.spin_until_future_complete(node, future, timeout_sec=args.timeout)
        if not future.done():
            sys.stderr.write(f"operator: {request.service}: no answer\n")
            return 2
        done, text = request.said(future.result())
    finally:
        rclpy.try_shutdown()
    sys.stdout.write(f"{args.action}: {text}\n")
    return 0 if done else 1


if __name__ == "__main__":
    sys.exit(main())
