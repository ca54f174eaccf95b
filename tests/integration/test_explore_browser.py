"""The page in a real browser: it loads, plays, changes, and asks nothing of any other machine."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("solara", reason="needs the extra `explore`")
webdriver = pytest.importorskip("selenium.webdriver", reason="needs selenium, of the extra `test`")

BROWSER, DRIVER = (
    next((path for name in names if (path := shutil.which(name))), "")
    for names in (("chromium", "chromium-browser", "google-chrome"), ("chromedriver",))
)
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not (BROWSER and DRIVER), reason="needs chromium and chromedriver (apt: chromium-driver)"
    ),
]

PATIENCE = 40.0
"""For anything the page does (s): other programs may use the machine."""


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """Start the command and return the address that it prints."""
    code = "from scenarios.cli import main; main()"
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path or str(Path.cwd()) for path in sys.path)}
    command = [sys.executable, "-W", "error::DeprecationWarning:scenarios", "-c", code]
    server = subprocess.Popen(
        [*command, "explore", "fig-6.4b", "--no-browser", "--port", "0"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )
    assert server.stdout is not None
    assert server.stderr is not None
    line = server.stdout.readline()
    try:
        assert line.startswith("page: http://localhost:"), server.stderr.read()
        yield line.split()[1]
    finally:
        server.send_signal(signal.SIGINT)
        errors = server.communicate(timeout=PATIENCE)[1]
    assert server.returncode == 130
    assert errors == "kswarms: interrupted\n"


class Browser:
    """A page open in Chromium."""

    def __init__(self, address: str, size: tuple[int, int]) -> None:
        options = webdriver.ChromeOptions()
        options.binary_location = BROWSER
        for argument in (
            "--headless=new",
            "--no-sandbox",
            "--disable-dev-shm-usage",
            "--disable-background-networking",
        ):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
        self.driver.set_window_size(*size)
        self.driver.get(address)
        self.wait(lambda: self.all("[data-test=time]"))

    def all(self, selector: str, text: str = "") -> list[Any]:
        # At one instant: of elements asked one by one, some would be gone by then.
        return list(
            self.driver.execute_script(
                "return [...document.querySelectorAll(arguments[0])]"
                ".filter((element) => element.innerText.toLowerCase().includes(arguments[1].toLowerCase()))",
                *(selector, text),
            )
        )

    def text(self, selector: str, text: str = "") -> str:
        """Return the text of the first of `all`."""
        return str(
            self.driver.execute_script(
                "return [...document.querySelectorAll(arguments[0])].map((element) => element.innerText)"
                ".find((own) => own.includes(arguments[1])) || ''",
                *(selector, text),
            )
        )

    def click(self, selector: str, text: str) -> None:
        self.wait(lambda: self.all(selector, text))
        self.all(selector, text)[0].click()

    def time(self) -> str:
        return self.text("[data-test=time]")

    def frames(self) -> int:
        return int(self.driver.execute_script("return window.kswarmsFrames"))

    def wait(self, for_this: Callable[[], Any]) -> None:
        end = time.monotonic() + PATIENCE
        while not for_this():
            assert time.monotonic() < end, self.driver.find_element("tag name", "body").text
            time.sleep(0.05)

    def complaints(self) -> list[str]:
        """Return what the console has of errors."""
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]

    def requests(self) -> list[str]:
        """Return the addresses that the page asked for, over HTTP and otherwise."""
        asked = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                asked.append(message["params"]["request"]["url"])
            elif message["method"] == "Network.webSocketCreated":
                asked.append(message["params"]["url"])
        return asked


@pytest.fixture
def browse(address: str) -> Iterator[Callable[..., Browser]]:
    opened: list[Browser] = []

    def browse(size: tuple[int, int] = (1360, 950)) -> Browser:
        opened.append(Browser(address, size))
        return opened[-1]

    yield browse
    for browser in opened:
        browser.driver.quit()


def test_the_page_plays_changes_and_shows_a_learner(browse: Callable[..., Browser], address: str) -> None:
    browser = browse()
    assert browser.time() == "learning, 3000.0 s to the game"
    shown = "return [...document.querySelectorAll('.kswarms-policy input')].map((field) => field.value)"
    assert set(browser.driver.execute_script(shown)) == {"attack", "inter-learner"}  # no slider changed them

    browser.click("button", "play")
    browser.wait(lambda: browser.time() < "learning, 2990" and browser.time().startswith("learning, 29"))
    before = browser.frames()
    browser.wait(lambda: browser.frames() > before + 10)
    browser.click("button", "skip learning")
    browser.wait(lambda: browser.time().startswith("t ="))
    browser.click("button", "pause")

    browser.click(".v-tab", "robot")
    browser.wait(lambda: browser.all(".kswarms-table td", "inter-learner"))
    assert browser.all(".kswarms-heading", "Bandit against S1")
    assert browser.all(".kswarms-table td", "fight")

    # A slider changes the model: a click in its middle.
    assert browser.all("label", "Robots N = 20")
    slider = browser.all(".v-slider")[0]
    webdriver.ActionChains(browser.driver).move_to_element(slider).click().perform()
    browser.wait(lambda: not browser.all("label", "Robots N = 20"))
    browser.wait(lambda: browser.time() == "learning, 3000.0 s to the game")

    # A click on the canvas chooses the robot that is there.
    canvas = browser.all("canvas")[0]
    chosen = browser.text(".kswarms-table td", " of S")
    for x in range(-150, 151, 30):
        webdriver.ActionChains(browser.driver).move_to_element_with_offset(
            canvas, x, x // 2
        ).click().perform()
    browser.wait(lambda: browser.text(".kswarms-table td", " of S") != chosen)

    assert browser.complaints() == []
    requests = [url for url in browser.requests() if not url.startswith("data:")]
    host = address.removeprefix("http://").rstrip("/")
    assert len(requests) > 10
    assert [url for url in requests if url.split("/")[2] != host] == []


def test_a_mistake_is_told_in_the_page(browse: Callable[..., Browser]) -> None:
    browser = browse()
    field = next(f for f in browser.all("input") if f.get_attribute("value") == "inter-learner")
    field.send_keys("x\n")
    browser.wait(lambda: browser.all(".v-alert", "policy='inter-learnerx': must be one of avoid"))
    assert browser.complaints() == []


def test_a_narrow_window_has_everything_below_each_other(browse: Callable[..., Browser]) -> None:
    browser = browse((420, 900))
    width = browser.driver.execute_script("return document.documentElement.clientWidth")
    farthest = browser.driver.execute_script(
        "return Math.max(...[...document.querySelectorAll('.kswarms-page *')]"
        ".map((element) => element.getBoundingClientRect().right))"
    )
    assert farthest <= width
    canvas = browser.all("canvas")[0]
    assert 0.8 * width < canvas.size["width"] <= width
    assert browser.all(".v-tab")[0].location["y"] > canvas.location["y"] + canvas.size["height"]
