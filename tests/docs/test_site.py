"""The documentation site: built without a warning, it opens as files, searches, and asks no other machine."""

from __future__ import annotations

import os
import re
import runpy
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from harness.cli.main import main
from tests.report import browser

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built as `make docs` builds it: a broken link or anchor is an error."""
    folder = tmp_path_factory.mktemp("site")
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    return folder


def test_every_page_is_in_the_navigation(site: Path) -> None:
    """Build a page of each document, and list each of them."""
    listed = re.findall(r"[\w/]+\.md", (ROOT / "mkdocs.yml").read_text(encoding="utf-8").split("nav:")[1])
    there = {str(path.relative_to(DOCS)) for path in DOCS.rglob("*.md") if "_template" not in path.name}
    assert sorted(listed) == sorted(there)
    assert all((site / name.replace(".md", ".html")).is_file() for name in listed)


def test_no_page_asks_another_machine(site: Path) -> None:
    """Load scripts, styles, fonts and pictures from the site alone."""
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.findall(r"<(?:script|img|iframe)[^>]*src=\"?(?:https?:)?//[^>]*>", text), page
        assert not re.findall(r"<link[^>]*rel=\"?(?:stylesheet|preconnect)[^>]*href=\"?(?:https?:)?//[^>]*>", text), (
            page
        )


@pytest.fixture
def driver() -> Iterator[Any]:
    """A headless browser."""
    with browser.chromium() as one:
        yield one


@pytest.mark.slow
def test_the_site_searches_when_it_is_opened_as_files(site: Path, driver: Any) -> None:
    """Find the page on tuning by its words, without a server."""
    driver.get((site / "index.html").as_uri())
    driver.find_element("css selector", "[data-md-component=search-query]").send_keys("contact parameters")
    from selenium.webdriver.support.ui import WebDriverWait

    links = WebDriverWait(driver, 30).until(
        lambda one: one.find_elements("css selector", ".md-search-result__link")  # the index is read first
    )
    assert any("tuning.html" in one.get_attribute("href") for one in links)


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The names of docs/make_tutorial.py."""
    monkeypatch.syspath_prepend(str(DOCS))
    return runpy.run_path(str(DOCS / "make_tutorial.py"))


def test_the_tutorial_is_of_its_template(made: dict[str, Any]) -> None:
    """Have the text and the commands of the template in the page, each command with an output."""
    page = made["PAGE"].read_text(encoding="utf-8")
    outside = re.sub(r"\n```text\n.*?```\n", "", page, flags=re.DOTALL)
    assert outside == made["TEMPLATE"].read_text(encoding="utf-8")
    assert len(re.findall("```text", page)) == len(re.findall("```sh", page))


@pytest.mark.slow
def test_the_commands_of_the_tutorial_run(made: dict[str, Any], tmp_path: Path) -> None:
    """Type them in a folder with the logs, one after the other; the verdict is the page's."""
    page = made["PAGE"].read_text(encoding="utf-8")
    for name in made["LOGS"]:
        (tmp_path / name).write_bytes((made["FOLDER"] / name).read_bytes())
    for command in made["commands"](page):
        assert command.split()[1] in main.commands
        printed = made["ran"](command, tmp_path)
        if " diagnose " in command:
            assert "delay" in printed
            assert "rolling resistance" in printed
    assert (tmp_path / "predicted.csv").is_file()
