"""What an operator asks of the graph, as ROS has it: the same for the command and the page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParametersAtomically
from std_srvs.srv import Trigger

from sar_bridge.services import SERVICES
from sar_estimator.common import topics


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


def setting(uav: str, **values: str | int) -> Request:
    """Return a request that a planner takes parameters, all of them or none."""
    given = [Parameter(name=name, value=_value(value)) for name, value in values.items()]
    service = topics.of_uav(topics.SET_PARAMETERS, uav)
    taken = " ".join(str(value) for value in values.values())
    return Request(
        SetParametersAtomically,
        service,
        SetParametersAtomically.Request(parameters=given),
        lambda it: (it.result.successful, it.result.reason or taken),
    )


def slot(uav: str, side: str, tracks: int) -> Request:
    """Return a request that a UAV takes another place in the formation."""
    return setting(uav, slot_side=side, slot_tracks=tracks)


def _value(value: str | int) -> ParameterValue:
    if isinstance(value, str):
        return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=value)
    return ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=value)
