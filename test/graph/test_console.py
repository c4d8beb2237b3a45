"""The operator's page in a flight: what it shows and does, and what its death changes."""

import re
import signal
import socket
import time

import pytest

from sar_sim.launch.launch_cli import free_port

pytestmark = [pytest.mark.graph, pytest.mark.timeout(240)]
WAIT_MS = 60_000


@pytest.fixture
def page(browser):
    shown = browser.new_page(viewport={"width": 1280, "height": 800})
    shown.set_default_timeout(WAIT_MS)
    yield shown
    shown.close()


def opened(flight, page):
    """Open the page of a flight as soon as it is there."""
    file = flight.out / "console.txt"
    ends = time.monotonic() + 60.0
    while True:
        assert time.monotonic() < ends, "no page"
        time.sleep(0.2)
        if not file.exists() or not file.read_text("utf-8").endswith("\n"):
            continue
        address = file.read_text("utf-8").strip()
        port = int(re.search(r":(\d+)/", address).group(1))
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                break
    assert oct(file.stat().st_mode)[-3:] == "600"
    page.goto(address)


def hold(page, name):
    box = page.get_by_role("button", name=name).bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.wait_for_timeout(1500)
    page.mouse.up()


def test_a_crew_follows_leads_and_gives_back_by_the_page(launch, page):
    port = str(free_port(socket.SOCK_STREAM))
    flight = launch("--scenario", "arduplane", "--speed", "3", "--console-port", port)
    opened(flight, page)
    page.get_by_role("button", name="checklist").click()
    page.wait_for_function("document.querySelectorAll('.check .dot.caution').length == 0")
    page.get_by_role("button", name="close").click()
    page.wait_for_selector(".banner.normal")
    page.wait_for_selector("svg .track.uav")
    page.wait_for_selector("svg .plan")
    assert "heartbeat" in page.locator(".side").inner_text()
    hold(page, "disengage")
    page.wait_for_selector("text=disengage: disengaged")
    page.wait_for_selector("text=NOT ENGAGED")
    page.get_by_role("button", name="engage", exact=True).click()
    page.wait_for_selector("text=engage: engaged")
    page.wait_for_selector(".banner.normal")
    page.get_by_role("button", name="return home").click()
    page.wait_for_selector("text=RTL commanded")
    page.wait_for_selector("text=UAV RELEASED")
    page.get_by_role("button", name="acknowledge").click()
    page.wait_for_selector("text=(acknowledged)")
    page.get_by_role("button", name="engage", exact=True).click()
    page.wait_for_selector("text=UAV in mode RTL: expected AUTO or GUIDED")
    flight.process.send_signal(signal.SIGINT)
    code, _, errors = flight.wait(60.0)
    assert (code, errors) == (0, "")
