"""``operator``: what an operator asks of the graph, without the ros2 command line."""

from __future__ import annotations

import argparse
import sys

import rclpy
from rclpy.utilities import remove_ros_args

from sar_bridge.requests import Request, setting, slot, trigger
from sar_bridge.services import SERVICES, SIDES, SLOT
from sar_estimator.common import topics
from sar_estimator.common.completion import add_completion
from sar_estimator.common.node_support import start_ros

LEG = "leg"


def request_of(args: argparse.Namespace) -> Request:
    """Return what is asked for. Raises ``ValueError`` where it makes no sense."""
    words = args.of
    if args.action == SLOT:
        if not words or words[0] not in SIDES or len(words) > 2:
            raise ValueError(f"slot: expected a side of {', '.join(SIDES)}, and tracks")
        tracks = _number(words[1], "slot") if len(words) > 1 else 1
        return slot(args.uav, words[0], tracks)
    if args.action == LEG:
        if len(words) != 1:
            raise ValueError("leg: expected its number, from 1")
        return setting(args.uav, pattern_leg=_number(words[0], "leg"))
    if words:
        raise ValueError(f"{args.action}: expected nothing more, not {' '.join(words)}")
    return trigger(args.action, args.uav)


def _number(text: str, what: str) -> int:
    if not text.isdigit():
        raise ValueError(f"{what}: {text}: expected a whole number")
    return int(text)


def arguments(argv: list[str] | None) -> argparse.Namespace:
    """Return what was asked for on the command line."""
    parser = argparse.ArgumentParser(prog="operator", description=__doc__)
    parser.add_argument("action", choices=(*SERVICES, SLOT, LEG))
    parser.add_argument(
        "of",
        nargs="*",
        help=f"slot: {'|'.join(SIDES)} [TRACKS], where the UAV is to fly; leg: NUMBER, of the "
        "pattern's legs, that is flown",
    )
    parser.add_argument("--uav", default="", metavar="NAME", help="which one, where there are more")
    parser.add_argument("--timeout", type=float, default=10.0, help="seconds to wait for an answer")
    add_completion(parser)
    args = parser.parse_args(remove_ros_args(sys.argv)[1:] if argv is None else argv)
    try:
        args.request = request_of(args)
    except ValueError as error:
        parser.error(str(error))
    return args


def main(argv: list[str] | None = None) -> int:
    """Call one service; 0 when it was done, 1 when it was refused, 2 when nobody answered."""
    args = arguments(argv)
    request: Request = args.request
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
