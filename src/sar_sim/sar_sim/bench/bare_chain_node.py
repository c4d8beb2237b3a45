"""A chain of nodes that do nothing but pass on: what ``bench`` compares the graph's delays with.

fix -> Odometry -> Path -> Path -> as many datagrams there and back as a mission has items ->
DiagnosticStatus, each hop a process of its own, with the graph's message types.
"""

from __future__ import annotations

import argparse
import socket
import sys
import threading
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry, Path
from rclpy.node import Node
from sensor_msgs.msg import NavSatFix

from sar_estimator.common.node_support import RELIABLE, run_node

FIX, ODOMETRY, LISTED, CLEARED, ACCEPTED = (
    f"/bare/{name}" for name in ("fix", "odometry", "list", "cleared", "accepted")
)
TIMEOUT_S = 2.0
NANOSECONDS = 1_000_000_000
DATAGRAM = b"x" * 50


def _echo(peer: socket.socket) -> None:
    while True:
        data, address = peer.recvfrom(1024)
        peer.sendto(data, address)


class BareNode(Node):
    """One hop. ``items``: waypoints of the list, and datagrams of its upload."""

    def __init__(self, hop: str, items: int) -> None:
        """Subscribe to what comes before it."""
        super().__init__(f"bare_{hop}")
        kind, source, out, target, passed = {
            "estimator": (NavSatFix, FIX, Odometry, ODOMETRY, self._odometry),
            "planner": (Odometry, ODOMETRY, Path, LISTED, self._list),
            "monitor": (Path, LISTED, Path, CLEARED, self._same),
            "bridge": (Path, CLEARED, DiagnosticStatus, ACCEPTED, self._upload),
        }[hop]
        self._items = items
        self._sender = self.create_publisher(out, target, RELIABLE)
        self._passed = passed
        self.create_subscription(kind, source, self._on, RELIABLE)
        if hop == "bridge":
            self._peer = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self._peer.bind(("127.0.0.1", 0))
            threading.Thread(target=_echo, args=(self._peer,), daemon=True).start()
            self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self._socket.settimeout(TIMEOUT_S)

    def _on(self, message: Any) -> None:
        self._sender.publish(self._passed(message))

    @staticmethod
    def _odometry(message: NavSatFix) -> Odometry:
        return Odometry(header=message.header)

    def _list(self, message: Odometry) -> Path:
        return Path(header=message.header, poses=[PoseStamped() for _ in range(self._items)])

    @staticmethod
    def _same(message: Path) -> Path:
        return message

    def _upload(self, message: Path) -> DiagnosticStatus:
        for _ in message.poses:
            self._socket.sendto(DATAGRAM, self._peer.getsockname())
            self._socket.recvfrom(1024)
        stamp = message.header.stamp
        list_id = str(stamp.sec * NANOSECONDS + stamp.nanosec)
        values = {"list_id": list_id, "waypoints": "71", "upload_ms": "200.0"}
        found = [KeyValue(key=key, value=value) for key, value in values.items()]
        return DiagnosticStatus(name="uploaded", message="ok", values=found)


def main(argv: list[str] | None = None) -> int:
    """Run one hop."""
    parser = argparse.ArgumentParser(prog="bare_chain", description=__doc__)
    parser.add_argument("hop", choices=("estimator", "planner", "monitor", "bridge"))
    parser.add_argument("--items", type=int, default=40)
    args = parser.parse_args(argv)
    return run_node(f"bare_{args.hop}", lambda: BareNode(args.hop, args.items))


if __name__ == "__main__":
    sys.exit(main())
