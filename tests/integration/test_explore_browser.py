"""The page in a browser: it loads, plays, changes, and contacts no other machine."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from kswarms.scenarios.cli import invoke
from tests.helpers.browser import forget, needs_browser, open_browser, requests, webdriver
from tests.helpers.explore_server import PATIENCE, serve

pytest.importorskip("solara", reason="needs the extra `explore`")

pytestmark = [pytest.mark.slow, needs_browser]


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with serve("fig-6.4b") as address:
        yield address


class Browser:
    """A page open in Chromium."""

    def __init__(self, driver: Any, address: str, size: tuple[int, int]) -> None:
        self.driver = driver
        self.script = self.driver.execute_script
        self.driver.set_window_size(*size)
        self.driver.get(address)
        self.wait(lambda: self.all("[data-test=time]"))

    def all(self, selector: str, text: str = "") -> list[Any]:
        # In one script: elements that are queried one by one may be gone by then.
        code = (
            "return [...document.querySelectorAll(arguments[0])]"
            ".filter((element) => element.innerText.toLowerCase().includes(arguments[1].toLowerCase()))"
        )
        return list(self.script(code, selector, text))

    def text(self, selector: str, text: str = "") -> str:
        """Return the text of the first of `all`."""
        code = (
            "return [...document.querySelectorAll(arguments[0])].map((element) => element.innerText)"
            ".find((own) => own.includes(arguments[1])) || ''"
        )
        return str(self.script(code, selector, text))

    def click(self, selector: str, text: str) -> None:
        self.wait(lambda: self.all(selector, text))
        self.all(selector, text)[0].click()

    def time(self) -> str:
        return self.text("[data-test=time]")

    def on_top(self, element: Any) -> bool:
        """Return whether no other element covers an element."""
        code = (
            "const box = arguments[0].getBoundingClientRect();"
            "const [x, y] = [box.x + box.width / 2, box.y + Math.min(100, box.height / 2)];"
            "return document.elementFromPoint(x, y) === arguments[0]"
        )
        return bool(self.script(code, element))

    def in_view(self, element: Any) -> bool:
        """Return whether the middle of an element is visible."""
        code = (
            "const box = arguments[0].getBoundingClientRect();"
            "const top = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);"
            "return arguments[0].contains(top)"
        )
        return bool(self.script(code, element))

    def frames(self) -> int:
        return int(self.script("return window.kswarmsFrames"))

    def wait(self, condition: Callable[[], Any]) -> None:
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, self.driver.find_element("tag name", "body").text
            time.sleep(0.05)

    def complaints(self) -> list[str]:
        """Return the errors and warnings of the console."""
        log = self.driver.get_log("browser")
        entries = [entry["message"] for entry in log if entry["level"] in ("SEVERE", "WARNING")]
        # One comes from solara: its navigator.vue has `modules.export` for `module.exports`.
        navigator = [entry for entry in entries if "Failed to evaluate Vue script and find module" in entry]
        assert len(navigator) <= 1
        return [entry for entry in entries if entry not in navigator]

    def requests(self) -> list[str]:
        """Return the addresses that the page requested, over HTTP and WebSocket."""
        return [request.url for request in requests(self.driver)]


@pytest.fixture(scope="module")
def driver() -> Iterator[Any]:
    with open_browser() as driver:
        yield driver


@pytest.fixture
def browse(driver: Any, address: str) -> Iterator[Callable[..., Browser]]:
    def browse(size: tuple[int, int] = (1360, 950), address: str = address) -> Browser:
        return Browser(driver, address, size)

    yield browse
    forget(driver)


def test_the_page_plays_changes_and_shows_a_learner(browse: Callable[..., Browser], address: str) -> None:
    browser = browse()
    assert browser.time() == "learning, 3000.0 s to the game"
    assert browser.on_top(browser.all("label", "Robots N")[0])
    shown = "return [...document.querySelectorAll('.kswarms-policy input')].map((field) => field.value)"
    assert set(browser.driver.execute_script(shown)) == {"attack", "inter-learner"}  # no slider changed them

    browser.click("button", "play")
    browser.wait(lambda: browser.time() < "learning, 2999" and browser.time().startswith("learning, 29"))
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

    # A click on the canvas selects the robot under it.
    canvas = browser.all("canvas")[0]
    selected = browser.text(".kswarms-table td", " of S")
    for x in range(-150, 151, 30):
        mouse = webdriver.ActionChains(browser.driver)
        mouse.move_to_element_with_offset(canvas, x, x // 2).click().perform()
    browser.wait(lambda: browser.text(".kswarms-table td", " of S") != selected)

    # An invalid control is reported.
    field = next(f for f in browser.all("input") if f.get_attribute("value") == "attack")
    field.send_keys("x\n")
    browser.wait(lambda: browser.all(".v-alert", "policy='attackx': must be one of avoid"))

    assert browser.complaints() == []
    requests = [url for url in browser.requests() if not url.startswith("data:")]
    host = address.split("/")[2]
    assert len(requests) > 10
    assert [url for url in requests if url.split("/")[2] != host] == []


def test_a_run_with_an_absent_robot_is_watched(browse: Callable[..., Browser], tmp_path: Path) -> None:
    command = f"contribution fig-6.4b --n 6 --robots 3 --seeds 1 --first-seed 5 --jobs 1 --out {tmp_path}"
    assert invoke(command.split()) == 0
    (row,) = pq.read_table(tmp_path / "contribution.parquet").to_pylist()
    with serve("--run", row["run_without"], str(tmp_path)) as address:
        browser = browse((1400, 900), address)
        values = [field.get_attribute("value") for field in browser.all("input")]
        assert f"run {row['run_without']}" in values
        assert values[values.index("5") + 1] == "3"  # the seed, and the absent robots
        browser.click(".v-tab", "robot")
        browser.wait(lambda: browser.text(".kswarms-table td", " of S") == "4 of S2, inter-learner")
        robot_field = next(field for field in browser.all("input") if field.get_attribute("value") == "4")
        robot_field.send_keys(webdriver.Keys.BACKSPACE + "3\n")
        browser.wait(lambda: browser.all(".kswarms-page span", "Robot 3 is absent."))
        robot_field.send_keys(webdriver.Keys.BACKSPACE + "4\n")
        browser.click("button", "skip learning")
        browser.wait(lambda: browser.time().startswith("t ="))

        # The first five columns fit beside the arena.
        browser.click(".v-tab", "conflicts")
        browser.wait(lambda: browser.all(".kswarms-table th", "chose"))
        browser.wait(lambda: browser.all(".kswarms-table td", "fight"))
        seen = browser.driver.execute_script(
            "const edge = document.querySelector('.kswarms-scroll').getBoundingClientRect().right;"
            "return [...document.querySelectorAll('.kswarms-table th')]"
            ".filter((cell) => cell.getBoundingClientRect().right <= edge).map((cell) => cell.innerText)"
        )
        assert [text.replace("\n", " ") for text in seen][:5] == [
            *("t (s)", "who → met", "where (m)", "known: Q (N)", "chose R (s)")
        ]
        assert browser.complaints() == []


def test_a_narrow_window_has_a_single_column(browse: Callable[..., Browser]) -> None:
    browser = browse((500, 900))  # the smallest window of Chromium
    phone = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": False}
    browser.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", phone)
    browser.wait(lambda: browser.all("canvas")[0].size["width"] < 390)
    width = browser.driver.execute_script("return document.documentElement.clientWidth")
    farthest = browser.driver.execute_script(
        "return Math.max(...[...document.querySelectorAll('.kswarms-page *')]"
        ".map((element) => element.getBoundingClientRect().right))"
    )
    assert farthest <= width
    canvas = browser.all("canvas")[0]
    assert 0.8 * width < canvas.size["width"] <= width
    assert browser.on_top(canvas)  # not the controls
    browser.click("button[class*=nav-icon]", "")
    browser.wait(lambda: not browser.on_top(canvas))
    assert browser.all(".v-tab")[0].location["y"] > canvas.location["y"] + canvas.size["height"]

    # The controls show the message, because they cover the page; none of them is cut off.
    field = next(f for f in browser.all("input") if f.get_attribute("value") == "attack")
    field.send_keys("x\n")
    browser.wait(lambda: any(map(browser.in_view, browser.all(".v-alert", "policy='attackx'"))))
    drawer = browser.all(".v-navigation-drawer")[0]
    browser.wait(lambda: drawer.location["x"] == 0)
    browser.script("document.querySelector('.v-navigation-drawer__content').scrollTop = 400")
    assert any(map(browser.in_view, browser.all(".v-alert", "policy='attackx'")))
    assert drawer.size["width"] <= width
