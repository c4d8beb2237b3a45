"""Components: what every node of the graph runs, without ROS, without a clock, without I/O.

A component takes values by topic, and gives values by topic. A node feeds it from messages, an
offline flight from other components, a replay from a bag: the wiring is the table of ``wires``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from sar_estimator.common.reports import Health

NOTICES = ""
"""The topic of what is only logged: a ``Notice``."""

Outputs = list[tuple[str, Any]]
Handler = Callable[[Any, float], Outputs]


class Notice(NamedTuple):
    """A line for the log: ``level`` is info, warning or error."""

    level: str
    text: str


@dataclass(frozen=True, slots=True)
class Answer:
    """What a service answers, and what is published for it."""

    success: bool
    message: str
    outputs: Outputs


class Component:
    """Values in, values out; times [s] are of one clock.

    ``inputs``: a handler for every topic that is listened to. ``outputs``: the topics that are
    published. ``services``: a function of the time for every service. ``period_s``: how often
    ``tick`` is to be called. ``urgent``: topics after which it is to be called at once.
    """

    name = ""
    outputs: tuple[str, ...] = ()
    urgent: frozenset[str] = frozenset()
    period_s = 1.0

    def __init__(self) -> None:
        """Listen to nothing."""
        self.inputs: Mapping[str, Handler] = {}
        self.services: Mapping[str, Callable[[float], Answer]] = {}

    def handle(self, topic: str, value: Any, now_s: float) -> Outputs:
        """Take a value of a topic; return what is to be published."""
        handler = self.inputs.get(topic)
        return [] if handler is None else handler(value, now_s)

    def start(self, now_s: float) -> Outputs:  # noqa: ARG002
        """Return what is published before anything is known."""
        return []

    def tick(self, now_s: float) -> Outputs:  # noqa: ARG002
        """Do what is due; return what is to be published."""
        return []

    def report(self, now_s: float) -> Outputs:  # noqa: ARG002
        """Return what is published once a second, beside its health."""
        return []

    def health(self, now_s: float) -> Health:  # noqa: ARG002
        """Return how it is."""
        return Health(self.name)

    def set_clock_back(self) -> None:
        """Forget what belongs to a time that has not come yet."""


def keep(setter: Callable[[Any], None]) -> Handler:
    """Return a handler that hands a value to a setter, and publishes nothing."""

    def handle(value: Any, _now_s: float) -> Outputs:
        setter(value)
        return []

    return handle


def keep_at(setter: Callable[[Any, float], None]) -> Handler:
    """Return a handler that hands a value to a setter, and when [s] it came; publishes nothing."""

    def handle(value: Any, now_s: float) -> Outputs:
        setter(value, now_s)
        return []

    return handle
