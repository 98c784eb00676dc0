"""The documentation site: built without a warning, it opens as files, searches, and asks no other machine."""

from __future__ import annotations

import re
import runpy
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from harness.cli.main import main
from tests.docs.building import build, built
from tests.docs.pages import ROOT
from tests.report import browser

DOCS = ROOT / "docs"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site with notebooks that were not executed."""
    return built(tmp_path_factory.mktemp("site"), tmp_path_factory.mktemp("executed"))


@pytest.mark.slow
def test_every_page_is_in_the_navigation(site: Path) -> None:
    """Build a page of each document and each notebook, and list each of them."""
    listed = re.findall(r"[\w/]+\.md", (ROOT / "mkdocs.yml").read_text(encoding="utf-8").split("nav:")[1])
    pages = [path for path in (*DOCS.rglob("*.md"), *DOCS.rglob("*.ipynb")) if "_template" not in path.name]
    assert sorted(listed) == sorted(str(path.relative_to(DOCS).with_suffix(".md")) for path in pages)
    assert all((site / name.replace(".md", ".html")).is_file() for name in listed)


@pytest.mark.slow
def test_links_to_a_notebook_lead_to_its_page(site: Path) -> None:
    """Lead from the table of notebooks to pages, from notebook to notebook and page, and from each page to the file."""
    links = {path.stem: hrefs(path) for path in (site / "notebooks.html", *(site / "notebooks").glob("*.html"))}
    names = {path.stem for path in (DOCS / "notebooks").glob("*.ipynb")}
    assert set(links) == {"notebooks", *names}
    assert {f"notebooks/{name}.html" for name in names} <= links["notebooks"]
    assert "measured_recording.html" in links["first_comparison"]
    assert {"../diagnosis.html#user-defined-effects", "../examples/magnet.py"} <= links["own_effect_and_engine"]
    for name in names:
        assert {link for link in links[name] if ".ipynb" in link} == {f"{name}.ipynb"}
        assert (site / "notebooks" / f"{name}.ipynb").is_file()


def hrefs(page: Path) -> set[str]:
    """Where the text of a page links to."""
    text = page.read_text(encoding="utf-8").split("<article", 1)[1].split("</article>", 1)[0]
    return set(re.findall(r'href="?([^"\s>]+)', text))


@pytest.mark.slow
def test_a_broken_link_of_a_notebook_is_an_error(tmp_path: Path) -> None:
    """Check links and headings in notebooks as in pages: the site is not built."""
    shutil.copytree(DOCS, tmp_path / "docs", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "mkdocs.yml", tmp_path)
    notebook = tmp_path / "docs" / "notebooks" / "own_effect_and_engine.ipynb"
    text = notebook.read_text(encoding="utf-8")
    assert "#user-defined-effects" in text
    notebook.write_text(text.replace("#user-defined-effects", "#no-such-heading"), encoding="utf-8")
    done = build(tmp_path / "site", tmp_path, root=tmp_path)
    assert done.returncode != 0
    assert "no-such-heading" in done.stderr


@pytest.mark.slow
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
    from selenium.webdriver.support.expected_conditions import element_to_be_clickable
    from selenium.webdriver.support.ui import WebDriverWait

    browser.resize(driver, 1400)  # a narrow page has its search behind a button
    driver.get((site / "index.html").as_uri())
    field = element_to_be_clickable(("css selector", "[data-md-component=search-query]"))
    WebDriverWait(driver, 30).until(field).send_keys("contact parameters")
    links = WebDriverWait(driver, 30).until(
        lambda one: one.find_elements("css selector", ".md-search-result__link")  # the index is read first
    )
    assert any("tuning.html" in one.get_attribute("href") for one in links)


@pytest.mark.slow
@pytest.mark.parametrize("width", [1400, 400])
@pytest.mark.parametrize("page", ["index", "tutorial", "import", "measured_rigs", "notebooks/measured_recording"])
def test_pages_are_accessible(site: Path, driver: Any, page: str, width: int) -> None:
    """Leave nothing serious for axe-core to find: names, contrast, links within text, scrolling by keyboard."""
    browser.resize(driver, width)
    driver.get((site / f"{page}.html").as_uri())
    browser.settle(driver)
    assert browser.findings(driver) == []


@pytest.mark.slow
def test_links_are_called_as_the_pages(site: Path) -> None:
    """Name a page by its title where the source has the name of its file."""
    for page in site.rglob("*.html"):
        article = page.read_text(encoding="utf-8").split("<article", 1)[-1].split("</article>", 1)[0]
        assert not re.findall(r"<a [^>]*>(?:docs/)?[\w/.-]+\.md</a>", article), page


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
