"""Two UAVs behind one helicopter: each with its own nodes, one page, one report."""

import json
import signal
import socket
import time

import pytest
import yaml

from sar_sim.launch.launch_cli import free_port

pytestmark = [pytest.mark.graph, pytest.mark.timeout(300)]
SCENARIO = {
    "name": "two",
    "pattern": {"first_leg_m": 1500.0, "corners": 2, "track_spacing_m": 750.0},
    "pilot": {"kind": "human"},
    "gps": {"receiver": "modern"},
    "uav": {"autopilot": "arduplane", "lag_m": 100.0},
    "formation": [{"name": "uav1"}, {"name": "uav2", "side": "outside"}],
}


def started(launch, tmp_path, *options, **changes):
    file = tmp_path / "two.yaml"
    file.write_text(yaml.safe_dump(SCENARIO | changes), encoding="utf-8")
    return launch("--scenario", str(file), *options)


def operator(flight, *words):
    """Ask as an operator does; return the exit code, and what was said."""
    done = flight.operator(*words)
    return done.returncode, done.stdout + done.stderr


def await_log(flight, name, text, within_s=90.0):
    file = flight.out / "log" / f"{name}.log"
    ends = time.monotonic() + within_s
    while not file.exists() or text not in file.read_text("utf-8"):
        assert time.monotonic() < ends, f"{name}: nothing of {text!r}"
        time.sleep(0.2)


def test_two_uavs_fly_on_either_side_and_the_report_tells_of_both(launch, tmp_path):
    flight = started(launch, tmp_path, "--speed", "5")
    await_log(flight, "uav2_planner", "list 1: leg")
    assert {f"{uav}/{node}" for uav in ("uav1", "uav2") for node in ("planner", "monitor")} <= set(
        flight.nodes()
    )
    code, output, errors = flight.wait(200.0)
    assert (code, errors) == (0, ""), output
    metrics = json.loads((flight.out / "metrics.json").read_text("utf-8"))
    inside, outside = metrics["uavs"]["uav1"], metrics["uavs"]["uav2"]
    assert inside["rules"][0].startswith("D")
    assert outside["rules"][0] == "O1"
    for one in (inside, outside):
        assert one["min_separation_m"] > 170.0
        assert abs(one["lag_m"][1]) < 150.0
        assert one["monitor"]["counts"]["passed"] > 5
    assert metrics["uavs_apart_m"] > 350.0
    assert metrics["overlap_percent"] < 15.0
    for figure in ("map", "corner_uav1", "corner_uav2", "lag_uav1", "lag_uav2"):
        assert (flight.out / f"{figure}.png").stat().st_size > 10_000
    assert "uav2: L(k) = " in output


def test_a_crew_leads_each_of_two_by_one_page_and_gives_one_another_slot(launch, tmp_path, page):
    port = str(free_port(socket.SOCK_STREAM))
    flight = started(launch, tmp_path, "--speed", "3", "--console-port", port)
    await_log(flight, "uav2_planner", "list 1: leg")
    flight.open_page(page)
    page.wait_for_selector(".banner.normal")
    assert page.locator(".uavrow").count() == 2
    page.wait_for_selector(".uavrow >> text=outside")
    page.get_by_role("button", name="uav2", exact=True).click()
    page.wait_for_selector("text=disengage uav2")
    changed = operator(flight, "--uav", "uav2", "slot", "outside", "2")
    assert changed == (0, "slot: outside 2\n")
    page.wait_for_selector(".uavrow >> text=outside 2")
    code, said = operator(flight, "--uav", "uav2", "slot", "inside", "9")
    assert code == 1
    assert "9" in said
    page.wait_for_selector("svg .pattern")
    page.get_by_role("button", name="slot uav2", exact=True).click()
    page.get_by_role("button", name="1", exact=True).click()
    page.get_by_role("button", name="take outside 1").click()
    page.wait_for_selector("text=uav2 slot: outside 1")
    page.wait_for_function(
        "document.querySelectorAll('.uavrow .slot .value')[1].textContent == 'outside'"
    )
    assert operator(flight, "--uav", "uav1", "disengage") == (0, "disengage: disengaged\n")
    page.wait_for_selector(".uavrow >> text=idle")
    code, said = operator(flight, "--uav", "uav3", "--timeout", "2", "engage")
    assert (code, said) == (2, "operator: /uav3/planner/engage: no such service is running\n")
    flight.process.send_signal(signal.SIGINT)
    code, _, errors = flight.wait(60.0)
    assert (code, errors) == (0, "")
