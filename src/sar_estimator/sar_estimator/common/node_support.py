"""What every node shares: quality of service, parameters from dataclasses, start and stop."""

from __future__ import annotations

import math
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any, NoReturn

import rclpy
from rcl_interfaces.srv import GetParameters
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.task import Future
from std_srvs.srv import Trigger

from sar_estimator.common.loopback import stay_on_machine
from sar_estimator.common.node_parameters import refuse_unknown_parameters
from sar_estimator.common.priorities import set_priority

PATIENCE_S = 8.0
ASK_AGAIN_S = 0.5
REPORT_TICK_S = 0.5
SOON_S, LATE_S, AFTER_A_FIX_S = 0.7, 1.2, 0.2
RELIABLE = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
LATCHED = QoSProfile(
    depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)


def start_ros(**options: Any) -> None:
    """Start ROS as ``rclpy.init`` does; DDS stays on this machine unless otherwise asked for."""
    stay_on_machine(os.environ)
    rclpy.init(**options)


def now_s(node: Node) -> float:
    """Return the node's clock [s]."""
    return float(node.get_clock().now().nanoseconds) * 1e-9


def is_report_due(time_s: float, reported_s: float) -> bool:
    """Whether to report again, if that is asked twice a second.

    Once a second and half-way between whole ones, where receivers give their fixes: what tells of a
    node does not delay what flies.
    """
    since_s = time_s - reported_s
    if SOON_S < since_s <= LATE_S:
        return AFTER_A_FIX_S <= time_s % 1.0 < AFTER_A_FIX_S + REPORT_TICK_S
    return not 0.0 <= since_s <= LATE_S  # late, or the clock was set back


def report_each_second(node: Node, report: Callable[[], None]) -> None:
    """Have ``report`` called once a second of the node's clock, between the fixes."""
    reported_s = -math.inf

    def on_timer() -> None:
        nonlocal reported_s
        now = now_s(node)
        if is_report_due(now, reported_s):
            reported_s = now
            report()

    node.create_timer(REPORT_TICK_S, on_timer)


class Answers:
    """Which nodes answer when they are asked for a parameter.

    So that either side has found the other, which a count of listeners does not show.
    """

    def __init__(self, node: Node, names: tuple[str, ...]) -> None:
        """Ask the nodes of these names."""
        self._node = node
        self._clients = {
            name: node.create_client(GetParameters, f"{name}/get_parameters") for name in names
        }
        self._asked: dict[str, tuple[float, Any]] = {}

    def missing(self, now_s: float) -> list[str]:
        """Return the nodes that have not answered, and ask those again that were silent."""
        for name, client in list(self._clients.items()):
            asked_s, answer = self._asked.get(name, (-math.inf, None))
            if answer is not None and answer.done():
                del self._clients[name]
                self._node.destroy_client(client)
            elif now_s - asked_s > ASK_AGAIN_S and client.service_is_ready():
                request = GetParameters.Request(names=["use_sim_time"])
                self._asked[name] = now_s, client.call_async(request)
        return list(self._clients)


def hear_until(
    node: Node,
    wanted: list[tuple[type[Any], str, QoSProfile]],
    enough: Callable[[dict[str, Any]], bool],
) -> dict[str, Any]:
    """Listen to topics (type, name, quality) until their newest messages, by topic, are enough."""
    heard: dict[str, Any] = {}
    subscriptions = [
        node.create_subscription(kind, topic, partial(heard.__setitem__, topic), quality)
        for kind, topic, quality in wanted
    ]
    while not enough(heard):
        rclpy.spin_once(node, timeout_sec=0.2)
    for subscription in subscriptions:
        node.destroy_subscription(subscription)
    return heard


def end_process(code: int) -> NoReturn:
    """End this process at once, without taking the middleware down piece by piece.

    Fast DDS can wait for ever in its own finalisation when another participant was killed.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


def _end_when_asked() -> None:
    """Have this process end ``PATIENCE_S`` after SIGINT or SIGTERM, whatever hangs in it by then.

    The signal wakes a thread of its own: the middleware, where the others may wait, is not asked.
    SIGINT counts even where it was ignored, as a shell does for what it starts in the background.
    """
    asked, woken = socket.socketpair()
    woken.setblocking(False)  # noqa: FBT003 (the standard library's)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, lambda *_: None)  # what it does is ROS's matter
    signal.set_wakeup_fd(woken.fileno(), warn_on_full_buffer=False)

    def wait() -> None:
        asked.recv(1)
        time.sleep(PATIENCE_S)
        woken.close()
        end_process(0)

    threading.Thread(target=wait, name="ending", daemon=True).start()


def run_node(name: str, make: Callable[[], Node]) -> int:
    """Run a node until SIGINT, SIGTERM or shutdown; 2 and one line when it refuses to start.

    Its process is raised or lowered as ``priorities`` has it.
    """
    priority = set_priority(name, os.environ)
    _end_when_asked()
    start_ros()
    try:
        node = make()
        refuse_unknown_parameters(node)
        if priority:
            node.get_logger().info(priority)
    except (ValueError, OSError) as error:
        sys.stderr.write(f"{name}: {error}\n")
        end_process(2)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except RuntimeError:
        # Asked to end between two waits rclpy may still make the next one, and fail (RCLError).
        if rclpy.ok():
            raise
    finally:
        close = getattr(node, "close", None)
        if close is not None:
            close()
    end_process(0)


class Persistent:
    """Asks a service until it has granted what is asked once; then never again.

    One that is refused is asked anew after ``again_s`` [s]; one that is never answered after
    ``unanswered_s``, which is as long where it is not given.
    """

    def __init__(
        self, node: Node, service: str, again_s: float, unanswered_s: float | None = None
    ) -> None:
        """Nothing is asked yet."""
        self._client = node.create_client(Trigger, service)
        self._again_s = again_s
        self._unanswered_s = again_s if unanswered_s is None else unanswered_s
        self._asked: Future | None = None
        self._asked_s = -math.inf
        self._refused = ""
        self.done = False

    @property
    def heard(self) -> bool:
        """Whether the service is there."""
        return bool(self._client.service_is_ready())

    def ask(self) -> str:
        """Ask when it is time; return what is to be told: a new refusal, or the grant."""
        if self.done:
            return ""
        told = ""
        if self._asked is not None and self._asked.done():
            answer = self._asked.result()
            self._asked = None
            self.done = bool(answer.success)
            if self.done or answer.message != self._refused:
                told = self._refused = answer.message
        now = time.monotonic()
        waits_s = self._again_s if self._asked is None else self._unanswered_s
        if not self.done and now - self._asked_s > waits_s and self.heard:
            self._asked_s = now
            self._asked = self._client.call_async(Trigger.Request())
        return told
