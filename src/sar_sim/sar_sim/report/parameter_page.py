"""The text of ``docs/parameters.md``: every node's parameters, from what nodes declare."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from sar_bridge import bridge_node, console_node, monitor_node, radio_hub_node
from sar_estimator import estimator_node, gps_node
from sar_estimator.common.checked import bounds_of, choices_of
from sar_estimator.common.node_parameters import defaults_of, descriptions
from sar_planner import planner_node
from sar_sim.nodes import record_node
from sar_sim.nodes.sim_parameters import SimParameters

NODES: dict[str, tuple[type[Any], ...]] = {
    "gps": gps_node.PARAMETERS,
    "estimator": estimator_node.PARAMETERS,
    "planner": planner_node.PARAMETERS,
    "monitor": monitor_node.PARAMETERS,
    "bridge": bridge_node.PARAMETERS,
    "radio_hub": radio_hub_node.PARAMETERS,
    "console": console_node.PARAMETERS,
    "record": record_node.PARAMETERS,
    "sim": (SimParameters,),
}
HEAD = """# Parameters of the nodes

Written by `ros2 run sar_sim interfaces --parameters > docs/parameters.md`, from what nodes declare.

SI units and radians unless the name says otherwise. `config/params.yaml` sets them for
`./launch.sh`, which takes what a scenario prescribes from there: the corner's parameters, pattern
and slot, `arc_spacing_m`, the datum, `altitude_m`. A default of – is not set: 0 in YAML.

Parameters are read when a node starts, and are read-only from then on, but for the planner's
`slot_side`, `slot_tracks` and `pattern_leg`. A value out of bounds ends the node at start with one
line: parameter, value, what was expected.
"""


def parameters_text() -> str:
    """Return the page."""
    return HEAD + "".join(line + "\n" for node in NODES for line in _table(node))


def _table(node: str) -> Iterator[str]:
    yield from (
        "",
        f"## {node}",
        "",
        "| parameter | default | range | meaning |",
        "|---|---|---|---|",
    )
    for kind in NODES[node]:
        texts, bounds, choices = descriptions(kind), bounds_of(kind), choices_of(kind)
        for name, default in defaults_of(kind).items():
            allowed = " or ".join(map(str, choices.get(name, ()))) or str(bounds[name])
            yield f"| `{name}` | {_shown(default)} | {allowed} | {texts.get(name, '')} |"


def _shown(default: Any) -> str:
    if default is None or default == "" or (isinstance(default, float) and math.isnan(default)):
        return "–"
    if isinstance(default, tuple):
        return f"[{', '.join(map(str, default))}]"
    return str(default).lower() if isinstance(default, bool) else str(default)
