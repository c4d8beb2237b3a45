"""``receiver``: a scenario's helicopter as a GPS receiver at a pseudo-terminal, in real time.

To try a laptop, its port names and ``--gps`` on the ground, without a helicopter.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from dataclasses import replace
from pathlib import Path

from sar_estimator.estimation.parameters import VELOCITY_SIGMA_MPS
from sar_sim.scenario.options import find_scenario
from sar_sim.scenario.scenario import Scenario, ScenarioError, load_scenario
from sar_sim.trials.receiver_speech import nmea, ubx
from sar_sim.trials.receiver_terminal import terminal
from sar_sim.world.world import World

PROTOCOLS = ("ubx", "nmea")
STEP_S = 0.1


def speak(scenario: Scenario, protocol: str, link: Path | None) -> None:
    """Fly to the end; what nobody reads is lost, as at a port."""
    gps = scenario.gps
    sigma_m, sigma_mps = gps.reported_sigma_m, gps.doppler_sigma_mps or VELOCITY_SIGMA_MPS
    # Every receiver at a port tells a velocity.
    world = World(replace(scenario, gps=replace(gps, doppler_sigma_mps=sigma_mps)))
    with terminal() as (controller, device):
        os.set_blocking(controller, False)
        if link is not None:
            link.unlink(missing_ok=True)
            link.symlink_to(device)
        sys.stdout.write(f"{link or device}\n")
        sys.stdout.flush()
        begun, utc_s = time.monotonic(), time.time()
        while not world.finished:
            for reception in world.step():
                at_s = utc_s + reception.fix.time_s
                if protocol == "ubx":
                    data = ubx(reception, at_s, sigma_m, sigma_mps)
                else:
                    data = nmea(reception, at_s, sigma_m)
                try:
                    os.write(controller, data)
                except BlockingIOError:
                    continue
            time.sleep(max(0.0, begun + world.time_s - time.monotonic()))


def main(argv: list[str] | None = None) -> int:
    """Print the device, and speak until the flight is over; 2 on bad input."""
    parser = argparse.ArgumentParser(prog="receiver", description=__doc__)
    parser.add_argument("--scenario", default="human", help="a scenario's name or YAML file")
    parser.add_argument("--protocol", choices=PROTOCOLS, default="ubx", help="what it speaks")
    parser.add_argument("--link", type=Path, help="a name for the device, to be made")
    args = parser.parse_args(argv)
    try:
        speak(load_scenario(find_scenario(args.scenario)), args.protocol, args.link)
    except (OSError, ScenarioError) as error:
        sys.stderr.write(f"receiver: {error}\n")
        return 2
    except KeyboardInterrupt:
        return 0
    return 0


if __name__ == "__main__":
    sys.exit(main())
