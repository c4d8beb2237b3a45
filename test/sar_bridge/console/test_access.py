"""Who may use the page: nobody but its own browser."""

import asyncio

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sar_bridge.console.access import COOKIE, Access

TOKEN, PORT = "a-token-of-this-start", 8080
HOST = (b"host", b"127.0.0.1:8080")
ORIGIN = (b"origin", b"http://127.0.0.1:8080")
KNOWN = (b"cookie", f"{COOKIE}_8080={TOKEN}".encode())


class Inner:
    """The application that is guarded."""

    def __init__(self):
        self.reached = 0

    async def __call__(self, _scope, _receive, send):
        self.reached += 1
        await send({"type": "http.response.start", "status": 200, "headers": []})


def ask(*headers, kind="http", query=b""):
    inner, sent = Inner(), []

    async def send(message):
        sent.append(message)

    scope = {"type": kind, "headers": list(headers), "query_string": query}
    asyncio.run(Access(inner, port=PORT, token=TOKEN)(scope, None, send))
    return inner.reached, sent


def test_the_token_is_taken_once_and_kept_in_a_cookie_of_this_site_alone():
    reached, sent = ask(HOST, query=f"token={TOKEN}".encode())
    assert reached == 0
    assert sent[0]["status"] == 303
    headers = dict(sent[0]["headers"])
    assert headers[b"location"] == b"/"
    assert b"SameSite=Strict" in headers[b"set-cookie"]
    assert b"HttpOnly" in headers[b"set-cookie"]


@pytest.mark.parametrize("kind", ["http", "websocket"])
def test_its_own_browser_may(kind):
    assert ask(HOST, ORIGIN, KNOWN, kind=kind)[0] == 1


@pytest.mark.parametrize("kind", ["http", "websocket"])
@pytest.mark.parametrize(
    "headers",
    [
        (ORIGIN, KNOWN),
        (HOST, ORIGIN),
        ((b"host", b"evil.example:8080"), ORIGIN, KNOWN),
        ((b"host", b"127.0.0.1:9999"), KNOWN),
        (HOST, (b"origin", b"http://evil.example"), KNOWN),
        (HOST, (b"origin", b"http://127.0.0.1:9999"), KNOWN),
        (HOST, (b"origin", b"null"), KNOWN),
        (HOST, KNOWN, (b"sec-fetch-site", b"cross-site")),
        (HOST, KNOWN, (b"sec-fetch-site", b"same-site")),
        (HOST, (b"cookie", f"{COOKIE}_8080=wrong".encode())),
        (HOST, (b"cookie", f"{COOKIE}_8081={TOKEN}".encode())),
        (HOST, (b"cookie", b"\xff;;=")),
    ],
)
def test_nobody_else_may(kind, headers):
    reached, sent = ask(*headers, kind=kind)
    if kind == "http":
        assert sent[0]["status"] in (403, 421)
    else:
        assert sent == [{"type": "websocket.close", "code": 1008, "reason": sent[0]["reason"]}]
    assert reached == 0


def test_a_websocket_without_an_origin_is_no_page():
    assert ask(HOST, KNOWN, kind="websocket")[0] == 0


@given(
    st.lists(st.tuples(st.sampled_from([b"host", b"origin", b"cookie"]), st.binary(max_size=60))),
    st.binary(max_size=60),
)
def test_whatever_is_sent_nobody_without_the_token_comes_through(headers, query):
    assert ask(*headers, query=query)[0] == 0
