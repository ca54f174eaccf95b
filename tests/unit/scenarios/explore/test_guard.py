"""Access control of the page, called directly: what it admits, and that everything else gets nothing."""

import asyncio
from typing import Any, Final

import pytest

from kswarms.scenarios.explore.guard import Guard, Message, Receive, Send

PORT: Final = 8765
HOST: Final = f"127.0.0.1:{PORT}"
PATHS: Final = ("/", "/static/main.js", "/jupyter/api/kernels/1", "/_solara/api/close/1", "//", "/%2e", "/x/")


class Application:
    """An application that answers every request and counts the calls."""

    def __init__(self) -> None:
        self.called: list[str] = []

    async def __call__(self, scope: Message, receive: Receive, send: Send) -> None:
        self.called.append(scope["type"])
        if scope["type"] == "http":
            headers = [(b"X-Frame-Options", b"ALLOWALL"), (b"content-type", b"text/html")]
            await send({"type": "http.response.start", "status": 200, "headers": headers})
            await send({"type": "http.response.body", "body": b"secret"})
        elif scope["type"] == "websocket":
            await send({"type": "websocket.accept"})


class Site:
    """A guarded application with its owner's cookie."""

    def __init__(self) -> None:
        self.application = Application()
        self.guard = Guard(self.application, PORT)
        self.cookie = f"kswarms-{PORT}={self.guard.token}"

    def ask(self, kind: str = "http", path: str = "/", query: str = "", **headers: Any) -> list[Message]:
        """Return the answer to a request; `headers` are texts or lists of them, with _ for -."""
        sent: list[Message] = []
        lines = [
            (name.replace("_", "-").encode(), value.encode("latin-1"))
            for name, values in headers.items()
            for value in (values if isinstance(values, list) else [values])
        ]
        scope = {"type": kind, "path": path, "query_string": query.encode("latin-1"), "headers": lines}

        async def receive() -> Message:
            raise AssertionError("the guard reads no request")

        async def send(message: Message) -> None:
            sent.append(message)

        asyncio.run(self.guard(scope, receive, send))
        return sent

    def admits(self, kind: str = "http", path: str = "/", query: str = "", **headers: Any) -> bool:
        """Return whether a request reaches the application; if not, check that it gets nothing."""
        self.application.called.clear()
        sent = self.ask(kind, path, query, **headers)
        if self.application.called:
            return True
        if kind == "websocket":
            assert sent == [{"type": "websocket.close", "code": 1008}]
        else:
            assert [message.get("status") for message in sent] == [403, None]
            assert sent[1]["body"] == b"Refused. Open the address that `kswarms explore` printed.\n"
            assert self.guard.token not in str(sent)
            assert b"set-cookie" not in dict(sent[0]["headers"])
        return False


@pytest.fixture
def site() -> Site:
    return Site()


@pytest.mark.parametrize("path", PATHS)
def test_the_owner_is_admitted_and_a_client_without_the_cookie_is_not(site: Site, path: str) -> None:
    for kind, headers in (("http", {}), ("websocket", {"origin": f"http://{HOST}"})):
        assert site.admits(kind, path, host=HOST, cookie=site.cookie, **headers)
        assert not site.admits(kind, path, host=HOST, **headers)


@pytest.mark.parametrize(
    "cookie",
    [
        "",
        f"kswarms-{PORT}",
        f"kswarms-{PORT}=",
        f"kswarms-{PORT}=wrong",
        "kswarms-8766={token}",
        "kswarms={token}",
        "x={token}",
        f"KSWARMS-{PORT}={{token}}",
        f"kswarms-{PORT}={{token}}x",
        f"kswarms-{PORT}=x{{token}}",
        f"kswarms-{PORT}=tökén",
        f"kswarms-{PORT}; {{token}}",
    ],
)
def test_other_cookies_are_refused(site: Site, cookie: str) -> None:
    for kind in ("http", "websocket"):
        text = cookie.format(token=site.guard.token)
        assert not site.admits(kind, host=HOST, origin=f"http://{HOST}", cookie=text)


def test_the_cookie_may_stand_among_others(site: Site) -> None:
    assert site.admits(host=HOST, cookie=f"a=b; kswarms-1=x;{site.cookie} ; c")
    assert site.admits(host=HOST, cookie=["a=b", site.cookie])


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        f"evil.example:{PORT}",
        f"localhost.evil.example:{PORT}",
        f"127.0.0.1.evil.example:{PORT}",
        f"evil.example#@127.0.0.1:{PORT}",
        f"user@127.0.0.1:{PORT}",
        f"127.0.0.2:{PORT}",
        f"0.0.0.0:{PORT}",
        f"127x0.0.1:{PORT}",
        f"[::2]:{PORT}",
        f"::1:{PORT}",
        f"{HOST}\n",
        f"{HOST},evil.example",
        "127.0.0.1:",
        "127.0.0.1:٣",
        "",
        [],
        [HOST, HOST],
        [HOST, "evil.example"],
    ],
)
def test_other_hosts_are_refused_also_with_cookie_or_token(site: Site, host: str | list[str]) -> None:
    hosts = [each.encode().decode("latin-1") for each in ([host] if isinstance(host, str) else host)]
    origin = f"http://{hosts[0]}" if hosts else f"http://{HOST}"
    assert not site.admits(host=hosts, cookie=site.cookie)
    assert not site.admits("websocket", host=hosts, origin=origin, cookie=site.cookie)
    assert not site.admits(query=f"token={site.guard.token}", host=hosts)


@pytest.mark.parametrize("host", ["localhost", "LocalHost:9000", "127.0.0.1:9000", "[::1]:80"])
def test_each_name_of_this_machine_and_each_forwarded_port_is_admitted(site: Site, host: str) -> None:
    for kind in ("http", "websocket"):
        assert site.admits(kind, host=host, origin=f"http://{host}", cookie=site.cookie)


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "null",
        "",
        "http://127.0.0.1",
        "http://127.0.0.1:9000",
        f"http://localhost:{PORT}",
        f"https://{HOST}",
        f"http://{HOST}/",
        f"http://{HOST}.evil.example",
        f"file://{HOST}",
        HOST,
        [f"http://{HOST}", f"http://{HOST}"],
        [f"http://{HOST}", "http://evil.example"],
    ],
)
def test_other_origins_are_refused_also_with_cookie_or_token(site: Site, origin: str | list[str]) -> None:
    for kind in ("http", "websocket"):
        assert not site.admits(kind, host=HOST, origin=origin, cookie=site.cookie)
    assert not site.admits(query=f"token={site.guard.token}", host=HOST, origin=origin)


def test_a_websocket_needs_an_origin_and_a_cookie(site: Site) -> None:
    assert not site.admits("websocket", host=HOST, cookie=site.cookie)
    query = f"token={site.guard.token}"  # the address opens the page, not a connection
    assert not site.admits("websocket", query=query, host=HOST, origin=f"http://{HOST}")


@pytest.mark.parametrize("fetched_by", ["cross-site", "same-site", "", "nonsense", ["none", "cross-site"]])
def test_what_another_page_requests_with_the_cookie_is_refused(site: Site, fetched_by: Any) -> None:
    for kind in ("http", "websocket"):
        headers = {"origin": f"http://{HOST}", "sec_fetch_site": fetched_by}
        assert not site.admits(kind, host=HOST, cookie=site.cookie, **headers)


@pytest.mark.parametrize("fetched_by", ["none", "same-origin"])
def test_what_the_page_or_its_owner_requests_is_admitted(site: Site, fetched_by: str) -> None:
    assert site.admits(host=HOST, cookie=site.cookie, sec_fetch_site=fetched_by)


@pytest.mark.parametrize(
    "query",
    [
        "token=",
        "token",
        "token=wrong",
        "token={token}x",
        "token={token}&token={token}",
        "token=wrong&token={token}",
        "token=%ff%00",
        "token=t\xf6k",
    ],
)
def test_a_wrong_token_is_refused_also_with_the_cookie(site: Site, query: str) -> None:
    query = query.format(token=site.guard.token)
    assert not site.admits(query=query, host=HOST)
    assert not site.admits(query=query, host=HOST, cookie=site.cookie)


def test_the_token_is_taken_at_the_address_of_the_page_alone(site: Site) -> None:
    for path in PATHS[1:]:
        assert not site.admits(path=path, query=f"token={site.guard.token}", host=HOST)


@pytest.mark.parametrize(("fetched_by", "status"), [([], 303), ("none", 303), ("cross-site", 200)])
def test_the_token_sets_a_cookie_and_leads_to_the_address_without_it(
    site: Site, fetched_by: Any, status: int
) -> None:
    query = f"a=1&token={site.guard.token}"
    start, body = site.ask(query=query, host="localhost:9000", sec_fetch_site=fetched_by)
    headers = dict(start["headers"])
    assert (start["status"], body["body"], site.application.called) == (status, b"", [])
    assert headers[b"set-cookie"].decode() == f"{site.cookie}; Path=/; HttpOnly; SameSite=Strict"
    assert headers.get(b"location", headers.get(b"refresh")) in (b"/", b"0;url=/")
    assert headers[b"cache-control"] == b"no-store"


def test_no_answer_can_be_framed_or_sends_its_address_on(site: Site) -> None:
    refused = site.ask(host="evil.example")
    signed_in = site.ask(query=f"token={site.guard.token}", host=HOST)
    admitted = site.ask(host=HOST, cookie=site.cookie)
    for start, _ in (refused, signed_in, admitted):
        names = [name.lower() for name, _ in start["headers"]]
        assert len(names) == len(set(names))
        headers = dict(start["headers"])
        assert headers[b"content-security-policy"] == b"frame-ancestors 'none'"
        assert headers[b"x-frame-options"] == b"DENY"
        assert headers[b"referrer-policy"] == b"no-referrer"
        assert headers[b"cross-origin-resource-policy"] == b"same-origin"
    assert dict(admitted[0]["headers"])[b"content-type"] == b"text/html"


def test_the_events_of_the_server_pass_and_unknown_connections_do_not(site: Site) -> None:
    assert site.admits("lifespan")
    for kind in ("webtransport", "HTTP", ""):
        with pytest.raises(ValueError, match="unknown type of connection"):
            site.ask(kind, host=HOST, cookie=site.cookie)
    assert site.application.called == ["lifespan"]


def test_each_server_has_its_own_long_token() -> None:
    tokens = {Site().guard.token for _ in range(20)}
    assert len(tokens) == 20
    assert min(map(len, tokens)) >= 43  # 256 bits
