"""What holds of every report in a browser; the module of each page has a class of these tests and a fixture `page`."""

from __future__ import annotations

import re
from typing import ClassVar

import numpy as np
import pytest
from selenium.webdriver import ActionChains, Keys

from tests.report import browser

_NUMBER = r"−?(?:\d|\.)+(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?"
_DRAGGED = 0.5  # share of a plot's width


def scope_of(anchor: str) -> str:
    """Selector of a chart."""
    return f"[data-chart='{anchor}']"


def charts(driver) -> list[str]:
    """Anchors of the page's charts, in its order."""
    found = driver.execute_script("return [...report.charts.keys()]")
    assert found
    return found


def plot_of(driver, anchor: str, panel: int = 0):
    """The area of a panel in which lines are drawn, in sight."""
    over = driver.find_elements("css selector", f"{scope_of(anchor)} .u-over")[panel]
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", over)
    return over


def shown(driver, anchor: str) -> np.ndarray:
    """The span shown, as places along the axis, shape (2,)."""
    script = "const { clock } = report.charts.get(arguments[0]); return clock.shown.map((one) => clock.place(one))"
    return np.array(driver.execute_script(script, anchor))


def spans_agree(driver) -> bool:
    """Whether every panel of every chart shows the span that its chart, or the charts linked with it, show."""
    found = driver.execute_script(
        "return [...report.charts.values()].flatMap((one) => one.plots.map((plot) => "
        "[plot.scales.x.min, plot.scales.x.max, ...one.clock.shown]))"
    )
    return all(span[:2] == pytest.approx(span[2:]) for span in found)


def drawn(driver, anchor: str, panel: int, key: str) -> tuple[np.ndarray, np.ndarray]:
    """Abscissas and ordinates of one line as the page has them; where it has samples, shape (n,) each."""
    x, y = driver.execute_script(
        "const chart = report.charts.get(arguments[0]);"
        "const one = chart.data.panels[arguments[1]].series.find((each) => each.key === arguments[2]);"
        "const rows = chart.x.map((_, row) => row).filter((row) => one.y[row] !== undefined && one.y[row] !== null);"
        "return [rows.map((row) => chart.x[row]), rows.map((row) => one.y[row])]",
        anchor, panel, key,
    )  # fmt: skip
    return np.array(x), np.array(y)


class AnyPage:
    """Tests of a page; a subclass names the folder of its pictures below build/report_pages."""

    folder: ClassVar[str]

    def test_every_plot_is_zoomed_and_moved_by_buttons(self, driver):
        """Zoom in and out, move both ways and show all with the buttons of every plot; linked plots follow."""
        for anchor in charts(driver):
            full = shown(driver, anchor)
            width = np.diff(full)[0]
            scope = scope_of(anchor)
            browser.button(driver, scope, "Zoom in").click()
            half = shown(driver, anchor)
            assert np.diff(half)[0] == pytest.approx(width / 2)
            browser.button(driver, scope, "Move right").click()
            np.testing.assert_allclose(shown(driver, anchor), half + width / 8, rtol=0, atol=1e-9 * width)
            browser.button(driver, scope, "Move left").click()
            np.testing.assert_allclose(shown(driver, anchor), half, rtol=0, atol=1e-9 * width)
            assert spans_agree(driver)
            browser.button(driver, scope, "Zoom out").click()
            np.testing.assert_allclose(shown(driver, anchor), full, rtol=0, atol=1e-9 * width)
            browser.button(driver, scope, "Zoom in").click()
            browser.button(driver, scope, "Show all").click()
            np.testing.assert_allclose(shown(driver, anchor), full, rtol=0, atol=1e-9 * width)

    def test_every_plot_is_zoomed_and_moved_by_keys(self, driver):
        """Do the same with the keys + − ← → 0."""
        for anchor in charts(driver):
            full = shown(driver, anchor)
            width = np.diff(full)[0]
            target = browser.button(driver, scope_of(anchor), "Show all")
            target.send_keys("+")
            half = shown(driver, anchor)
            target.send_keys(Keys.ARROW_RIGHT)
            np.testing.assert_allclose(shown(driver, anchor), half + width / 20, rtol=0, atol=1e-9 * width)
            target.send_keys(Keys.ARROW_LEFT, "-")
            np.testing.assert_allclose(shown(driver, anchor), full, rtol=0, atol=1e-9 * width)
            target.send_keys("+", "0")
            np.testing.assert_allclose(shown(driver, anchor), full, rtol=0, atol=1e-9 * width)

    def test_every_plot_is_zoomed_and_moved_by_the_mouse(self, driver):
        """Drag to zoom, with Shift to move; zoom with Ctrl and wheel; show all with a double click."""
        for anchor in charts(driver):
            full = shown(driver, anchor)
            over = plot_of(driver, anchor)
            size = over.size["width"]
            pixel = np.diff(full)[0] / size
            dragged = round(_DRAGGED * size)
            start = ActionChains(driver).move_to_element_with_offset(over, -dragged // 2, 0)
            start.click_and_hold().move_by_offset(dragged, 0).release().perform()
            zoomed = shown(driver, anchor)
            assert np.diff(zoomed)[0] == pytest.approx(dragged * pixel, abs=3 * pixel)
            assert zoomed.mean() == pytest.approx(full.mean(), abs=3 * pixel)
            start = ActionChains(driver).move_to_element_with_offset(over, 0, 0).key_down(Keys.SHIFT)
            start.click_and_hold().move_by_offset(20, 0).release().key_up(Keys.SHIFT).perform()
            moved = shown(driver, anchor)
            assert np.diff(moved)[0] == pytest.approx(np.diff(zoomed)[0])
            assert (zoomed - moved)[0] == pytest.approx(20 * np.diff(zoomed)[0] / size, rel=0.06)
            driver.execute_script(
                "const box = arguments[0].getBoundingClientRect(); arguments[0].dispatchEvent(new WheelEvent('wheel', "
                "{ctrlKey: true, deltaY: -1, clientX: box.x + box.width / 2, cancelable: true}))",
                over,
            )
            assert np.diff(shown(driver, anchor))[0] == pytest.approx(0.8 * np.diff(moved)[0])
            ActionChains(driver).double_click(over).perform()
            np.testing.assert_allclose(shown(driver, anchor), full, rtol=1e-9)

    def test_every_line_is_switched_off_and_on(self, driver):
        """Hide a line in all plots of the page with any of its switches, and show it again."""
        state = (
            "return [...report.charts.values()].flatMap((one) => one.plots.flatMap((plot) => plot.series"
            ".filter((line) => line.key === arguments[0]).map((line) => line.show)))"
        )
        for box in driver.find_elements("css selector", ".live input[type=checkbox]"):
            key = box.get_attribute("data-key")
            driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", box)
            for on in (False, True):
                box.click()
                assert set(driver.execute_script(state, key)) == {on}
                every = driver.find_elements("css selector", f"input[data-key='{key}']")
                assert {one.is_selected() for one in every} == {on}

    def test_values_have_units_where_the_mouse_is(self, driver):
        """Tell the abscissa and the value of every line under the mouse, with units, in every panel."""
        for anchor in charts(driver):
            label, unit, panels = driver.execute_script(
                "const { data } = report.charts.get(arguments[0]); return [data.label, data.unit, data.panels.map("
                "(one) => [one.unit, one.series.filter((line) => !line.dots && line.rows === undefined)"
                ".map((line) => line.key)])]",
                anchor,
            )
            for number, (unit_of_values, keys) in enumerate(panels):
                ActionChains(driver).move_to_element(plot_of(driver, anchor, number)).perform()
                said = driver.find_element("css selector", f"{scope_of(anchor)} .at").text
                ending = "" if unit in ("", "1") else f" {unit}"
                assert re.fullmatch(rf"{re.escape(label)} {_NUMBER}{re.escape(ending)}", said), said
                for key in keys:
                    box = driver.find_element("css selector", f"{scope_of(anchor)} input[data-key='{key}']")
                    value = box.find_element("xpath", "../following-sibling::span").text
                    ending = "" if unit_of_values == "1" else f" {unit_of_values}"
                    assert re.search(rf"(?:{_NUMBER}{re.escape(ending)}|—)(?:,|$)", value), (anchor, key, value)

    def test_values_keep_to_one_line(self, driver):
        """Tell every value on the line of its switch, so that no plot moves; on a telephone, break between panels."""
        lines = (
            "return [...document.querySelectorAll(`${arguments[0]} .value`)].map((one) => {"
            "const range = document.createRange(); range.selectNodeContents(one);"
            "const tops = [...range.getClientRects()].map((each) => Math.round(each.top));"
            "return [one.innerText, new Set(tops).size]; })"
        )
        for width in browser.WIDTHS:
            browser.resize(driver, width)
            browser.settle(driver)
            for anchor in charts(driver):
                ActionChains(driver).move_to_element(plot_of(driver, anchor)).perform()
                for text, count in driver.execute_script(lines, scope_of(anchor)):
                    assert count <= (1 if width >= 900 else 1 + text.count(",")), (width, anchor, text)

    def test_points_are_told_one_by_one(self, driver):
        """Go forward and back through points with the buttons: each is told and ringed, and told under the mouse."""
        for anchor in charts(driver):
            if not driver.execute_script("return report.charts.get(arguments[0]).points", anchor):
                continue
            scope = scope_of(anchor)
            said = driver.find_element("css selector", f"{scope} .picked")
            after, before = (browser.button(driver, scope, f"{name} point") for name in ("Next", "Previous"))
            driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", after)
            assert said.text == "No point is chosen."
            told = []
            for _ in range(3):
                after.click()
                told.append(said.text)
            assert all(re.search(rf": .* {_NUMBER}", one) for one in told), told
            before.click()
            before.click()
            assert said.text == told[0]
            place = driver.execute_script(
                "const chart = report.charts.get(arguments[0]); const { one, row, panel } = chart.picked;"
                "const plot = chart.plots[panel];"
                "return [panel, plot.valToPos(chart.x[row], 'x'), plot.valToPos(one.y[row], 'y')]",
                anchor,
            )
            over = plot_of(driver, anchor, place[0])
            left, top = (at - over.size[side] / 2 for at, side in zip(place[1:], ("width", "height"), strict=True))
            mouse = ActionChains(driver)
            mouse.move_to_element_with_offset(over, round(left), round(top)).perform()
            assert said.text != "No point is chosen."
            assert driver.find_elements("css selector", f"{scope} .ring:not([hidden])")

    @pytest.mark.parametrize("theme", ["light", "dark"])
    def test_it_is_accessible(self, driver, theme):
        """Leave axe-core no serious finding at three widths, with all details open and a point chosen in every plot."""
        browser.theme(driver, theme)
        driver.execute_script("document.querySelectorAll('details').forEach((one) => (one.open = true))")
        driver.execute_script("report.charts.forEach((chart) => chart.step(1))")
        for width in browser.WIDTHS:
            browser.resize(driver, width)
            browser.settle(driver)
            assert browser.findings(driver) == []

    def test_no_request_leaves_the_file(self, driver, page):
        """Load nothing but the file itself, of at most 5 MB, and forbid anything else."""
        assert page.stat().st_size < 5e6
        assert browser.foreign_requests(driver, page) == []
        assert "default-src 'none'" in page.read_text(encoding="utf-8")

    def test_nothing_is_cut_off(self, driver):
        """Fit the page into three widths, where wide tables scroll, shaded at the side where there is more of them.

        A ranking scrolls on a telephone alone. Each section is photographed into build/.
        """
        for width in browser.WIDTHS:
            assert all(path.stat().st_size > 1000 for path in browser.photograph(driver, self.folder, width))
            assert driver.execute_script("return document.documentElement.scrollWidth") <= width
            for box in driver.find_elements("css selector", ".scroll"):
                far, style, hidden, shaded = driver.execute_script(
                    "const style = getComputedStyle(arguments[0]);"
                    "return [arguments[0].getBoundingClientRect().right, style.overflowX,"
                    "arguments[0].querySelector('.ranking') && arguments[0].scrollWidth > arguments[0].clientWidth,"
                    "style.backgroundImage]",
                    box,
                )
                assert far <= width
                assert style == "auto"
                assert not (hidden and width >= 900), box.text
                assert "linear-gradient" in shaded
            for text in driver.find_elements("css selector", "caption > span"):
                assert driver.execute_script("return arguments[0].getBoundingClientRect().right", text) <= width

    def test_paper_shows_the_still_pictures(self, driver):
        """Print every plot as a still picture on light ground, and neither controls nor replay."""
        browser.theme(driver, "dark")
        with browser.on_paper(driver):
            live = driver.find_elements("css selector", ".live, .replay, #theme")
            assert not any(one.is_displayed() for one in live)
            stills = driver.find_elements("css selector", "main figure img")
            assert len(stills) == len(driver.find_elements("css selector", "figure.is-live"))
            assert all(one.is_displayed() for one in stills)
            assert (
                driver.execute_script("return getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
            )

    def test_sections_flow_on_paper(self, driver):
        """Begin no sheet for a section, leave no heading alone at the foot of one, and print colours as they are."""
        style = (
            "return [...new Set([...document.querySelectorAll(arguments[0])].map((one) => getComputedStyle(one)[%r]))]"
        )
        with browser.on_paper(driver):
            assert driver.execute_script(style % "breakBefore", "section") == ["auto"]
            for heading in ("h2", "summary"):
                assert driver.execute_script(style % "breakAfter", heading) in (["avoid"], [])
            assert driver.execute_script(style % "printColorAdjust", ".swatch, .badge, tr, td") in (["exact"], [])

    def test_without_scripts_it_shows_the_still_pictures(self, chromium, page):
        """Show every still picture, and no control, where scripts are switched off."""
        with browser.without_scripts(chromium):
            chromium.get(page.as_uri())
            assert not chromium.find_elements("css selector", ".live")
            assert not chromium.find_element("id", "theme").is_displayed()
            stills = chromium.find_elements("css selector", "main figure img")
            assert stills
            assert all(one.is_displayed() for one in stills)
