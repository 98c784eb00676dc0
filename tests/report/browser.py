"""A headless Chromium for tests of pages, and what they ask it."""

from __future__ import annotations

import base64
import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

AXE = Path(__file__).with_name("axe") / "axe.min.js"
BUILD = Path(__file__).parents[2] / "build" / "report_pages"
WIDTHS = (400, 900, 1400)


@contextmanager
def chromium() -> Iterator:
    """A driver of Debian's Chromium; the test is skipped where it is not installed."""
    webdriver = pytest.importorskip("selenium.webdriver")
    browser, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if browser is None or driver is None:
        pytest.skip("chromium and chromedriver are not installed (Debian: chromium, chromium-driver)")
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    one = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    try:
        yield one
    finally:
        one.quit()


def opened(driver, page: Path):
    """The driver with the page freshly opened at 1000 pixels, light."""
    from selenium.webdriver.support.ui import WebDriverWait

    resize(driver, 1000)
    driver.get(page.as_uri())
    # Where the page was open before, chromedriver now and then comes back while it is still read.
    WebDriverWait(driver, 30.0).until(lambda it: it.execute_script("return document.readyState") == "complete")
    theme(driver, "light")
    settle(driver)
    return driver


def complaints(driver) -> list[str]:
    """What scripts complained of."""
    return [entry["message"] for entry in driver.get_log("browser")]


def button(driver, scope: str, label: str):
    """A button by its label."""
    script = (
        "return [...document.querySelectorAll(`${arguments[0]} button`)].find((one) => "
        "[one.getAttribute('aria-label'), one.innerText.trim()].includes(arguments[1]))"
    )
    found = driver.execute_script(script, scope, label)
    assert found is not None, label
    return found


def choose(driver, selection, value) -> None:
    """Give a select or a slider a value."""
    script = "arguments[0].value = arguments[1]; for (const one of ['input', 'change']) arguments[0].dispatchEvent("
    driver.execute_script(f"{script}new Event(one));", selection, value)


def foreign_requests(driver, page: Path) -> list[str]:
    """Addresses outside the file that it asked for; at least the file itself was asked for."""
    addresses = [
        event["params"]["request"]["url"]
        for entry in driver.get_log("performance")
        if (event := json.loads(entry["message"])["message"])["method"] == "Network.requestWillBeSent"
    ]
    assert addresses
    entries = driver.execute_script("return performance.getEntriesByType('resource').map((one) => one.name)")
    return [one for one in addresses if not one.startswith((page.as_uri(), "data:"))] + entries


@contextmanager
def on_paper(driver) -> Iterator:
    """The page as it is printed."""
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    try:
        yield
    finally:
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "screen"})


@contextmanager
def without_scripts(driver) -> Iterator:
    """Pages that are opened meanwhile run no scripts."""
    driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    try:
        yield
    finally:
        driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


def resize(driver, width: int) -> None:
    """Make the page `width` pixels wide."""
    metrics = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)


def settle(driver) -> None:
    """Wait until two frames are drawn: uPlot draws in a task of its own."""
    driver.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done));")


def theme(driver, name: str) -> None:
    """Choose light or dark with the switch."""
    if driver.execute_script("return document.documentElement.dataset.theme") != name:
        driver.find_element("id", "theme").click()
    assert driver.execute_script("return document.documentElement.dataset.theme") == name


def findings(driver) -> list[str]:
    """Serious and critical findings of axe-core."""
    driver.execute_script(AXE.read_text(encoding="utf-8"))
    found = driver.execute_async_script("const done = arguments[0]; axe.run().then((all) => done(all.violations));")
    return [
        f"{one['id']}: {one['nodes'][0]['html'][:160]}: {one['nodes'][0]['failureSummary'][:200]}"
        for one in found
        if one["impact"] in ("serious", "critical")
    ]


def photograph(driver, folder: str, width: int) -> list[Path]:
    """Write a picture of each section into build/."""
    target = BUILD / folder
    target.mkdir(parents=True, exist_ok=True)
    resize(driver, width)
    settle(driver)
    taken = []
    for section in driver.find_elements("css selector", "main > section"):
        box = "const r = arguments[0].getBoundingClientRect(); return [r.y + scrollY, r.height]"
        top, height = driver.execute_script(box, section)
        clip = {"x": 0, "y": top, "width": width, "height": max(height, 1), "scale": 1}
        shot = driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True, "clip": clip})
        path = target / f"{section.get_attribute('id')}_{width}.png"
        path.write_bytes(base64.b64decode(shot["data"]))
        taken.append(path)
    return taken
