"""Whatever a browser sends: only this page's requests pass, and no place that is none is marked.

``SAR_FUZZ_INPUTS`` inputs of each kind, seeded.
"""

import math
import os

import numpy as np

from sar_bridge.console.access import COOKIE, Access
from sar_bridge.console.map_view import View, place_touched

INPUTS = int(os.environ.get("SAR_FUZZ_INPUTS", "4000"))
PORT, TOKEN = 8080, "a-token_of-this-start"
HOSTS = (
    "127.0.0.1:8080", "localhost:8080", "127.0.0.1", "127.0.0.1:8081", "evil.example:8080",
    "127.0.0.1:8080.evil.example", "", "[::1]:8080", "LOCALHOST:8080", "127.0.0.1:8080 ",
)  # fmt: skip
ORIGINS = (
    None, "http://127.0.0.1:8080", "http://localhost:8080", "https://127.0.0.1:8080", "null",
    "http://evil.example", "http://127.0.0.1:8080.evil.example", "file://", "",
    "http://127.0.0.1:8080/",
)  # fmt: skip
SITES = (None, "none", "same-origin", "same-site", "cross-site", "", "same-origin, none")
TOKENS = (None, TOKEN, TOKEN[:-1], TOKEN + "x", "", TOKEN.upper(), "%00" + TOKEN)
COOKIES = (
    None, f"{COOKIE}_{PORT}={TOKEN}", f"{COOKIE}_{PORT}={TOKEN}x", f"{COOKIE}_8081={TOKEN}",
    f"x=1; {COOKIE}_{PORT}={TOKEN}; y=2", f"{COOKIE}_{PORT}=", "=;=;;", f"{COOKIE}={TOKEN}",
)  # fmt: skip


def scope(rng):
    """Return a request, and whether it is this page's own."""

    def one(values):
        return values[rng.integers(len(values))]

    kind, host, origin = one(("http", "websocket")), one(HOSTS), one(ORIGINS)
    site, token, cookie = one(SITES), one(TOKENS), one(COOKIES)
    if rng.random() < 0.3:  # noise, in any of them
        host += chr(int(rng.integers(33, 127)))
    headers = [(b"host", host.encode())]
    for name, value in ((b"origin", origin), (b"sec-fetch-site", site), (b"cookie", cookie)):
        if value is not None:
            headers.append((name, value.encode()))
    if rng.random() < 0.3:
        headers.append((b"x-noise", rng.bytes(20)))
    query = b"" if token is None else b"token=" + token.encode()
    own = (
        host in HOSTS[:2]
        and (origin in ORIGINS[1:3] or (origin is None and kind == "http"))
        and site in SITES[:3]
        and (token == TOKEN or (cookie or "").find(f"{COOKIE}_{PORT}={TOKEN}") >= 0)
        and not (cookie or "").endswith("x" if token != TOKEN else "never")
    )
    return {"type": kind, "headers": headers, "query_string": query, "path": "/"}, own


def test_only_this_pages_own_requests_pass():
    rng, access = np.random.default_rng(41), Access(None, port=PORT, token=TOKEN)
    passed = 0
    for _ in range(INPUTS):
        request, own = scope(rng)
        status, reason = access.refusal(request)
        assert (status == 0) is own, (request, reason)
        passed += own
    assert 0 < passed < INPUTS // 4


def test_headers_of_any_bytes_never_pass():
    rng, access = np.random.default_rng(42), Access(None, port=PORT, token=TOKEN)
    names = (b"host", b"origin", b"cookie", b"sec-fetch-site", b"x")
    for _ in range(INPUTS):
        headers = [(names[rng.integers(5)], rng.bytes(int(rng.integers(40)))) for _ in range(4)]
        request = {"type": "http", "headers": headers, "query_string": rng.bytes(30), "path": "/"}
        assert access.refusal(request)[0] in (403, 421)


ODD = (
    None, "", "x", "12", True, [], {}, math.nan, math.inf, -math.inf, 1e308, -1e308, 10**400, 0,
    450.0, 320,
)  # fmt: skip


def test_a_touch_of_any_kind_is_a_place_or_nothing():
    rng = np.random.default_rng(43)
    for _ in range(INPUTS):
        view = View(
            centre_m=tuple(rng.normal(0.0, 1e4, 2)),
            reach_m=float(rng.uniform(100.0, 2e4)),
            up_rad=float(rng.uniform(-7.0, 7.0)),
        )
        x, y = (
            ODD[rng.integers(len(ODD))] if rng.random() < 0.5 else rng.uniform(-500, 2000)
            for _ in range(2)
        )
        place = place_touched(view, x, y)
        if place is not None:
            assert 0.0 <= x <= view.width_px
            assert 0.0 <= y <= view.height_px
            assert math.isfinite(place[0] + place[1])
            assert math.dist(place, view.centre_m) < 2.0 * view.reach_m
