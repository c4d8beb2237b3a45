from pathlib import Path

import pytest

from sar_sim.launch.launch_plan import (
    FlightOptions,
    leg_flown,
    parameter_document,
    plan_nodes,
    read_tuned,
    with_autopilots,
)
from sar_sim.scenario.formation import Member
from sar_sim.scenario.scenario import Scenario, ScenarioError


def plan(options, tuned=None):
    given = [options.autopilot] if options.autopilot else []
    scenario = with_autopilots(Scenario(), given)
    specs = plan_nodes(
        scenario, Path("s.yaml"), options, bag=Path("bag"), ports=[15000], tuned=tuned or {}
    )
    return {spec.executable: spec.parameters for spec in specs}


def test_whole_simulation():
    nodes = plan(FlightOptions(), {"planner": {"reaction_s": 3.0, "rules": "other"}})
    assert list(nodes) == ["record", "estimator", "planner", "monitor", "bridge", "sim"]
    assert nodes["monitor"]["min_separation_m"] == 200.0
    assert nodes["bridge"]["autopilot_url"] == "udp:127.0.0.1:15000"
    assert nodes["estimator"]["datum_latitude_deg"] == 37.8
    assert nodes["planner"]["reaction_s"] == 3.0
    assert nodes["planner"]["rules"] == "deadbeat"
    assert nodes["planner"]["taylor_y_m"] == 0.0
    assert nodes["sim"]["speed"] == 10.0
    assert all(nodes[name]["use_sim_time"] for name in nodes if name != "sim")


def test_real_autopilot_with_a_simulated_helicopter():
    nodes = plan(FlightOptions(autopilot="tcp:127.0.0.1:5760"))
    assert nodes["bridge"]["autopilot_url"] == "tcp:127.0.0.1:5760"
    assert nodes["sim"]["uav"] is False
    assert nodes["sim"]["speed"] == 1.0


def test_a_real_flight_simulates_nothing():
    nodes = plan(FlightOptions("topic", "/dev/ttyUSB0,57600", "paper", None, simulation=False))
    assert "sim" not in nodes
    assert not nodes["planner"]["use_sim_time"]
    assert "datum_latitude_deg" not in nodes["estimator"]


def test_a_receiver_of_ones_own_is_read_before_everything_else():
    real = FlightOptions("topic", "/dev/ttyUSB0,57600", simulation=False, gps="/dev/ttyACM0,38400")
    nodes = plan(real, {"gps": {"uere_m": 4.0}})
    assert list(nodes)[:3] == ["record", "gps", "estimator"]
    assert nodes["gps"] == {
        "receiver": "/dev/ttyACM0,38400",
        "uere_m": 4.0,
        "use_sim_time": False,
    }
    assert "gps" not in plan(FlightOptions("topic"))
    with pytest.raises(ScenarioError, match=r"--gps gpsd:h: expected no --helicopter flight.csv"):
        FlightOptions("flight.csv", gps="gpsd:h")


def test_live_helicopter_with_the_simulated_uav():
    nodes = plan(FlightOptions("topic"))
    assert nodes["sim"]["live_helicopter"]
    assert nodes["sim"]["speed"] == 1.0


def test_recorded_track():
    nodes = plan(FlightOptions("flight.csv"))
    assert nodes["sim"]["track"] == "flight.csv"
    assert nodes["estimator"]["default_fix_sigma_m"] == 10.0
    assert "datum_latitude_deg" not in nodes["estimator"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"simulation": False}, "--no-sim: expected --autopilot"),
        (
            {
                "simulation": False,
                "autopilot": "udp:1.2.3.4:5",
                "helicopter": "topic",
                "watch_only": True,
            },
            "--watch-only: expected a simulation",
        ),
        (
            {"simulation": False, "autopilot": "udp:1.2.3.4:5"},
            "--no-sim: expected --gps URL, or --helicopter topic",
        ),
        (
            {"simulation": False, "autopilot": "udp:1.2.3.4:5", "helicopter": "a.csv"},
            "--no-sim: exp",
        ),
        (
            {
                "simulation": False,
                "autopilot": "udp:1.2.3.4:5",
                "helicopter": "topic",
                "engage": True,
            },
            "--engage: expected a simulation; in a flight the operator engages",
        ),
        (
            {"autopilot": "udp:1.2.3.4:5", "helicopter": "topic", "engage": True},
            "--engage: expected a simulation",
        ),
        ({"engage": True}, "--engage: expected --autopilot URL"),
        ({"speed": 0.0}, "--speed 0.0"),
        ({"speed": 5.0, "helicopter": "topic"}, "--speed 5.0: a live helicopter flies at 1"),
    ],
)
def test_combinations_that_make_no_flight(options, message):
    with pytest.raises(ScenarioError, match=message):
        FlightOptions(**options)


def test_parameter_files():
    values = {"reaction_s": 1.0, "rules": "paper", "corners": 3, "on": True, "rows": [1.0, 2.0]}
    document = {"planner": {"ros__parameters": values}}
    assert read_tuned(document, "p.yaml") == {"planner": values}
    for bad, message in (
        ([1], "p.yaml: expected node names"),
        ({"pilot": {}}, "p.yaml: pilot: expected one of"),
        ({"planner": {"reaction_s": 1}}, "p.yaml: planner: expected a mapping ros__parameters"),
        ({"planner": {"ros__parameters": {"reaction_s": None}}}, "planner: reaction_s = None: exp"),
        ({"planner": {"ros__parameters": {"air": {"a": 1}}}}, "planner: air = {'a': 1}: expected"),
        ({"planner": {"ros__parameters": {"rows": [1, "a"]}}}, "planner: rows = .*: expected"),
        ({"planner": {"ros__parameters": {"rows": []}}}, "planner: rows = .*: expected"),
        ({"planner": {"ros__parameters": {7: 1}}}, "planner: 7 = 1: expected"),
    ):
        with pytest.raises(ScenarioError, match=message):
            read_tuned(bad, "p.yaml")


def test_parameter_document_has_a_block_per_node():
    specs = plan_nodes(
        Scenario(), Path("s.yaml"), FlightOptions(), bag=Path("bag"), ports=[1], tuned={}
    )
    document = parameter_document(specs)
    assert document["bridge"]["ros__parameters"]["autopilot_url"] == "udp:127.0.0.1:1"


@pytest.mark.parametrize(
    ("corner", "rule", "phase", "leg"),
    [
        (0, "leg", "cruise", 1),
        (1, "D4", "decelerating", 1),
        (1, "D4", "cruise", 1),
        (1, "RJ", "accelerating", 1),
        (1, "T2", "stopped", 1),
        (1, "leg", "cruise", 2),
        (1, "rejoin", "cruise", 2),
        (2, "leg", "decelerating", 2),
        (0, "leg", "decelerating", 1),
    ],
)
def test_in_a_corner_the_leg_is_the_one_before_it(corner, rule, phase, leg):
    assert leg_flown(corner, rule, phase) == leg


PAIR = Scenario(formation=[Member("uav1"), Member("uav2", "outside", system_id=2)])


def planned(scenario, options, ports):
    return plan_nodes(scenario, Path("s.yaml"), options, bag=Path("bag"), ports=ports, tuned={})


def test_every_uav_has_planner_monitor_and_bridge_in_its_namespace():
    specs = planned(PAIR, FlightOptions(console=8080), [15000, 15001])
    nodes = {spec.name: spec.parameters for spec in specs}
    own = [f"{uav}/{node}" for uav in ("uav1", "uav2") for node in ("planner", "monitor", "bridge")]
    assert list(nodes) == ["record", "estimator", *own, "console", "sim"]
    assert nodes["uav2/planner"]["slot_side"] == "outside"
    assert nodes["uav2/planner"]["yields_to"] == ["uav1"]
    assert "yields_to" not in nodes["uav1/planner"]  # an empty list has no type in ROS
    assert nodes["uav1/monitor"]["others"] == ["uav2"]
    assert nodes["uav2/monitor"]["others"] == ["uav1"]
    bridges = [nodes["uav1/bridge"], nodes["uav2/bridge"]]
    assert [one["autopilot_url"][-5:] for one in bridges] == ["15000", "15001"]
    assert [one["altitude_m"] for one in bridges] == [150.0, 210.0]
    assert [one["target_system"] for one in bridges] == [1, 2]
    assert nodes["console"]["uavs"] == ["uav1", "uav2"]
    assert nodes["sim"]["mavlink_ports"] == [15000, 15001]
    document = parameter_document(specs)
    assert document["/uav2/planner"]["ros__parameters"] == nodes["uav2/planner"]
    assert document["estimator"]["ros__parameters"] == nodes["estimator"]


def test_autopilots_are_given_by_name():
    given = ["uav2=tcp:127.0.0.1:5770", "uav1=udp:127.0.0.1:14550"]
    flown = with_autopilots(PAIR, given)
    assert [one.autopilot for one in flown.formation] == [
        "udp:127.0.0.1:14550",
        "tcp:127.0.0.1:5770",
    ]
    assert with_autopilots(PAIR, []) == PAIR
    alone = with_autopilots(Scenario(), ["/dev/ttyUSB0,57600"])
    assert alone.formation[0].autopilot == "/dev/ttyUSB0,57600"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["tcp:h:1"], r"--autopilot tcp:h:1: expected NAME=URL, one of uav1, uav2"),
        (["uav3=tcp:h:1"], r"--autopilot uav3=tcp:h:1: expected one of uav1, uav2"),
        (["uav1=tcp:h:1"], r"--autopilot: none for uav2: expected one for each UAV"),
    ],
)
def test_autopilots_that_do_not_fit_the_formation_are_refused(given, message):
    with pytest.raises(ScenarioError, match=message):
        with_autopilots(PAIR, given)


def test_uavs_on_one_radio_have_a_hub_between():
    url = "/dev/ttyUSB0,57600"
    flown = with_autopilots(PAIR, [f"uav1={url}", f"uav2={url}"])
    real = FlightOptions("topic", url, simulation=False)
    nodes = {spec.name: spec.parameters for spec in planned(flown, real, [15000, 15001])}
    assert nodes["radio_hub"]["radio_url"] == url
    assert nodes["radio_hub"]["ports"] == [15000, 15001]
    assert nodes["uav2/bridge"]["autopilot_url"] == "udp:127.0.0.1:15001"
    assert nodes["uav2/bridge"]["target_system"] == 2
    # A bridge that falls silent must be missed by its own UAV, whoever else is heard on the radio.
    systems = [nodes[f"{uav}/bridge"]["source_system"] for uav in ("uav1", "uav2")]
    assert systems == [255, 254]
    apart = with_autopilots(PAIR, [f"uav1={url}", "uav2=tcp:h:1"])
    nodes = {spec.name: spec.parameters for spec in planned(apart, real, [15000, 15001])}
    assert "radio_hub" not in nodes
    assert nodes["uav1/bridge"]["autopilot_url"] == url
    assert "source_system" not in nodes["uav1/bridge"]
