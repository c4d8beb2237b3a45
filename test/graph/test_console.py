"""The operator's page in a flight: what it shows and does, and what its death changes."""

import signal
import socket

import pytest

from sar_sim.launch.launch_cli import free_port

pytestmark = [pytest.mark.graph, pytest.mark.timeout(240)]


def hold(page, name):
    box = page.get_by_role("button", name=name).bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.wait_for_timeout(1500)
    page.mouse.up()


def test_a_crew_follows_leads_and_gives_back_by_the_page(launch, page):
    port = str(free_port(socket.SOCK_STREAM))
    flight = launch("--scenario", "arduplane", "--speed", "3", "--console-port", port)
    flight.open_page(page)
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
