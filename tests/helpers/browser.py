"""Headless Chromium for tests, which are marked `needs_browser`."""

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import pytest

webdriver = pytest.importorskip("selenium.webdriver", reason="needs selenium, of the extra `test`")

BROWSER, DRIVER = (
    next((path for name in names if (path := shutil.which(name))), "")
    for names in (("chromium", "chromium-browser", "google-chrome"), ("chromedriver",))
)
needs_browser = pytest.mark.skipif(
    not (BROWSER and DRIVER), reason="needs chromium and chromedriver (apt: chromium-driver)"
)


@contextmanager
def open_browser(*flags: str) -> Iterator[Any]:
    """Yield a driver of a new Chromium without a profile, which logs messages and requests of its pages."""
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    # Chromium's sandbox does not start for root.
    common = ("headless=new", "no-sandbox", "disable-gpu", "disable-dev-shm-usage", "hide-scrollbars")
    for flag in (*common, "disable-background-networking", *flags):
        options.add_argument(f"--{flag}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    try:
        yield driver
    finally:
        driver.quit()


def forget(driver: Any) -> None:
    """Leave the page, and forget its cookies, its messages, its requests and the size of its window."""
    driver.get("about:blank")
    for command in ("Network.clearBrowserCookies", "Emulation.clearDeviceMetricsOverride"):
        driver.execute_cdp_cmd(command, {})
    for log in ("browser", "performance"):
        driver.get_log(log)


class Request(NamedTuple):
    """A request of a page; its status is None without an answer, and 101 for an open WebSocket."""

    url: str
    status: int | None


def requests(driver: Any) -> list[Request]:
    """Return the requests over HTTP and WebSocket since the last call."""
    urls: dict[str, str] = {}
    status: dict[str, int] = {}
    for entry in driver.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        event, values = message["method"].removeprefix("Network."), message["params"]
        if event == "requestWillBeSent":
            urls[values["requestId"]] = values["request"]["url"]
        elif event == "webSocketCreated":
            urls[values["requestId"]] = values["url"]
        elif event == "webSocketHandshakeResponseReceived":
            status[values["requestId"]] = values["response"]["status"]
        elif event == "responseReceivedExtraInfo":  # pages may not see the answer, but the log does
            status[values["requestId"]] = values["statusCode"]
    return [Request(url, status.get(name)) for name, url in urls.items()]
