"""Who may use the page: this laptop's browser that was given the token, from this page alone."""

from __future__ import annotations

import hmac
from collections.abc import Awaitable, Callable, MutableMapping
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
COOKIE = "sar_console"
NO_STORE = (b"cache-control", b"no-store")


class Access:
    """ASGI: refuses whatever does not come from this page.

    ``Host`` must be loopback's at this port: else another site's name that was made to lead here
    (DNS rebinding) would be one with this page. ``Origin``, which browsers add to what pages of
    other sites send, must be this page's. The token comes once in the address, and is kept in a
    cookie that no other site's request carries.
    """

    def __init__(self, app: Any, *, port: int, token: str) -> None:
        """Guard an application."""
        self._app = app
        self._token = token
        self._cookie = f"{COOKIE}_{port}"
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        self._origins = {f"http://{host}" for host in self._hosts}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what may pass."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        status, reason = self.refusal(scope)
        if status:
            await _refuse(scope, send, status, reason)
            return
        if scope["type"] == "http" and self._given(scope):
            await _enter(send, self._cookie, self._token)
            return
        await self._app(scope, receive, send)

    def refusal(self, scope: Scope) -> tuple[int, str]:
        """Return the HTTP status and reason of a refusal; 0 where it may pass."""
        headers = {key.lower(): value.decode("latin-1") for key, value in scope["headers"]}
        if headers.get(b"host", "") not in self._hosts:
            return 421, "expected this laptop's own address"
        origin = headers.get(b"origin")
        if origin is not None and origin not in self._origins:
            return 403, "another site's page"
        if scope["type"] == "websocket" and origin is None:
            return 403, "expected a page of this console"
        if headers.get(b"sec-fetch-site", "none") not in ("none", "same-origin"):
            return 403, "another site's page"
        if not (self._given(scope) or self._known(headers.get(b"cookie", ""))):
            return 403, "expected the address that launch.sh has told"
        return 0, ""

    def _given(self, scope: Scope) -> bool:
        """Whether the token is in the address."""
        query = parse_qs(scope.get("query_string", b"").decode("latin-1"))
        given = query.get("token", [""])[0]
        return hmac.compare_digest(given.encode(), self._token.encode())

    def _known(self, text: str) -> bool:
        try:
            cookie = SimpleCookie(text).get(self._cookie)
        except CookieError:
            return False
        value = "" if cookie is None else cookie.value
        return hmac.compare_digest(value.encode(), self._token.encode())


async def _enter(send: Send, cookie: str, token: str) -> None:
    """Keep the token in a cookie, and lead to the page without it in the address."""
    value = f"{cookie}={token}; Path=/; HttpOnly; SameSite=Strict"
    headers = [
        (b"location", b"/"),
        (b"set-cookie", value.encode()),
        NO_STORE,
    ]
    await send({"type": "http.response.start", "status": 303, "headers": headers})
    await send({"type": "http.response.body", "body": b""})


async def _refuse(scope: Scope, send: Send, status: int, reason: str) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008, "reason": reason})
        return
    headers = [(b"content-type", b"text/plain; charset=utf-8"), NO_STORE]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": f"{reason}\n".encode()})
