"""The code of README and docs runs, each page in order, in an empty folder with the files that the page speaks of."""

from __future__ import annotations

import json
import os
import re
import runpy
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from tests.docs.page_files import FILES
from tests.docs.pages import PAGES, ROOT, Block, blocks
from tests.viewing.shown import need_opengl

# What is not run here, by its command or the first line of its Python, and why.
_DEVELOPMENT = "sets up the repository itself: .ci/run does it"
_WINDOW = "opens a window: tests/viewing/test_windows.py opens, uses and closes both"
_OTHER_MACHINES = "needs other machines: tests/jobs/test_cluster.py has a cluster on this one"
_SCRIPT = "test_a_script_prints_what_its_page_shows runs it"
_TUTORIAL = "tests/docs/test_site.py runs the tutorial"
_GALLERY = "the gallery runs it"
NOT_RUN: dict[str, dict[str, str]] = {
    "README.md": {
        "make report": _DEVELOPMENT,
        "make test": _DEVELOPMENT,
        ".venv/bin/harness diagnose open_ball_beam": _GALLERY,
        ".venv/bin/harness tune my_rig/": "tuning.md runs it",
        ".venv/bin/harness sweep docs/examples/sweep.toml": _GALLERY,
        ".venv/bin/harness view my_rig/ --video my_rig.mp4": "view.md runs it",
        ".venv/bin/harness check-scene my_rig/": "scenes.md runs it",
        "import harness": "tests/acceptance/test_readme.py runs it",
    },
    "export.md": {
        "import fmpy": "takes an input of the reader's own: tests/exports/test_fmu.py makes the same call",
    },
    "gallery.md": {
        "jupyter nbconvert --to html --execute first_comparison.ipynb": "tests/docs/test_notebooks.py runs it",
    },
    "notebooks.md": {
        "make setup": _DEVELOPMENT,
        ".venv/bin/pip install jupyterlab": "fetches 100 packages",
        ".venv/bin/jupyter lab docs/notebooks": "serves a page until it is stopped",
    },
    "own_engine.md": {"# own_engine.py": _SCRIPT},
    "own_metric.md": {"# own_metric.py": _SCRIPT},
    "sweeps.md": {
        ".venv/bin/harness sweep docs/examples/sweep.toml": _GALLERY,
        ".venv/bin/harness sweep sweep.toml --on dask://host:8786": _OTHER_MACHINES,
        "pip install 'ball-beam-harness[dask]'": _OTHER_MACHINES,
        "dask scheduler": _OTHER_MACHINES,
        "dask worker tcp://host:8786 --nworkers 8 --nthreads 1 --memory-limit 1GB": _OTHER_MACHINES,
    },
    "tutorial.md": {
        command: _TUTORIAL for block in blocks(ROOT / "docs" / "tutorial.md") for command in block.commands
    },
    "tuning.md": {"import harness": "takes minutes: tests/acceptance/test_tune.py makes the same call"},
    "view.md": {
        ".venv/bin/harness view my_rig/": _WINDOW,
        ".venv/bin/harness view my_rig/ --engine pybullet --recording swing_02.csv": _WINDOW,
    },
}


# Exit codes other than 0 that are an answer about the files here, and why.
ENDS_WITH = {
    # A ball that slips leaves the model that rolls: a limit breaks, as it should.
    ("tuning.md", ".venv/bin/pytest --case my_rig/ --parameters reports/my_rig/tuned.toml"): 1,
}


def steps(page: Path) -> list[Block]:
    """What is run of a page, in order: each command and each block of Python as a block of its own."""
    listed = NOT_RUN.get(page.name, {})
    return [one for one in _parts(page) if _name(one) not in listed]


def _parts(page: Path) -> list[Block]:
    return [
        part
        for block in blocks(page)
        for part in ([block] if block.language == "python" else [Block("sh", one) for one in block.commands])
    ]


def _name(part: Block) -> str:
    return part.text.splitlines()[0]


RUN = [page for page in PAGES if steps(page)]


def test_what_is_not_run_is_on_its_page() -> None:
    """Give no reason for a line that no page has, nor files to a page of which nothing is run."""
    pages = {page.name: page for page in PAGES}
    for name, listed in NOT_RUN.items():
        assert set(listed) <= {_name(part) for part in _parts(pages[name])}, name
    assert set(FILES) <= {page.name for page in RUN}


@pytest.mark.slow
@pytest.mark.parametrize("page", RUN, ids=lambda page: page.name)
def test_it_runs_as_it_stands(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Type every command and run every block of Python, in an empty folder with an empty home."""
    folder, home = tmp_path / "work", tmp_path / "home"
    folder.mkdir()
    home.mkdir()
    FILES.get(page.name, lambda _: None)(folder)
    (folder / ".venv").symlink_to(sys.prefix)
    monkeypatch.chdir(folder)
    names: dict[str, Any] = {"__name__": "__main__"}
    printed: dict[str, str] = {}
    for step in steps(page):
        if step.language == "python":
            exec(compile(step.text, page.name, "exec"), names)
        else:
            printed[step.text] = _typed(page.name, step.text, folder, home)
    if page.name == "gallery.md":
        _says_what_it_quotes(printed)


def _says_what_it_quotes(printed: Mapping[str, str]) -> None:
    """Hold what the gallery's commands print to what its page quotes: the same words, numbers as far as they round."""
    made = runpy.run_path(str(ROOT / "docs" / "make_gallery.py"))
    answers = json.loads(made["ANSWERS"].read_text(encoding="utf-8"))
    number = re.compile(r"(± )?(\d+(?:\.\d+)?)")
    for entry in made["ENTRIES"]:
        if entry.commands[-1] not in printed:
            continue
        now, then = "\n".join(made["quoted"](entry, printed[entry.commands[-1]])), "\n".join(answers[entry.name])
        assert number.sub("…", now) == number.sub("…", then)
        for (_, one), (interval, other) in zip(number.findall(now), number.findall(then), strict=True):
            # Processors round differently; half a width has one digit, the others two at least.
            assert float(one) == pytest.approx(float(other), rel=0.3 if interval else 0.07), (now, then)


def _typed(page: str, command: str, folder: Path, home: Path) -> str:
    """What a command prints that bash runs; it ends as it should."""
    if "--video" in command:
        need_opengl()
    if "--rerun" in command:
        pytest.importorskip("rerun")
    kept = {name: value for name, value in os.environ.items() if not name.startswith("XDG_")}
    path = os.pathsep.join((str(Path(sys.prefix) / "bin"), os.environ["PATH"]))
    packages = os.pathsep.join(one for one in (str(ROOT), os.environ.get("PYTHONPATH", "")) if one)
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", command],
        cwd=folder,
        env=kept | {"HOME": str(home), "PATH": path, "PYTHONPATH": packages},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
    )
    assert done.returncode == ENDS_WITH.get((page, command), 0), f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("name", ["own_metric.md", "own_engine.md"])
def test_a_script_prints_what_its_page_shows(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Run the page's script in an empty folder; its table has the rows and columns of the page."""
    monkeypatch.chdir(tmp_path)
    page = ROOT / "docs" / name
    (block,) = blocks(page)
    exec(compile(block.text, name, "exec"), {"__name__": "__main__"})
    printed = capsys.readouterr().out
    shown = re.search(r"```text\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    assert shown is not None
    # First words only: how many decimals of a number agree depends on the processor.
    rows = [
        [line.split()[0] for line in text.splitlines() if re.search(r"\d\.\d\d", line)] for text in (printed, shown[1])
    ]
    assert rows[0] == rows[1]
    assert (tmp_path / "reports" / Path(name).stem / "metrics.csv").is_file()
