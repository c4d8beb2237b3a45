"""The parameters of the node ``sim``."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field
from pydantic.dataclasses import dataclass

from sar_estimator.common.checked import CHECKED, NotNegative

Port = Annotated[int, Field(ge=0, le=65535)]


@dataclass(frozen=True, config=CHECKED)
class SimParameters:
    """Parameters of the node.

    scenario: scenario file. speed: times real time. track: recorded track (CSV or bag) in the
    place of the simulated helicopter. uav: whether the UAVs are simulated too. mavlink_ports: UDP
    ports of their ground stations, on loopback. live_helicopter: only the UAVs are simulated,
    beside a real helicopter. follow_autopilot: go by the clock of a real or simulated autopilot.
    wait_for_listeners: on `/helicopter/fix` (estimator, recorder), before the clock starts.
    patience_s: how long to wait for the graph.
    """

    scenario: str = ""
    speed: Annotated[float, Field(gt=0.0, le=100.0)] = 10.0
    track: str = ""
    uav: bool = True
    mavlink_ports: tuple[Port, ...] = (14550,)
    live_helicopter: bool = False
    follow_autopilot: bool = False
    wait_for_listeners: Annotated[int, Field(ge=0)] = 1
    patience_s: NotNegative = 30.0
