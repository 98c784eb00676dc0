"""The notebooks of docs/notebooks run, what their text says holds, and their files are as they should be."""

from __future__ import annotations

import json
import re
import runpy
from pathlib import Path

import pytest

from tests.docs.building import built
from tests.report import browser

nbformat = pytest.importorskip("nbformat")
pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")

DOCS = Path(__file__).resolve().parents[2] / "docs"
NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))
LARGEST_FILE = 30_000  # bytes


def code(notebook: nbformat.NotebookNode) -> list[nbformat.NotebookNode]:
    """The cells with code."""
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


@pytest.fixture(params=NOTEBOOKS, ids=lambda path: path.stem)
def path(request: pytest.FixtureRequest) -> Path:
    """Each notebook."""
    given: Path = request.param
    return given


def test_there_are_three() -> None:
    """Have the notebooks that docs/notebooks.md describes, and no others."""
    page = (DOCS / "notebooks.md").read_text(encoding="utf-8")
    assert len(NOTEBOOKS) == 3
    assert {path.name for path in NOTEBOOKS} == set(re.findall(r"\(notebooks/([\w.]+\.ipynb)\)", page))


def test_a_file_holds_no_results(path: Path) -> None:
    """Be valid, small, and without outputs, which would be those of another machine and version."""
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code(notebook))
    assert path.stat().st_size < LARGEST_FILE


def test_links_lead_somewhere(path: Path) -> None:
    """Name files that there are, and headings that these have."""
    cells = nbformat.read(path, as_version=4).cells
    text = "\n".join(cell.source for cell in cells if cell.cell_type == "markdown")
    for link in re.findall(r"\]\(([^)]+)\)", text):
        if link.startswith("https://"):
            continue
        name, _, anchor = link.partition("#")
        target = (path.parent / name).resolve()
        assert target.is_file(), link
        heads = re.findall(r"(?m)^#+ (.*)$", target.read_text(encoding="utf-8"))
        assert not anchor or anchor in {re.sub(r"[^\w -]", "", head.lower()).replace(" ", "-") for head in heads}, link


@pytest.mark.slow
def test_it_runs_and_its_claims_hold(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run every cell in an empty folder, with assertions on what the text says; its page shows pictures and tables."""
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))  # the user's own start-up files stay out
    given = code(nbformat.read(path, as_version=4))
    asserted = [line for cell in given for line in cell.source.split("\n") if line.strip().startswith("assert ")]
    assert len(asserted) > 4
    work, executed = tmp_path / "work", tmp_path / "executed"
    work.mkdir()
    executed.mkdir()
    notebook = runpy.run_path(str(DOCS / "run_notebooks.py"))["executed"](path, work)
    outputs = [one for cell in code(notebook) for one in cell.outputs]
    assert not [one.text for one in outputs if one.get("name") == "stderr"]
    shown = [one.data["text/html"] for one in outputs if "harness-summary" in one.get("data", {}).get("text/html", "")]
    assert len(shown) >= 2
    assert all("data:image/png;base64," in html for html in shown)
    assert list(work.iterdir()) == []  # nothing is written where nobody asked
    assert len(json.dumps(notebook)) < 2_000_000
    nbformat.write(notebook, executed / path.name)
    seen(built(tmp_path / "site", executed) / "notebooks" / f"{path.stem}.html", len(shown))


def seen(page: Path, results: int) -> None:
    """See each result on a page of the site with its picture, all tables, and nothing beside the page."""
    with browser.chromium() as driver:
        browser.resize(driver, 1000)
        driver.get(page.as_uri())
        browser.settle(driver)
        sizes = driver.execute_script(
            "return [...document.querySelectorAll('article .harness-summary img')].map((one) => "
            "one.complete && one.naturalWidth > 300 && one.getBoundingClientRect().width > 300)"
        )
        assert len(sizes) >= results
        assert all(sizes)
        tables = driver.find_elements("css selector", "article .harness-summary table")
        assert len(tables) >= results
        assert all(table.is_displayed() for table in tables)
        assert driver.execute_script("return document.documentElement.scrollWidth <= innerWidth")
