"""Node ``console``: the operator's page, on this laptop alone."""

from __future__ import annotations

import argparse
import contextlib
import logging
import os
import re
import secrets
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import rclpy
from nicegui import app, ui
from pydantic import Field
from pydantic.dataclasses import dataclass
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from sar_bridge.console.access import Access
from sar_bridge.console.fleet import Fleet, uavs_in
from sar_bridge.console.live import LiveDesk
from sar_bridge.console.map_view import Search
from sar_bridge.console.page import Desk, Page
from sar_bridge.console.playback import PlaybackDesk, Told
from sar_bridge.console.snapshot import Snapshot
from sar_bridge.console.tiles import URL, Tiles
from sar_bridge.requests import Request, slot, trigger
from sar_bridge.services import SERVICES, SIDES, SLOT, TRACKS
from sar_estimator.bags.bag import BAG_ERRORS, read_messages, topics_in
from sar_estimator.common import topics
from sar_estimator.common.checked import CHECKED, Positive, Side
from sar_estimator.common.component_node import ComponentNode
from sar_estimator.common.node_parameters import parameters, refuse_unknown_parameters
from sar_estimator.common.node_support import end_process, now_s, start_ros
from sar_estimator.common.priorities import set_priority
from sar_estimator.common.reports import Target
from sar_estimator.common.wires import WIRES

TITLE = "SAR formation"
NAMESPACE = re.compile(r"[A-Za-z]\w*", re.ASCII)


@dataclass(frozen=True, config=CHECKED)
class ConsoleParameters:
    """Parameters of the node.

    port: of the page, on 127.0.0.1. spacing_m, turn_side: of the formation, as the planner has
    them. swath_m: what each aircraft sees, in width. address_file: the page's address is written
    there, with its token, for this user alone; empty for none. folder: on the recorder's disk.
    tiles: folder with map tiles, Z/X/Y.png; empty for a map without. uavs: namespaces of planner,
    monitor and bridge, a row of the page for each; one empty name for a UAV without.
    """

    port: Annotated[int, Field(ge=1, le=65535)] = 8080
    spacing_m: Positive = 250.0
    turn_side: Side = 1
    swath_m: Positive = 250.0
    address_file: str = ""
    folder: str = "."
    tiles: str = ""
    uavs: tuple[str, ...] = ("",)

    def __post_init__(self) -> None:
        """Check the names."""
        good = all(not one or NAMESPACE.fullmatch(one) for one in self.uavs)
        if not self.uavs or not good or len(set(self.uavs)) < len(self.uavs):
            raise ValueError(
                f"uavs = {list(self.uavs)}: expected different names of letters, digits and _"
            )


PARAMETERS = (ConsoleParameters,)


class ConsoleNode(ComponentNode):
    """Feeds the consoles of all UAVs, and asks services."""

    by_wall_clock = True

    def __init__(self) -> None:
        """Listen; find the services."""
        self.parameters: ConsoleParameters
        self.fleet: Fleet
        super().__init__("console", self._make)
        self._clients_by_service = {
            one.service: self.create_client(one.kind, topics.name_of(one.service))
            for uav in self.parameters.uavs
            for one in (*(trigger(name, uav) for name in SERVICES), slot(uav, SIDES[0], TRACKS[0]))
        }

    def _make(self, node: Node) -> Fleet:
        self.parameters = parameters(node, ConsoleParameters)
        self.fleet = Fleet(self.parameters.uavs)
        return self.fleet

    def component_s(self) -> float:
        """Return a monotonic clock [s]: how old something is has nothing to do with the graph's."""
        return time.monotonic()

    def snapshots(self) -> dict[str, Snapshot]:
        """Return what is known now, by UAV."""
        with self.lock:
            return self.fleet.snapshots(time.monotonic())

    def acknowledge(self) -> None:
        """Take the banner for known."""
        with self.lock:
            self.fleet.acknowledge(time.monotonic())

    def mark(self, x_m: float, y_m: float) -> None:
        """Mark a place of the map [m]."""
        with self.lock:
            self.publish([(topics.TARGET, Target(now_s(self), x_m, y_m))])

    def ask(self, action: str, uav: str) -> None:
        """Ask a UAV's service; its answer is shown word for word."""
        self._send(f"{uav} {action.replace('_', ' ')}", trigger(action, uav))

    def give_slot(self, side: str, tracks: int, uav: str) -> None:
        """Ask a UAV's planner to take another slot; its answer is shown word for word."""
        self._send(f"{uav} {SLOT}", slot(uav, side, tracks))

    def _send(self, what: str, request: Request) -> None:
        client, name = self._clients_by_service[request.service], what.lstrip()
        if not client.service_is_ready():
            self._answered(f"{name}: nobody answers")
            return
        client.call_async(request.asked).add_done_callback(
            lambda done: self._answered(f"{name}: {request.said(done.result())[1]}")
        )

    def _answered(self, text: str) -> None:
        with self.lock:
            self.fleet.answered(text)


def show(desk: Desk, port: int, address_file: str = "", tiles_folder: str = "") -> None:
    """Serve the page until the process is asked to end."""
    tiles = Tiles(Path(tiles_folder)) if tiles_folder else None
    token = secrets.token_urlsafe(24)
    address = f"http://127.0.0.1:{port}/?token={token}"
    if address_file:
        file = Path(address_file)
        file.touch(mode=0o600)
        file.write_text(f"{address}\n", encoding="utf-8")
    sys.stdout.write(f"console: {address}\n")
    sys.stdout.flush()
    app.add_middleware(Access, port=port, token=token)
    if tiles is not None:
        app.add_static_files(URL, tiles.folder)

    @ui.page("/", title=TITLE)
    def index() -> None:
        Page(desk, tiles)

    logging.getLogger("nicegui").setLevel(logging.ERROR)
    ui.run(
        host="127.0.0.1",
        port=port,
        title=TITLE,
        show=False,
        reload=False,
        show_welcome_message=False,
        reconnect_timeout=10.0,
    )


def _told(bag: Path) -> Iterator[Told]:
    """Yield what a bag has of what the page shows, of whichever UAVs it is."""
    wanted = set(Fleet(uavs_in(topics_in(bag))).inputs)
    for topic, time_s, message in read_messages(bag, wanted):
        try:
            yield time_s, topic, WIRES[topics.plain(topic)].from_message(message)
        except ValueError:
            continue  # of another version: the rest is shown


def _play(bag: Path, port: int, speed: float, tiles: str) -> None:
    show(PlaybackDesk(_told(bag), Search(), time.monotonic, speed=speed), port, tiles_folder=tiles)


def _fly(node: ConsoleNode) -> None:
    own = node.parameters
    desk = LiveDesk(
        node.snapshots,
        node.ask,
        node.acknowledge,
        node.mark,
        node.give_slot,
        Search(own.swath_m, own.spacing_m, own.turn_side),
        own.folder,
    )

    def spin() -> None:
        with contextlib.suppress(ExternalShutdownException):
            rclpy.spin(node)

    threading.Thread(target=spin, name="ros", daemon=True).start()
    show(desk, own.port, own.address_file, own.tiles)


def main(argv: list[str] | None = None) -> int:
    """Show the page; 2 and one line on bad input."""
    parser = argparse.ArgumentParser(prog="console", description=__doc__)
    parser.add_argument("--bag", type=Path, help="show this recording instead of a flight")
    parser.add_argument("--port", type=int, default=8080, help="of a recording's page")
    parser.add_argument("--speed", type=float, default=10.0, help="of a recording that is played")
    parser.add_argument("--tiles", default="", metavar="DIR", help="of map tiles, Z/X/Y.png")
    args = parser.parse_args(remove_ros_args(sys.argv)[1:] if argv is None else argv)
    if args.bag is not None:
        try:
            _play(args.bag, args.port, args.speed, args.tiles)
        except BAG_ERRORS as error:
            sys.stderr.write(f"console: {args.bag}: {error}\n")
            return 2
        except ValueError as error:
            sys.stderr.write(f"console: {error}\n")
            return 2
        return 0
    set_priority("console", os.environ)
    start_ros(signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = ConsoleNode()
        refuse_unknown_parameters(node)
        _fly(node)
    except (ValueError, OSError) as error:
        sys.stderr.write(f"console: {error}\n")
        return end_process(2)
    return end_process(0)


if __name__ == "__main__":
    sys.exit(main())
