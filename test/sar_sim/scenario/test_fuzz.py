"""Scenarios, parameter files, bags with bytes turned: a line that says so, or a flight; no crash.

``SAR_FUZZ_INPUTS`` inputs of each kind, seeded (a hundredth of them for bags).
"""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sar_estimator.bags.bag import BAG_ERRORS, BagWriter
from sar_sim.flight.offline import OfflineFlight
from sar_sim.launch.launch_plan import read_tuned
from sar_sim.report.flight_data import read_flight
from sar_sim.scenario.scenario import Scenario, ScenarioError, load_scenario, read_document

INPUTS = int(os.environ.get("SAR_FUZZ_INPUTS", "2000"))
CONFIG = Path(__file__).parents[3] / "config"
SCENARIOS = sorted((CONFIG / "scenarios").glob("*.yaml"))
WORDS = (
    b"nan",
    b"-1",
    b"1e999",
    b"[]",
    b"{}",
    b"null",
    b"off",
    b": ",
    b"\x00",
    b"\xff",
    b"*a",
    b"&a ",
)


def turned(rng, data):
    data = bytearray(data)
    for _ in range(rng.integers(1, 4)):
        at = int(rng.integers(len(data)))
        kind = rng.integers(4)
        if kind == 0:
            data[at] = int(rng.integers(256))
        elif kind == 1:
            del data[at : at + int(rng.integers(1, 20))]
        elif kind == 2:
            data[at:at] = WORDS[rng.integers(len(WORDS))]
        else:
            begin = int(rng.integers(len(data)))
            data[at:at] = data[begin : begin + int(rng.integers(1, 20))]
        if not data:
            return b" "
    return bytes(data)


def read_parameters(path):
    return read_tuned(read_document(path), str(path))


def refusal(read, kind, path):
    try:
        assert isinstance(read(path), kind)
    except ScenarioError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    ("read", "kind", "files"),
    [(load_scenario, Scenario, SCENARIOS), (read_parameters, dict, [CONFIG / "params.yaml"])],
    ids=["scenario", "parameters"],
)
def test_files_with_bytes_turned(tmp_path, read, kind, files):
    rng = np.random.default_rng(6)
    path = tmp_path / "s.yaml"
    texts = [file.read_bytes() for file in files]
    refused = 0
    for _ in range(INPUTS):
        path.write_bytes(turned(rng, texts[rng.integers(len(texts))]))
        told = refusal(read, kind, path)
        refused += bool(told)
        assert "\n" not in told
        assert not told or told.startswith(str(path))
    assert 0 < refused < INPUTS


@pytest.mark.parametrize("document", [None, 7, [], {"planner": 7}, {7: {}}, {"planner": {"x": 1}}])
def test_parameter_files_that_are_something_else(document):
    with pytest.raises(ScenarioError, match=r"p\.yaml: "):
        read_tuned(document, "p.yaml")


def test_bags(tmp_path):
    rng = np.random.default_rng(7)
    scenario = Scenario()
    short = replace(scenario.pattern, first_leg_m=600.0, last_leg_m=400.0, corners=1)
    bag = BagWriter(tmp_path / "bag")
    try:
        OfflineFlight(replace(scenario, pattern=short), bag=bag).run()
    finally:
        bag.close()
    files = {item: item.read_bytes() for item in (tmp_path / "bag").iterdir()}
    read = 0
    for i in range(max(10, INPUTS // 100)):
        for item, data in files.items():
            mcap = item.suffix == ".mcap"
            kept = data[: int(rng.integers(len(data)))] if mcap and i % 2 else data
            item.write_bytes(turned(rng, kept) if kept and (mcap or i % 5 == 0) else kept)
        try:
            read_flight(tmp_path / "bag")
            read += 1
        except BAG_ERRORS:
            continue
    assert read > 0
