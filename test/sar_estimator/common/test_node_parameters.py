"""A node's parameters are declared from dataclasses: described, bounded, read-only."""

import math
import subprocess
import sys
from dataclasses import fields

import pytest

from sar_estimator.common.checked import Bounds
from sar_estimator.common.node_parameters import described, descriptions
from sar_sim.report.parameter_page import NODES


@pytest.mark.parametrize("kind", [kind for kinds in NODES.values() for kind in kinds])
def test_every_parameter_is_described(kind):
    found = descriptions(kind)
    assert set(found) == {item.name for item in fields(kind)}
    assert all(3 < len(text) < 300 for text in found.values())
    assert not any("_m:" in text or "_s:" in text for text in found.values())


def test_bounds_become_ranges():
    told = described("a", 1.0, "what it is", Bounds(0.0, math.inf, open_low=True))
    (ends,) = told.floating_point_range
    assert (ends.from_value, ends.to_value) == (0.0, math.inf)
    assert told.read_only
    (ends,) = described("b", 3, "", Bounds(1.0)).integer_range
    assert (ends.from_value, ends.step) == (1, 1)
    free = described("c", "text", "", Bounds())
    assert [*free.floating_point_range, *free.integer_range] == []


CHANGING = """
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from sar_bridge.monitor.parameters import MonitorParameters
from sar_estimator.common.node_parameters import parameters
from sar_estimator.common.node_support import start_ros

start_ros()
node = Node("monitor", parameter_overrides=[Parameter("min_separation_m", value=220)])
limits = parameters(node, MonitorParameters)
(changed,) = node.set_parameters([Parameter("min_separation_m", value=500.0)])
told = node.describe_parameter("min_separation_m")
print(limits.min_separation_m, changed.successful, told.read_only, told.description)
print(told.floating_point_range[0].from_value)

for name, value in (("guard_sigmas", -1.0), ("horizon_s", "far"), ("min_separation_m", 0.0)):
    other = Node("other", parameter_overrides=[Parameter(name, value=value)])
    try:
        parameters(other, MonitorParameters)
    except ValueError as error:
        print(error)
"""


@pytest.mark.graph
def test_a_parameter_cannot_be_changed_in_flight(own_domain):
    """Nodes read theirs when they start; a change that is granted would change nothing."""
    found = subprocess.run(
        [sys.executable, "-c", CHANGING],
        env=own_domain,
        capture_output=True,
        text=True,
        timeout=50,
        check=True,
    )
    first, low, *refused = found.stdout.splitlines()
    value, successful, read_only, *description = first.split()
    assert (value, successful, read_only) == ("220.0", "False", "True")
    assert description[:3] == ["no", "list", "passes"]
    assert float(low) == 0.0
    assert refused == [
        "parameter guard_sigmas = -1.0: expected 0 or more",
        "parameter horizon_s = 'far': expected a value like 60.0",
        "parameter min_separation_m = 0.0: expected more than 0",
    ]
