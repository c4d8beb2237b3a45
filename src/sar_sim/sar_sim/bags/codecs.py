"""What the simulation tells as text: the scenario, and every corner as it really was."""

from __future__ import annotations

import json
from dataclasses import asdict

from sar_sim.scenario.scenario import Scenario, scenario_document
from sar_sim.world.helicopter import CornerTruth


def corner_truth_text(corner: CornerTruth) -> str:
    """Return a true corner as JSON; its poses as x, y and heading."""
    return json.dumps(asdict(corner))


def scenario_text(scenario: Scenario) -> str:
    """Return a scenario as JSON."""
    return json.dumps(scenario_document(scenario))
