"""The MAVLink links of a world's simulated autopilots."""

from __future__ import annotations

from collections.abc import Sequence

from sar_sim.autopilot.link import AutopilotLink, Monotonic
from sar_sim.autopilot.server import AutopilotServer
from sar_sim.world.world import World


def links_of(world: World, ports: Sequence[int], clock: Monotonic) -> dict[str, AutopilotLink]:
    """Return the link of every UAV, by its name, to a ground station at a UDP port of its own.

    Raises ``ValueError`` where there are not as many ports as UAVs.
    """
    scenario = world.scenario
    if len(ports) != len(world.autopilots):
        expected = f"one for each of {len(world.autopilots)} UAVs"
        raise ValueError(f"parameter mavlink_ports = {list(ports)}: expected {expected}")
    found = {}
    for member, port in zip(scenario.formation, ports, strict=True):
        autopilot = world.autopilots[member.name]
        server = AutopilotServer(autopilot, world.datum, system=member.system_id)
        found[member.name] = AutopilotLink(
            server,
            port,
            clock,
            scenario.faults,
            scenario.gps.seed,
            system=member.system_id,
        )
    return found
