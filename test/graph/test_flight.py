import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from sar_estimator.bags.bag import open_bag, read_messages
from sar_estimator.common.wires import WIRES
from sar_estimator.estimation.parameters import VELOCITY_SIGMA_MPS, EstimatorParameters
from sar_sim.flight.replay import Tolerance
from sar_sim.flight.replay_cli import replayed
from sar_sim.launch.launch_cli import free_port

pytestmark = [pytest.mark.graph, pytest.mark.timeout(180)]
ROOT = Path(__file__).parents[2]
REAL = Path(
    os.environ.get("SAR_TEST_DATA", ROOT.parent / "shared" / "data"),
    "helicopter",
    "samu31_toulouse_1hz.csv",
)
RESULTS = {"bag", "log", "params.yaml", "scenario.yaml", "metrics.json", "map.png", "corner.png",
           "lag.png", "report.html"}  # fmt: skip


def metrics(out):
    return json.loads((out / "metrics.json").read_text(encoding="utf-8"))


def await_true(condition, timeout_s=60.0):
    deadline = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.1)


def bag_size(flight):
    bag = flight.out / "bag" / "bag.mcap"
    return bag.stat().st_size if bag.exists() else 0


def flown_offline(out):
    """Fly the short mission without ROS."""
    fly = str(ROOT / "install/sar_sim/lib/sar_sim/fly")
    subprocess.run(
        [fly, "--scenario", "short", "--out", str(out), "--quiet"],
        cwd=ROOT, check=True, capture_output=True, timeout=100,
    )  # fmt: skip
    return metrics(out)


def test_short_mission_end_to_end_agrees_with_the_offline_flight(launch, tmp_path):
    # At a speed at which no fix is lost while a process of a busy machine waits for its turn.
    flight = launch("--scenario", "short", "--speed", "5")
    code, output, errors = flight.wait()
    assert (code, errors) == (0, "")
    assert {item.name for item in flight.out.iterdir()} == RESULTS
    for word in ("leg ", "corner k=", "rule ", "L ", "separation ", "bag "):
        assert word in output
    found = metrics(flight.out)
    expected = flown_offline(tmp_path / "offline")
    assert found["lag_m"][:1] == pytest.approx(expected["lag_m"][:1], abs=10.0)
    # It is still catching up at 2 m/s there, and a list some seconds later shows.
    assert found["lag_m"][1:] == pytest.approx(expected["lag_m"][1:], abs=30.0)
    assert found["rules"] == ["D2", "D4"]  # the first by one that was not seen to turn yet
    assert found["min_separation_m"] > 200.0
    # Two corners with their manoeuvres, and so little between that a list a second later shows.
    assert expected["coverage_percent"] > 98.0
    assert found["coverage_percent"] == pytest.approx(expected["coverage_percent"], abs=0.5)
    topics = {topic for topic, _, _ in read_messages(flight.out / "bag")}
    assert {"/clock", "/uav/state", "/uav/uploaded", "/markers", "/diagnostics"} <= topics
    # What its estimator made of the fixes is what it makes of them without ROS.
    found, events = replayed(
        flight.out / "bag",
        Tolerance(figures=1.0, time_s=0.3),
        estimator=EstimatorParameters(),
        velocity_sigma_mps=VELOCITY_SIGMA_MPS,
    )
    legs = sum(topic == "/helicopter/leg" for topic, _, _ in events)
    assert found.same["/helicopter/leg"] == legs > 100
    assert found.same["/uav/cleared"] >= 5


def test_arduplanes_guidance_is_led_around_corners_by_lists_in_banks(launch, tmp_path):
    scenario = tmp_path / "windy.yaml"
    scenario.write_text(
        "pattern: {first_leg_m: 2000.0, last_leg_m: 600.0, corners: 2}\n"
        "gps: {sigma_m: 3.0}\n"
        "wind: {speed_mps: 4.0, from_deg: 45.0}\n"
        "uav: {autopilot: arduplane, lag_m: 50.0}\n"
    )
    flight = launch("--scenario", str(scenario))
    code, _, errors = flight.wait()
    assert (code, errors) == (0, "")
    found = metrics(flight.out)
    assert max(abs(lag) for lag in found["lag_m"][1:]) < 25.0
    assert found["min_separation_m"] > 180.0
    told = {}
    for topic, _, message in read_messages(flight.out / "bag"):
        told.setdefault(topic, []).append(message)
    parameters = WIRES["/uav/autopilot"].from_message(told["/uav/autopilot"][-1])
    assert parameters["NAVL1_PERIOD"] == 15.0
    wind = told["/uav/wind"][-1].vector
    assert (wind.x, wind.y) == pytest.approx((-2.83, -2.83), abs=0.1)
    uploaded = map(WIRES["/uav/uploaded"].from_message, told["/uav/uploaded"])
    uploads = [one.upload_ms for one in uploaded]
    assert len(uploads) > 5
    assert np.median(uploads) < 1000.0


def test_control_c_in_flight_closes_the_bag_and_reports(launch):
    # At a speed at which a busy machine's clock does not jump by a second.
    flight = launch("--scenario", "short", "--speed", "3")
    await_true(lambda: bag_size(flight) > 140_000)
    flight.process.send_signal(signal.SIGINT)
    code, output, _ = flight.wait()
    assert code == 0
    assert "stopped by SIGINT" in output
    assert {item.name for item in flight.out.iterdir()} == RESULTS
    stamps = [t for topic, t, _ in read_messages(flight.out / "bag") if topic == "/sim/uav"]
    assert np.diff(stamps).max() < 1.0
    assert len(stamps) > 100


def test_simulation_that_dies_stops_the_run_with_its_name(launch):
    flight = launch("--scenario", "short")
    await_true(lambda: bag_size(flight) > 60_000)
    os.kill(flight.nodes()["sim"], signal.SIGKILL)
    code, _, errors = flight.wait()
    assert code == 1
    assert "node sim ended with exit code -9" in errors
    assert (flight.out / "report.html").exists()


@pytest.mark.timeout(300)
def test_nodes_that_are_killed_are_started_again_and_take_up_their_work(launch):
    speed = 2.0
    flight = launch("--scenario", "short", "--speed", str(speed))
    await_true(lambda: bag_size(flight) > 140_000)
    victims = ("planner", "monitor", "bridge", "estimator")
    for name in victims:
        old = flight.nodes()[name]
        os.kill(old, signal.SIGKILL)
        await_true(lambda name=name, old=old: flight.nodes().get(name, old) != old)
        time.sleep(5.0)
    code, _, errors = flight.wait(250.0)
    assert code == 0
    told = {name: [] for name in victims}
    lists, modes = [], []
    for topic, time_s, message in read_messages(flight.out / "bag"):
        if topic == "/uav/uploaded":
            lists.append(time_s)
        if topic == "/planner/mode":
            modes.append(message.data)
        if topic == "/diagnostics":
            for status in message.status:
                if status.name in told:
                    told[status.name].append(time_s)
    for name in victims:
        assert f"node {name} ended with exit code -9: started again" in errors
        assert np.diff(told[name]).max() / speed < 20.0, name
    found = metrics(flight.out)
    assert found["min_separation_m"] > 100.0  # what the monitor keeps
    # By which rule, and how soon L(1) = 600 m is gone, depends on when they were killed, and on how
    # long a machine takes to start them again; that the UAV is led to the end does not.
    assert modes[-1] != "idle"
    assert len(found["rules"]) >= 1
    # It was led again after the last of them had come back.
    back = told["estimator"][1 + int(np.argmax(np.diff(told["estimator"])))]
    assert max(lists) > back


def test_page_and_recorder_that_die_end_neither_flight_nor_report(launch):
    port = str(free_port(socket.SOCK_STREAM))
    flight = launch("--scenario", "short", "--speed", "6", "--console-port", port)
    await_true(lambda: bag_size(flight) > 60_000)
    page = flight.nodes()["console"]
    os.kill(page, signal.SIGSTOP)
    before = bag_size(flight)
    await_true(lambda: bag_size(flight) > before + 60_000)  # a page that hangs changes nothing
    os.kill(page, signal.SIGKILL)
    await_true(lambda: bag_size(flight) > before + 120_000)
    os.kill(flight.nodes()["record"], signal.SIGKILL)
    killed = bag_size(flight)
    code, output, errors = flight.wait(150.0)
    assert code == 0
    assert "node console ended with exit code -9: flying on, without a page" in errors
    assert "node record ended with exit code -9: flying on" in errors
    assert "hangs" not in errors
    assert "least separation" in output
    assert bag_size(flight) == killed
    assert not (flight.out / "bag" / "metadata.yaml").exists()
    assert {item.name for item in flight.out.iterdir()} == RESULTS | {"console.txt"}
    stamps = [t for topic, t, _ in read_messages(flight.out / "bag") if topic == "/clock"]
    assert stamps[-1] - stamps[0] > 10.0


def test_a_launcher_that_is_killed_leaves_nothing_running(launch):
    flight = launch("--scenario", "short")
    await_true(lambda: bag_size(flight) > 20_000)
    flight.process.kill()
    flight.process.communicate()
    await_true(lambda: flight.nodes() == {}, timeout_s=20.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--scenario", "nowhere"], "expected a file or one of"),
        (["--no-sim"], "--no-sim: expected --autopilot URL"),
        (["--autopilot", "com3"], "autopilot URL 'com3': expected udp:HOST:PORT"),
        (["--helicopter", "none.csv"], "none.csv: no such file or bag"),
        (["--params", "none.yaml"], "none.yaml"),
    ],
)
def test_bad_options_start_nothing(launch, options, message):
    flight = launch(*options)
    code, _, errors = flight.wait(30.0)
    assert code == 2
    assert message in errors
    assert errors.count("\n") == 1
    assert not flight.out.exists()


@pytest.mark.parametrize(
    ("node", "given", "message"),
    [
        ("planner", "reaction_s: -1.0", "reaction_s = -1.0: expected 0 or more"),
        ("monitor", "escape_seperation_m: 90.0", "escape_seperation_m = 90.0: unknown, expected"),
    ],
)
def test_bad_parameter_of_a_node_ends_the_run_with_its_line(launch, tmp_path, node, given, message):
    params = tmp_path / "p.yaml"
    params.write_text(f"{node}: {{ros__parameters: {{{given}}}}}\n", encoding="utf-8")
    code, _, errors = launch("--scenario", "short", "--params", str(params)).wait()
    assert code == 1
    assert f"node {node} ended with exit code 2" in errors
    assert message in errors


def test_a_simulation_that_flies_alone_names_what_it_did_not_hear(own_domain):
    sim = ROOT / "install/sar_sim/lib/sar_sim/sim"
    scenario = ROOT / "config/scenarios/paper.yaml"
    given = [item for name, value in
             (("scenario", scenario), ("mavlink_ports", "[14877]"), ("patience_s", 1.0))
             for item in ("-p", f"{name}:={value}")]  # fmt: skip
    ended = subprocess.run(
        [str(sim), "--ros-args", *given],
        env=own_domain,
        capture_output=True, text=True, timeout=30, check=False,
    )  # fmt: skip
    assert ended.returncode == 2
    assert ended.stderr == (
        "sim: not heard of within 1.0 s: estimator, planner, bridge, "
        "1 of the listeners on /helicopter/fix, the service /planner/engage\n"
    )


def test_operator_and_nodes_run_one_by_one(own_domain):
    """Installed executables started by hand, as ``ros2 run`` does."""
    environment = own_domain
    planner = subprocess.Popen(
        [str(ROOT / "install/sar_planner/lib/sar_planner/planner")],
        env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        operator = str(ROOT / "install/sar_bridge/lib/sar_bridge/operator")
        refused = subprocess.run(
            [operator, "engage"], env=environment, capture_output=True, text=True, timeout=40,
            check=False,
        )  # fmt: skip
        assert refused.returncode == 1
        assert "engage: no heartbeat from the autopilot" in refused.stdout
        absent = subprocess.run(
            [operator, "return_home", "--timeout", "1"], env=environment, capture_output=True,
            text=True, timeout=40, check=False,
        )  # fmt: skip
        assert absent.returncode == 2
        assert "no such service is running" in absent.stderr
    finally:
        planner.send_signal(signal.SIGINT)
        _, errors = planner.communicate(timeout=20)
    assert planner.returncode == 0
    assert "Traceback" not in errors


def play(bag, environment, *options):
    program = str(ROOT / "install/sar_sim/lib/sar_sim/play")
    return subprocess.run(
        [program, str(bag), *options], capture_output=True, text=True, timeout=100, check=False,
        env=environment,
    )  # fmt: skip


def test_played_bag_drives_a_live_estimator(own_domain, tmp_path):
    """What was recorded offline is played at 20 times its pace; the estimator sees the corners."""
    flown_offline(tmp_path / "flown")
    environment = own_domain
    library = ROOT / "install"
    commands = {
        "record": [library / "sar_sim/lib/sar_sim/record", "bag:=" + str(tmp_path / "bag")],
        "estimator": [library / "sar_estimator/lib/sar_estimator/estimator"],
    }
    running = [
        subprocess.Popen(
            [str(program), "--ros-args", "-p", "use_sim_time:=true"]
            + [word for value in values for word in ("-p", value)],
            env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )
        for program, *values in commands.values()
    ]  # fmt: skip
    try:
        time.sleep(2.0)
        options = ("--rate", "20", "--topics", "/helicopter/fix")
        played = play(tmp_path / "flown" / "bag", environment, *options)
        assert played.returncode == 0, played.stderr
        assert "messages played" in played.stdout
        time.sleep(1.0)
    finally:
        for process in running:
            process.send_signal(signal.SIGINT)
        codes = [process.wait(timeout=20) for process in running]
    assert codes == [0, 0]
    heard = [
        message.data
        for topic, _, message in read_messages(tmp_path / "bag", {"/helicopter/phase"})
        if topic == "/helicopter/phase"
    ]
    assert heard.count("decelerating") == 2


def test_playing_no_bag_is_one_line(own_domain, tmp_path):
    played = play(tmp_path, own_domain)
    assert played.returncode == 2
    assert played.stderr.count("\n") == 1


@pytest.mark.skipif(not REAL.exists(), reason=f"{REAL.name}: recorded track not here")
def test_real_helicopter_through_the_graph(launch, tmp_path):
    """As a bag, imported from the CSV file that it was recorded in."""
    importer, track = str(ROOT / "install/sar_sim/lib/sar_sim/import_track"), tmp_path / "track"
    subprocess.run([importer, str(REAL), str(track)], check=True, timeout=60)
    flight = launch("--helicopter", str(track), "--speed", "20")
    code, _, errors = flight.wait()
    assert (code, errors) == (0, "")
    assert {item.name for item in flight.out.iterdir()} == RESULTS
    motions = [
        (message.pose.pose.position.x, message.pose.pose.position.y,
         message.twist.twist.linear.x, message.twist.twist.linear.y)
        for _, _, message in read_messages(flight.out / "bag", {"/helicopter/odometry"})
    ]  # fmt: skip
    assert len(motions) > 1000  # ten a second, less where the machine is slow
    assert np.isfinite(motions).all()
    assert metrics(flight.out)["duration_s"] == pytest.approx(377.0, abs=10.0)
    with open_bag(flight.out / "bag") as bag:
        assert bag.duration < 400e9  # nothing is stamped before the clock began


FEEDER = """
import sys, time, rclpy
from rclpy.qos import qos_profile_sensor_data
from sar_estimator.common.geodesy import Datum
from sar_estimator.common.gps_fix import Fix
from sar_estimator.common.conversions import fix_to_message
from sensor_msgs.msg import NavSatFix
rclpy.init()
node = rclpy.create_node("gps")
sender = node.create_publisher(NavSatFix, "/helicopter/fix", qos_profile_sensor_data)
datum, begun = Datum(37.8, -122.8), time.time()
while time.time() - begun < 80.0:
    latitude, longitude, _ = datum.to_geodetic(0.0, 20.0 * (time.time() - begun))
    sender.publish(fix_to_message(Fix(time.time(), latitude, longitude)))
    time.sleep(0.2)
"""


def test_live_helicopter_beside_the_simulated_uav(launch):
    """A GPS driver of the user's own: real time, no /clock; the UAV appears and follows."""
    flight = launch("--helicopter", "topic")
    feeder = subprocess.Popen(
        [sys.executable, "-c", FEEDER], env=flight.environment, stdout=subprocess.DEVNULL
    )
    try:
        time.sleep(30.0)
        flight.process.send_signal(signal.SIGINT)
        code, output, errors = flight.wait()
    finally:
        feeder.kill()
        feeder.wait()
    assert (code, errors) == (0, "")
    assert "rule leg" in output
    uploaded = [m for _, _, m in read_messages(flight.out / "bag", {"/uav/uploaded"})]
    assert uploaded
    assert metrics(flight.out)["min_separation_m"] > 200.0
    assert metrics(flight.out)["duration_s"] > 5.0
