"""The page in a real browser: every button, every alert, palettes, stale data, a hostile page."""

import contextlib
import functools
import http.server
import json
import os
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

from sar_bridge.console.map_view import View
from sar_bridge.console.tiles import TILE_PX, tiles_in
from sar_estimator.common.geodesy import Datum
from sar_sim.launch.launch_cli import free_port

pytestmark = pytest.mark.timeout(120)
WAIT_MS = 15_000
HOSTILE = """<html><body><script>
const results = [];
const done = () => { document.title = "done " + results.join(","); };
const port = PORT;
fetch("http://127.0.0.1:" + port + "/", {credentials: "include", mode: "no-cors"})
  .then(r => results.push("fetch " + r.type), () => results.push("fetch failed")).then(() => {
    const path = "/_nicegui_ws/socket.io/?EIO=4&transport=websocket";
    const socket = new WebSocket("ws://127.0.0.1:" + port + path);
    socket.onopen = () => { results.push("socket open"); done(); };
    socket.onerror = () => { results.push("socket refused"); done(); };
  });
</script></body></html>"""


def paint_tiles(folder):
    """Paint tiles of sea, each with a border, for the first look at the map."""
    view = View(centre_m=(2995.0, -125.0))
    for level in (13, 14, 15):
        for x, y in tiles_in(view, Datum(37.8, -122.8), level):
            tile = np.full((TILE_PX, TILE_PX, 3), (150, 190, 220), dtype=np.uint8)
            tile[[0, -1]] = tile[:, [0, -1]] = 40
            column = folder / str(level) / str(x)
            column.mkdir(parents=True, exist_ok=True)
            plt.imsave(column / f"{y}.png", tile)
    (folder / "attribution.txt").write_text("a chart of nowhere", encoding="utf-8")


def serve(port, folder, *uavs):
    """Start the page of a desk in a process of its own."""
    server = Path(__file__).with_name("desk_server.py")
    # NiceGUI serves otherwise where it believes itself under test.
    plain = {key: value for key, value in os.environ.items() if key != "PYTEST_CURRENT_TEST"}
    with (folder / "log").open("wb") as log:
        return subprocess.Popen(
            [sys.executable, str(server), str(port), str(folder), *uavs],
            env=plain,
            stdout=log,
            stderr=subprocess.STDOUT,
        )


@contextlib.contextmanager
def served(folder, *uavs):
    """Serve a page; give its folder, its address and its port."""
    (folder / "state").write_text("well", encoding="utf-8")
    (folder / "asked").touch()
    port = free_port(socket.SOCK_STREAM)
    process = serve(port, folder, *uavs)
    ends = time.monotonic() + 60.0
    while not (folder / "address").exists() or not listens(port):
        assert process.poll() is None, (folder / "log").read_text("utf-8")
        assert time.monotonic() < ends, "the page is not there"
        time.sleep(0.1)
    yield folder, (folder / "address").read_text("utf-8").strip(), port
    process.kill()
    process.wait()


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    folder = tmp_path_factory.mktemp("desk")
    paint_tiles(folder / "tiles")
    with served(folder) as found:
        yield found


@pytest.fixture(scope="module")
def desk_of_two(tmp_path_factory):
    with served(tmp_path_factory.mktemp("two"), "uav1", "uav2") as found:
        yield found


def listens(port):
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


@contextlib.contextmanager
def opened(desk, browser):
    folder, address, _ = desk
    (folder / "state").write_text("well", encoding="utf-8")
    (folder / "asked").write_text("", encoding="utf-8")
    context = browser.new_context(viewport={"width": 1280, "height": 800}, has_touch=True)
    shown = context.new_page()
    shown.outside = []
    shown.on("request", lambda r: shown.outside.append(r.url) if "127.0.0.1" not in r.url else None)
    shown.goto(address)
    shown.wait_for_selector(".banner.normal", timeout=WAIT_MS)
    yield shown
    context.close()


@pytest.fixture
def page(desk, browser):
    with opened(desk, browser) as shown:
        yield shown


@pytest.fixture
def page_of_two(desk_of_two, browser):
    with opened(desk_of_two, browser) as shown:
        yield shown


def asked(desk):
    lines = (desk[0] / "asked").read_text("utf-8").splitlines()
    return [json.loads(line) for line in lines]


def choose(desk, state):
    (desk[0] / "state").write_text(state, encoding="utf-8")


def await_true(condition, within_s=15.0):
    ends = time.monotonic() + within_s
    while not condition():
        assert time.monotonic() < ends, "waited in vain"
        time.sleep(0.1)


def test_everything_fits_and_comes_from_this_laptop(page):
    sizes = page.evaluate(
        "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    )
    assert sizes[0] <= 1280
    assert sizes[1] <= 800
    assert page.outside == []
    assert "token" not in page.url
    for text in ("IN FORMATION", "250 m", "120 m", "L(2) 3", "24.1 V", "heartbeat 0.3 s"):
        assert text in page.content()


def test_tiles_lie_under_the_map_and_are_for_this_page_alone(desk, page):
    tiles = page.locator("svg image.tile")
    assert 4 <= tiles.count() <= 80
    assert "a chart of nowhere" in page.content()
    address = tiles.first.get_attribute("href")
    own = "a => fetch(a).then(r => r.blob()).then(createImageBitmap).then(i => i.width)"
    assert page.evaluate(own, address) == TILE_PX
    with pytest.raises(urllib.error.HTTPError) as refused:
        urllib.request.urlopen(f"http://127.0.0.1:{desk[2]}{address}", timeout=10)
    assert refused.value.code == 403


def test_the_pattern_looks_otherwise_than_the_list(page):
    style = (
        "one => (({strokeDasharray, strokeWidth}) => [strokeDasharray, parseFloat(strokeWidth)])"
    )
    style += "(getComputedStyle(one))"
    pattern = page.locator("svg .pattern").first.evaluate(style)
    plan = page.locator("svg .plan").first.evaluate(style)
    assert pattern[0] not in ("none", plan[0])
    assert pattern[1] < plan[1]


def test_every_button_asks_for_what_it_says(desk, page):
    page.get_by_role("button", name="engage", exact=True).tap()
    for name in ("return home", "mark", "orbit", "resume"):
        page.get_by_role("button", name=name, exact=True).click()
    await_true(lambda: asked(desk) == ["engage", "return_home", "mark", "orbit", "resume"])
    assert "engage: no UAV position" in page.content()  # as it was answered


def test_a_place_on_the_map_is_marked_once_it_is_confirmed(desk, page):
    box = page.locator(".map img").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.click(x, y)
    page.get_by_role("button", name="cancel").click()
    page.wait_for_timeout(500)
    assert asked(desk) == []
    page.mouse.click(x, y)
    page.get_by_role("button", name="mark here").click()
    await_true(lambda: len(asked(desk)) == 1)
    name, east, north = asked(desk)[0]
    assert name == "mark"
    # The middle of the map is between the aircraft.
    assert (east, north) == pytest.approx((2995.0, -125.0), abs=60.0)


def test_disengaging_takes_a_second(desk, page):
    box = page.get_by_role("button", name="disengage").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.wait_for_timeout(300)
    page.mouse.up()
    page.wait_for_timeout(500)
    assert asked(desk) == []
    page.mouse.down()
    page.wait_for_timeout(1400)
    page.mouse.up()
    await_true(lambda: asked(desk) == ["disengage"])


def test_a_finger_that_slides_off_does_not_disengage(desk, page):
    box = page.get_by_role("button", name="disengage").bounding_box()
    page.mouse.move(box["x"] + 20, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 20, box["y"] - 200)
    page.wait_for_timeout(1500)
    page.mouse.up()
    page.wait_for_timeout(300)
    assert asked(desk) == []


@pytest.mark.parametrize(
    ("state", "urgency", "text", "shape"),
    [
        ("caution", "caution", "SEPARATION", "◆"),
        ("warning", "warning", "SEPARATION", "▲"),
        ("escape", "warning", "UAV SENT AWAY", "▲"),
        ("gps", "warning", "HELICOPTER GPS LOST", "▲"),
        ("link", "warning", "UAV LINK LOST", "▲"),
        ("silent", "warning", "SYSTEM", "▲"),
        ("released", "caution", "UAV RELEASED", "◆"),
        ("idle", "idle", "NOT ENGAGED", "■"),
    ],
)
def test_every_alert_has_its_colour_shape_reason_and_advice(
    desk, page, state, urgency, text, shape
):
    choose(desk, state)
    page.wait_for_selector(f".banner.{urgency}", timeout=WAIT_MS)
    banner = page.locator(".banner").inner_text()
    assert text in banner
    assert shape in banner
    assert page.locator(".banner .action").inner_text()


def test_an_alert_sounds_until_it_is_acknowledged(desk, page):
    choose(desk, "warning")
    page.wait_for_selector(".banner.warning", timeout=WAIT_MS)
    page.wait_for_timeout(600)
    assert page.evaluate("window.beeps") == 0  # nobody has armed it
    page.get_by_role("button", name="checklist").click()
    page.get_by_text("Sound heard").click()
    await_true(lambda: page.evaluate("window.beeps") >= 3)
    page.get_by_role("button", name="close").click()
    page.get_by_role("button", name="acknowledge").click()
    page.wait_for_selector("text=(acknowledged)", timeout=WAIT_MS)
    page.wait_for_timeout(500)
    were = page.evaluate("window.beeps")
    page.wait_for_timeout(3000)
    assert page.evaluate("window.beeps") == were
    choose(desk, "escape")
    await_true(lambda: page.evaluate("window.beeps") > were)


def test_what_is_old_is_grey(desk, page):
    assert page.locator(".figure.stale").count() == 0
    choose(desk, "stale")
    page.wait_for_selector(".figure.stale", timeout=WAIT_MS)
    assert page.locator(".figure.stale").count() == 3


def test_palettes_and_the_map_change(page):
    backs = set()
    for name in ("night", "red", "day"):
        page.get_by_role("button", name=("day", "night", "red")[len(backs)], exact=True).click()
        page.wait_for_function(f"document.body.classList.contains('{name}')", timeout=WAIT_MS)
        backs.add(page.evaluate("getComputedStyle(document.body).backgroundColor"))
    assert len(backs) == 3
    rings = page.locator("svg .ringlabel").first.text_content()
    page.get_by_role("button", name="-", exact=True).click()
    await_true(lambda: page.locator("svg .ringlabel").first.text_content() != rings)
    page.get_by_role("button", name="north up").click()
    page.wait_for_selector("text=track up", timeout=WAIT_MS)


def test_the_checklist_ticks_itself(desk, page):
    page.get_by_role("button", name="checklist").click()
    page.wait_for_selector(".check", timeout=WAIT_MS)
    assert page.locator(".check .dot.normal").count() == page.locator(".check").count()
    choose(desk, "link")
    page.wait_for_selector(".check .dot.caution", timeout=WAIT_MS)
    assert "autopilot not heard" in page.locator(".check", has_text="UAV heard").inner_text()


def test_what_a_node_says_is_text_and_nothing_else(desk, page):
    choose(desk, "script")
    page.wait_for_selector(".banner.caution", timeout=WAIT_MS)
    assert "<script>" in page.locator(".banner .reason").inner_text()
    assert page.evaluate("window.hacked === undefined")
    assert page.locator(".side b").count() == 0


def test_a_page_of_another_site_reaches_nothing(desk, browser, tmp_path):
    _, address, port = desk
    (tmp_path / "index.html").write_text(HOSTILE.replace("PORT", str(port)), encoding="utf-8")
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(tmp_path))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as other:
        threading.Thread(target=other.serve_forever, daemon=True).start()
        context = browser.new_context()
        own = context.new_page()
        own.goto(address)  # this browser has the cookie
        own.wait_for_selector(".banner", timeout=WAIT_MS)
        hostile = context.new_page()
        hostile.goto(f"http://localhost:{other.server_address[1]}/")
        hostile.wait_for_function("document.title.startsWith('done')", timeout=WAIT_MS)
        assert "socket refused" in hostile.title()
        context.close()
        other.shutdown()
    assert asked(desk) == []


def test_without_the_token_there_is_no_page(desk, browser):
    context = browser.new_context()
    stranger = context.new_page()
    answer = stranger.goto(f"http://127.0.0.1:{desk[2]}/")
    assert answer.status == 403
    context.close()


def test_a_page_whose_console_died_is_grey(desk, browser, tmp_path):
    del desk
    (tmp_path / "state").write_text("well", encoding="utf-8")
    port = free_port(socket.SOCK_STREAM)
    process = serve(port, tmp_path)
    try:
        await_true(lambda: (tmp_path / "address").exists() and listens(port), 60.0)
        context = browser.new_context()
        shown = context.new_page()
        shown.goto((tmp_path / "address").read_text("utf-8").strip())
        shown.wait_for_selector(".banner.normal", timeout=WAIT_MS)
        shown.wait_for_timeout(1000)
        assert shown.locator(".desk.stale").count() == 0
        process.kill()
        shown.wait_for_selector(".desk.stale", timeout=WAIT_MS)
        context.close()
    finally:
        process.kill()
        process.wait()


def test_one_uav_has_no_rows_and_no_name(page):
    assert page.locator(".uavs").count() == 0
    assert page.locator(".banner .state").inner_text() == "IN FORMATION"
    assert page.get_by_role("button", name="disengage (hold 1 s)", exact=True).count() == 1


def test_every_uav_has_a_row_and_is_on_the_map(page_of_two):
    page = page_of_two
    sizes = page.evaluate(
        "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    )
    assert sizes[0] <= 1280
    assert sizes[1] <= 800
    rows = page.locator(".uavrow")
    assert rows.count() == 2
    for text in ("uav2", "leg", "10 m", "250 m", "IN FORMATION", "heartbeat 0.3 s", "2 points"):
        assert text in rows.nth(1).inner_text()
    labels = page.locator("svg .callsign").all_text_contents()
    assert {"H", "uav1", "uav2"} <= set(labels)


def test_the_worst_alert_is_in_the_banner_and_sounds_whichever_is_chosen(desk_of_two, page_of_two):
    page = page_of_two
    page.get_by_role("button", name="checklist").click()
    page.get_by_text("Sound heard").click()
    page.get_by_role("button", name="close").click()
    await_true(lambda: page.evaluate("window.beeps") >= 1)
    were = page.evaluate("window.beeps")
    choose(desk_of_two, "well warning")
    page.wait_for_selector(".banner.warning", timeout=WAIT_MS)
    assert page.locator(".banner .state").inner_text() == "uav2: SEPARATION"
    assert page.locator(".uavrow.warning").count() == 1
    assert "uav1" in page.locator(".uavrow.chosen").inner_text()
    await_true(lambda: page.evaluate("window.beeps") > were)


def test_what_is_asked_for_is_asked_of_the_uav_that_is_chosen(desk_of_two, page_of_two):
    page = page_of_two
    page.get_by_role("button", name="engage uav1", exact=True).click()
    page.get_by_role("button", name="uav2", exact=True).click()
    page.get_by_role("button", name="return home uav2", exact=True).click()
    page.wait_for_selector(".uavrow.chosen >> text=uav2", timeout=WAIT_MS)
    assert page.get_by_role("button", name="engage uav1", exact=True).count() == 0
    box = page.get_by_role("button", name="disengage uav2").bounding_box()
    page.mouse.move(box["x"] + 20, box["y"] + 20)
    page.mouse.down()
    page.wait_for_timeout(1400)
    page.mouse.up()
    wanted = [["engage", "uav1"], ["return_home", "uav2"], ["disengage", "uav2"]]
    await_true(lambda: asked(desk_of_two) == wanted)


def test_a_uav_is_given_another_slot_once_that_is_confirmed(desk, page):
    page.get_by_role("button", name="slot", exact=True).click()
    page.get_by_text("Another slot for the UAV").wait_for(timeout=WAIT_MS)
    page.get_by_role("button", name="outside", exact=True).click()
    page.get_by_role("button", name="take outside 1").wait_for(timeout=WAIT_MS)
    page.get_by_role("button", name="cancel").click()
    page.wait_for_timeout(500)
    assert asked(desk) == []
    page.get_by_role("button", name="slot", exact=True).tap()
    page.get_by_role("button", name="take inside 1").wait_for(timeout=WAIT_MS)  # as it is now
    page.get_by_role("button", name="left", exact=True).tap()
    page.get_by_role("button", name="3", exact=True).tap()
    page.get_by_role("button", name="take left 3").tap()
    await_true(lambda: asked(desk) == [["slot", "left", 3, ""]])


def test_another_slot_is_for_the_uav_that_is_chosen(desk_of_two, page_of_two):
    page = page_of_two
    page.get_by_role("button", name="uav2", exact=True).click()
    page.get_by_role("button", name="slot uav2", exact=True).click()
    page.get_by_text("now: outside 2").wait_for(timeout=WAIT_MS)
    page.get_by_role("button", name="1", exact=True).click()
    page.get_by_role("button", name="take outside 1").click()
    await_true(lambda: asked(desk_of_two) == [["slot", "outside", 1, "uav2"]])
