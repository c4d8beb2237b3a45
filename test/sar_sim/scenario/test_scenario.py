import argparse
from pathlib import Path

import pytest
import yaml

from sar_sim.scenario.options import (
    add_flight_options,
    find_scenario,
    new_run_folder,
    scenario_from,
)
from sar_sim.scenario.scenario import (
    Fault,
    Scenario,
    ScenarioError,
    load_scenario,
    scenario_document,
)

SHIPPED = sorted((Path(__file__).parents[3] / "config" / "scenarios").glob("*.yaml"))


def load(tmp_path, text):
    path = tmp_path / "s.yaml"
    path.write_text(text, encoding="utf-8")
    return load_scenario(path)


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_scenarios_load_and_write_back_the_same(path, tmp_path):
    scenario = load_scenario(path)
    assert scenario.name == path.stem
    assert load(tmp_path, yaml.safe_dump(scenario_document(scenario))) == scenario


def test_paper_scenario_is_the_default():
    assert load_scenario(find_scenario("paper")) == Scenario()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("sped: 1", "sped: unknown key"),
        ("corner: {speed: 1}", "corner.speed: unknown key"),
        ("corner: 7", "corner = 7: expected a mapping"),
        ("gps: {rate_hz: fast}", "gps.rate_hz = 'fast': expected a number"),
        ("gps: {rate_hz: 20}", "gps.rate_hz = 20: expected 0.5 to 10"),
        ("gps: {sigma_m: .nan}", "gps.sigma_m = nan: expected a number"),
        ("pattern: {corners: 2.5}", "pattern.corners = 2.5: expected a whole number"),
        ("pattern: {turn_side: 0}", "pattern.turn_side = 0: expected 1"),
        ("name: 5", "name = 5: expected a text"),
        ("uav: {min_radius_m: 150}", "uav.min_radius_m = 150.0: expected not more than"),
        ("datum: {latitude_deg: 95, longitude_deg: 0}", "datum 95.0, 0.0"),
        ("datum: {latitude_deg: 5}", "datum.longitude_deg: missing"),
        ("datum: {place: 5}", "datum.place: unknown key, expected one of latitude_deg, longitude"),
        ("sensor: {footprint: star}", "sensor.footprint = 'star': expected disc or square"),
        ("wind: {speed_mps: true}", "wind.speed_mps = True: expected a number"),
        ("faults: {}", "faults = {}: expected a list"),
        ("faults: [7]", "faults[0] = 7: expected a mapping"),
        ("faults: [{component: gps, kind: off}]", "faults[0].at_s: missing"),
        (
            "faults: [{component: gps, kind: loud, at_s: 1}]",
            "faults[0].kind = 'loud': expected one of off, stuck, garbage",
        ),
        (
            "faults: [{component: radio, kind: stuck, at_s: 1}]",
            "faults[0].kind = 'stuck': expected one of off, slow, intermittent",
        ),
        (
            "faults: [{component: gps, kind: off, at_s: 1}, {component: x, kind: off, at_s: 1}]",
            "faults[1].component = 'x': expected one of gps, radio",
        ),
        ("faults: [{component: gps, kind: off, at_s: -1}]", "faults[0].at_s = -1: expected 0"),
        ("{", "not YAML"),
        ("name: !!bool maybe", "not YAML"),
        ("name: 2001-13-01", "not YAML"),
        ("[" * 3000, "not YAML"),
        ("[1]", "expected a mapping"),
    ],
)
def test_bad_scenarios_name_file_key_value_and_expectation(tmp_path, text, message):
    with pytest.raises(ScenarioError) as error:
        load(tmp_path, text)
    assert str(error.value).startswith(str(tmp_path / "s.yaml"))
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_faults_are_written_back_the_same(tmp_path):
    text = "faults: [{component: gps, kind: wrong, at_s: 60, for_s: 20, size: 150}]"
    scenario = load(tmp_path, text)
    assert scenario.faults == [Fault("gps", "wrong", 60.0, 20.0, 150.0)]
    assert load(tmp_path, yaml.safe_dump(scenario_document(scenario))) == scenario


def test_unknown_names_list_the_known(tmp_path):
    with pytest.raises(ScenarioError, match=r"expected a file or one of .*paper"):
        find_scenario("papr")
    with pytest.raises(ScenarioError, match="no such file"):
        find_scenario(str(tmp_path / "none.yaml"))


def test_seed_and_lag_go_into_the_scenario():
    parser = argparse.ArgumentParser()
    add_flight_options(parser, rule_sets=("paper",))
    scenario = scenario_from(parser.parse_args(["--seed", "9", "--lag", "-50"]))
    assert (scenario.gps.seed, scenario.pilot.seed, scenario.uav.lag_m) == (9, 9, -50.0)


def test_a_folder_with_a_bag_is_not_overwritten(tmp_path):
    out = new_run_folder(tmp_path / "run")
    (out / "bag").mkdir()
    with pytest.raises(ValueError, match="holds a bag already"):
        new_run_folder(out)
