"""Attacks on the page: other pages in the owner's browser, other hosts, other users. They all get nothing."""

import http.server
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from tests.helpers.browser import forget, needs_browser, open_browser, requests
from tests.helpers.explore_server import PATIENCE, serve

pytest.importorskip("solara", reason="needs the extra `explore`")

pytestmark = pytest.mark.slow

KERNEL = "/jupyter/api/kernels/11111111-1111-4111-8111-111111111111/channels?session_id=22222222"
PATHS = ("/", KERNEL, "/static/main.js", "/_solara/api/close/1", "/readyz", "/resourcez", "/docs/../")
UPGRADE = (
    "Connection: Upgrade",
    "Upgrade: websocket",
    "Sec-WebSocket-Version: 13",
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
)
EVIL_PAGE = f"""<!doctype html><title>evil</title><link rel=icon href=data:,><script>
const page = new URLSearchParams(location.search).get("page");
const socket = page.replace("http", "ws") + "{KERNEL}";
const text = (options) => fetch(page + "/", options).then((answer) => answer.text());
const load = (tag, path) => new Promise((resolve, reject) => {{
  const element = document.createElement(tag);
  [element.onload, element.onerror] = [() => resolve(tag), reject];
  element.src = page + path;
  document.body.append(element);
}});
const post = () => new Promise((resolve, reject) => {{
  const frame = document.createElement("iframe");
  frame.name = "target";
  document.body.append(frame);
  frame.onload = () => frame.contentDocument ? resolve(frame.contentDocument.body.innerText) : reject();
  const form = document.createElement("form");
  Object.assign(form, {{ method: "post", action: page + "/", target: "target" }});
  document.body.append(form);
  form.submit();
}});
const attacks = {{
  fetch: () => text({{}}),
  with_cookies: () => text({{ credentials: "include" }}),
  opaque: () => text({{ mode: "no-cors", credentials: "include" }}),
  written: () => text({{ method: "post", mode: "no-cors", credentials: "include", body: "x" }}),
  websocket: () => new Promise((resolve, reject) => {{
    const own = new WebSocket(socket);
    own.onopen = () => resolve("open");
    own.onerror = reject;
  }}),
  image: () => load("img", "/static/logo.svg"),
  script: () => load("script", "/static/main.js"),
  frame: () => load("iframe", "/").then(() => frames[0].document.body.innerText),
  form: post,
}};
async function attack(done) {{
  const got = {{}};
  for (const [name, run] of Object.entries(attacks)) got[name] = await run().then(String, () => "");
  done(got);
}}
</script><body></body>"""


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """Address of a page, with its token."""
    with serve("fig-6.1c") as address:
        yield address


@pytest.fixture(scope="module")
def page(address: str) -> str:
    """Address of the page without its token."""
    return address.partition("/?")[0]


@pytest.fixture(scope="module")
def evil_port() -> Iterator[int]:
    """Port of this machine with a page that attacks the address in its query."""

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(EVIL_PAGE.encode())

        def log_message(self, *_: object) -> None:
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield server.server_port
        server.shutdown()


@pytest.fixture(scope="module")
def started() -> Iterator[Any]:
    """Start a browser in which any name of a host leads to this machine."""
    with open_browser("host-resolver-rules=MAP *.example 127.0.0.1") as driver:
        driver.set_script_timeout(PATIENCE)
        yield driver


@pytest.fixture
def browser(started: Any) -> Iterator[Any]:
    """Return this browser, without cookies and files of pages that it has shown."""
    yield started
    forget(started)
    started.execute_cdp_cmd("Network.clearBrowserCache", {})


def answers(driver: Any, page: str) -> list[int | None]:
    """Return the status of each request to the page since the last call; None without an answer."""
    found = [(urlsplit(request.url), request.status) for request in requests(driver)]
    port = urlsplit(page).port
    # A page that is left reports it.
    return [status for url, status in found if url.port == port and "/api/close/" not in url.path]


@needs_browser
def test_a_page_of_another_origin_gets_nothing_in_the_browser_of_the_owner(
    browser: Any, address: str, page: str, evil_port: int, tmp_path: Path
) -> None:
    link = tmp_path / "page.html"  # like the file that the command opens
    link.write_text(f'<meta http-equiv="refresh" content="0;url={address}">')
    browser.get(link.as_uri())
    end = time.monotonic() + PATIENCE
    while not browser.execute_script("return document.querySelector('[data-test=time]') !== null"):
        assert time.monotonic() < end, browser.page_source
        time.sleep(0.05)
    assert browser.current_url == f"{page}/"
    (cookie,) = [each for each in browser.get_cookies() if each["name"].startswith("kswarms-")]
    assert (cookie["httpOnly"], cookie["sameSite"]) == (True, "Strict")
    assert {101, 200} <= set(answers(browser, page))
    # The first is of the same site as the page, since a site has no port: the browser sends the cookie.
    for host in ("127.0.0.1", "localhost", "evil.example"):
        browser.get(f"http://{host}:{evil_port}/?page={page}")
        requests(browser)  # skips those before the attack
        got = browser.execute_async_script("attack(arguments[0])")
        assert len(got) == 9
        assert {name: text for name, text in got.items() if text} == {}
        status = answers(browser, page)
        assert (len(status), set(status)) == (9, {403, None})
        browser.get(f"{page}/")  # typed by the owner
        assert "Refused" not in browser.page_source


@needs_browser
def test_a_host_that_points_to_this_machine_gets_nothing(browser: Any, address: str, page: str) -> None:
    port = urlsplit(page).port
    for query in ("", urlsplit(address).query):
        browser.get(f"http://evil.example:{port}/?{query}")
        assert browser.find_element("tag name", "body").text.startswith("Refused.")
        fetched = browser.execute_async_script("fetch('/static/main.js').then((a) => arguments[0](a.status))")
        opened = browser.execute_async_script(
            "const own = new WebSocket(`ws://${location.host}` + arguments[0]);"
            "own.onopen = () => arguments[1]('open'); own.onerror = () => arguments[1]('')",
            KERNEL,
        )
        assert (fetched, opened, browser.get_cookies()) == (403, "", [])
    assert set(answers(browser, page)) == {403, None}


@needs_browser
def test_a_browser_without_the_token_or_with_a_wrong_one_gets_nothing(browser: Any, page: str) -> None:
    for path in ("/", "/?token=", "/?token=wrong", "/static/main.js", KERNEL):
        browser.get(page + path)
        assert browser.find_element("tag name", "body").text.startswith("Refused.")
    assert browser.get_cookies() == []
    assert 403 in (status := set(answers(browser, page)))
    assert status <= {403, None}


@pytest.mark.parametrize("method", ["GET", "HEAD", "POST", "OPTIONS", "PUT", "WEBSOCKET"])
def test_a_client_of_another_user_gets_nothing(page: str, method: str) -> None:
    name, port = page.removeprefix("http://").split(":")
    upgrade = (f"Origin: {page}", *UPGRADE) if method == "WEBSOCKET" else ("Connection: close",)
    for path in PATHS:
        for cookie in ((), ("Cookie: kswarms=x; token=x",), (f"Cookie: kswarms-{port}=",)):
            first = f"{method.replace('WEBSOCKET', 'GET')} {path} HTTP/1.1"
            request = "\r\n".join((first, f"Host: {name}:{port}", *upgrade, *cookie, "", ""))
            with socket.create_connection((name, int(port)), PATIENCE) as client:
                client.sendall(request.encode())
                answer = client.recv(4096).decode()
            assert answer.split()[1] == "403", (path, answer)
            assert "set-cookie" not in answer.lower()
