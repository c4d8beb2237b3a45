"""The page of a desk whose state a test chooses by a file: ``desk_server.py PORT FOLDER UAV...``.

The file has a word for each UAV, or one for all.
"""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from conftest import formation, told
from sar_bridge.console.banner import banner, worst
from sar_bridge.console.live import ACTIONS
from sar_bridge.console.map_view import Search
from sar_bridge.console_node import show
from sar_estimator.common.reports import MonitorReport, UavStatus
from sar_estimator.common.states import Phase

PORT, FOLDER = int(sys.argv[1]), Path(sys.argv[2])
UAVS = tuple(sys.argv[3:]) or ("",)
REASON = "150 m in 12 s if the helicopter turns"


def with_node(name, *args, **options):
    well = formation()
    return replace(well, nodes={**well.nodes, name: told(name, *args, **options)})


def alerted(alert):
    return replace(formation(), monitor=MonitorReport(alert, REASON, thresholds={}))


STATES = {
    "well": formation(),
    "idle": replace(formation(), rule="idle"),
    "caution": alerted("caution"),
    "warning": alerted("warning"),
    "escape": alerted("escape"),
    "gps": replace(formation(), phase=Phase.LOST),
    "stale": replace(formation(), helicopter_age_s=5.0, uav_age_s=5.0),
    "link": replace(formation(), status=UavStatus("AUTO", armed=True, connected=False)),
    "silent": with_node("planner", age_s=9.0),
    "released": replace(
        with_node("planner", "released: the UAV was taken to mode LOITER"), rule="idle"
    ),
    "script": with_node("planner", "<script>window.hacked = true</script><b>bold</b>"),
}


def beside(snapshot, n):
    """Return the n-th UAV's: from the second on on the other side of the helicopter."""
    if n == 0:
        return snapshot
    planner = snapshot.nodes["planner"]
    health = replace(planner.health, values={**planner.health.values, "slot": "outside 2"})
    nodes = {**snapshot.nodes, "planner": replace(planner, health=health)}
    motion = snapshot.uav.motion
    there = snapshot.uav._replace(motion=motion._replace(y_m=n * 250.0))
    helicopter, uav = snapshot.tracks
    snapshot = replace(snapshot, nodes=nodes)
    return replace(snapshot, uav=there, tracks=(helicopter, uav + np.array([0.0, 250.0 * (n + 1)])))


class Desk:
    """Shows what the file ``state`` names, and writes to ``asked`` what is asked for."""

    actions = ACTIONS
    search = Search()
    quiet = ""

    def snapshots(self):
        words = (FOLDER / "state").read_text("utf-8").split()
        answers = ("engage: no UAV position",)
        return {
            uav: replace(beside(STATES[word], n), callsign=uav, quiet=self.quiet, answers=answers)
            for n, (uav, word) in enumerate(zip(UAVS, words * len(UAVS), strict=False))
        }

    def free_gb(self):
        return 50.0

    def ask(self, action, uav):
        self.write([action, uav] if uav else action)

    def mark(self, x_m, y_m):
        self.write(["mark", round(x_m), round(y_m)])

    def give_slot(self, side, tracks, uav):
        self.write(["slot", side, tracks, uav])

    def write(self, what):
        with (FOLDER / "asked").open("a", encoding="utf-8") as file:
            file.write(json.dumps(what) + "\n")

    def acknowledge(self):
        self.quiet = worst(map(banner, self.snapshots().values())).key

    def span_s(self):
        return None

    def seek(self, time_s):
        """Nothing else can be shown."""


if __name__ in ("__main__", "__mp_main__"):
    tiles = FOLDER / "tiles"
    show(Desk(), PORT, str(FOLDER / "address"), str(tiles) if tiles.is_dir() else "")
