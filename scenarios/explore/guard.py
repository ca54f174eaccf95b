"""Access control of the page: an ASGI application that passes on the requests of its owner alone.

It knows nothing of the application behind it. Other users of the machine can connect to the port, and any web
page that a browser shows can send requests to it. A request therefore needs a secret token, in the address or
in a cookie, and must not come from another page:

- ``Host`` names this machine. Otherwise another domain could point to this machine (DNS rebinding). Any port
  is allowed, because ``ssh -L`` may forward another port to the page.
- ``Origin`` is the origin of the page itself. It may be absent in HTTP, where browsers omit it from some
  requests, but not in a WebSocket handshake.
- ``Sec-Fetch-Site``, if present, says that no other page caused the request. A cookie does not distinguish
  ports, so a page of another port could otherwise use it.
"""

import hmac
import re
import secrets
from collections.abc import Awaitable, Callable, Iterable, MutableMapping
from typing import Any, Final
from urllib.parse import parse_qs

Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
Application = Callable[[Message, Receive, Send], Awaitable[None]]
"""An ASGI application: it is called with a scope, `receive` and `send`."""
Headers = Iterable[tuple[bytes, bytes]]

_LOCAL_HOST: Final = re.compile(rb"(localhost|127\.0\.0\.1|\[::1\])(:[0-9]{1,5})?", re.IGNORECASE)
_OWN_SITE: Final[tuple[list[bytes], ...]] = ([], [b"none"], [b"same-origin"])
"""Values of ``Sec-Fetch-Site`` in requests that no other page caused."""
_PROTECTION: Final = (
    (b"content-security-policy", b"frame-ancestors 'none'"),
    (b"x-frame-options", b"DENY"),
    (b"referrer-policy", b"no-referrer"),
    (b"x-content-type-options", b"nosniff"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
)
"""Headers of every response: no other page can embed, load or open the page."""
_REFUSAL: Final = b"Refused. Open the address that `kswarms explore` printed.\n"


class Guard:
    """An ASGI application that admits requests with a token and refuses all others.

    The address ``/?token=…`` sets a cookie and leads to the address without the token, so that the token is
    in no history and in no ``Referer``. Refused requests get status 403. A refused WebSocket is closed before
    it is accepted.

    Parameters
    ----------
    application : Application
        The ASGI application of the page.
    port : int
        Port of the page. It is part of the cookie's name, since a browser sends the cookies of a host to all
        of its ports.
    """

    def __init__(self, application: Application, port: int) -> None:
        self.token = secrets.token_urlsafe(32)
        self._application = application
        self._cookie = f"kswarms-{port}"

    async def __call__(self, scope: Message, receive: Receive, send: Send) -> None:
        """Pass on the events of the server and admitted requests; refuse other requests."""
        kind = scope["type"]
        if kind == "lifespan":
            await self._application(scope, receive, send)
        elif kind not in ("http", "websocket"):
            raise ValueError(f"unknown type of connection: {kind!r}")
        elif not _is_local(scope):
            await _refuse(scope, send)
        elif kind == "http" and scope["path"] == "/" and (tokens := _tokens(scope)):
            if len(tokens) == 1 and self._is_token(tokens[0]):
                await self._sign_in(scope, send)
            else:
                await _refuse(scope, send)
        elif _values(scope, b"sec-fetch-site") in _OWN_SITE and self._has_cookie(scope):
            await self._application(scope, receive, _with_protection(send))
        else:
            await _refuse(scope, send)

    def _is_token(self, text: str) -> bool:
        return hmac.compare_digest(text.encode(), self.token.encode())

    def _has_cookie(self, scope: Message) -> bool:
        lines = (line.decode("latin-1") for line in _values(scope, b"cookie"))
        pairs = (pair.strip().partition("=") for line in lines for pair in line.split(";"))
        return any(name == self._cookie and self._is_token(value) for name, _, value in pairs)

    async def _sign_in(self, scope: Message, send: Send) -> None:
        """Set the cookie and lead to the page.

        After a link on another page or in a file, browsers send no strict cookie, also after a redirect. They
        do after the ``Refresh`` of an answer.
        """
        cookie = f"{self._cookie}={self.token}; Path=/; HttpOnly; SameSite=Strict"
        headers = [(b"set-cookie", cookie.encode())]
        if _values(scope, b"sec-fetch-site") in _OWN_SITE:
            await _respond(send, 303, b"", [*headers, (b"location", b"/")])
        else:
            await _respond(send, 200, b"", [*headers, (b"refresh", b"0;url=/")])


def _is_local(scope: Message) -> bool:
    """Return whether host and origin of a request are the page's."""
    hosts, origins = _values(scope, b"host"), _values(scope, b"origin")
    if len(hosts) != 1 or not _LOCAL_HOST.fullmatch(hosts[0]):
        return False
    if not origins:
        return bool(scope["type"] == "http")
    return [origin.lower() for origin in origins] == [b"http://" + hosts[0].lower()]


def _tokens(scope: Message) -> list[str]:
    return parse_qs(scope["query_string"].decode("latin-1"), keep_blank_values=True).get("token", [])


def _values(scope: Message, name: bytes) -> list[bytes]:
    return [value for key, value in scope["headers"] if key.lower() == name]


async def _refuse(scope: Message, send: Send) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008})
    else:
        await _respond(send, 403, _REFUSAL)


async def _respond(send: Send, status: int, body: bytes, headers: Headers = ()) -> None:
    plain = ((b"content-type", b"text/plain; charset=utf-8"), (b"content-length", str(len(body)).encode()))
    start = {"type": "http.response.start", "status": status}
    all_headers = [*plain, (b"cache-control", b"no-store"), *headers, *_PROTECTION]
    await send({**start, "headers": all_headers})
    await send({"type": "http.response.body", "body": body})


def _with_protection(send: Send) -> Send:
    """Return a `send` that adds the headers of protection to a response."""
    names = {name for name, _ in _PROTECTION}

    async def send_protected(message: Message) -> None:
        if message["type"] == "http.response.start":
            kept = [(name, value) for name, value in message.get("headers", ()) if name.lower() not in names]
            message = {**message, "headers": [*kept, *_PROTECTION]}
        await send(message)

    return send_protected
