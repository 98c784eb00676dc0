"""The fenced code of the pages: commands exist with all their options, Python compiles, how-to pages run."""

from __future__ import annotations

import ast
import re
import shlex
from pathlib import Path
from typing import Any

import click
import pytest

import harness
from harness.cli.main import main
from tests.acceptance.short import write_short_case
from tests.importing import made

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted({ROOT / "README.md", *(ROOT / "docs").rglob("*.md")} - {ROOT / "docs" / "api.md"})
_BLOCK = re.compile(r"^( *)```(python|console|sh|bash)\n(.*?)^ *```$", re.DOTALL | re.MULTILINE)
_COMMAND = re.compile(r"(?:\.venv/bin/|\$ )?harness (.*)")
_MAKE = re.compile(r"make ([a-z-]+)")


def blocks(page: Path) -> list[tuple[str, str]]:
    """Language and text of each block of a page."""
    return [(found[2], found[3]) for found in _BLOCK.finditer(page.read_text(encoding="utf-8"))]


def lines(page: Path) -> list[str]:
    """Lines of shell of a page, those that are continued as one."""
    texts = [text.replace("\\\n", " ") for language, text in blocks(page) if language != "python"]
    return [line.strip() for text in texts for line in text.splitlines() if line.strip()]


def words(line: str) -> list[str]:
    """Words of a command without its comment and what follows a redirection."""
    split = shlex.split(line, comments=True)
    return split[: next((i for i, word in enumerate(split) if word in (">", ">>", "<", "|")), len(split))]


COMMANDS = [(page.name, found[1]) for page in PAGES for line in lines(page) if (found := _COMMAND.match(line))]
TARGETS = [(page.name, found[1]) for page in PAGES for line in lines(page) if (found := _MAKE.match(line))]
PYTHON = [(page, text) for page in PAGES for language, text in blocks(page) if language == "python"]


def parsed(line: str) -> click.Context:
    """The line as click reads it: the command, every option and argument, their types; nothing is run."""
    name, *arguments = words(line)
    command = main.get_command(click.Context(main), name)
    assert command is not None, f"there is no command {name}"
    return command.make_context(name, arguments)


def test_pages_have_code() -> None:
    """Find blocks at all: README has some of each kind."""
    assert {"README.md", "import.md", "own_effect.md"} <= {page for page, _ in COMMANDS}
    assert PYTHON
    assert TARGETS


@pytest.mark.parametrize(("page", "line"), COMMANDS)
def test_commands_exist_with_their_options(page: str, line: str) -> None:
    """Let click read the line: it knows the command and each option, and misses no argument."""
    parsed(line)


@pytest.mark.parametrize("line", ["no-such-command x", "run x --no-such-option", "diagnose", "import x --as nothing"])
def test_a_wrong_line_is_noticed(line: str) -> None:
    """Fail on an unknown command or option, a missing argument, a value that is no choice."""
    with pytest.raises((click.UsageError, AssertionError)):
        parsed(line)


@pytest.mark.parametrize(("page", "target"), TARGETS)
def test_make_targets_exist(page: str, target: str) -> None:
    """Have a rule for each target that a page names."""
    assert re.search(rf"(?m)^{target}:", (ROOT / "Makefile").read_text(encoding="utf-8"))


@pytest.mark.parametrize(("page", "text"), PYTHON, ids=[page.name for page, _ in PYTHON])
def test_python_is_python_and_calls_what_there_is(page: Path, text: str) -> None:
    """Parse it, and find every `harness.NAME` that it uses in the package."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "harness":
            assert hasattr(harness, node.attr), node.attr


RUN = ("diagnosis.md", "import.md", "own_effect.md", "tolerances.md", "virtual_rig.md")
RUN_ELSEWHERE = {
    "README.md": "tests/acceptance/test_readme.py",
    "own_engine.md": "test_a_script_prints_what_its_page_shows",
    "own_metric.md": "test_a_script_prints_what_its_page_shows",
}
NOT_RUN = {
    "export.md": "takes a diagnosis, a compiler's program and fmpy's input; tests/exports runs these exports",
    "tuning.md": "takes minutes; tests/acceptance/test_tune.py makes the same call on a short case",
}


def test_each_page_with_python_is_run_or_says_why_not() -> None:
    """Leave out no page, and give no reason for one that has no Python."""
    assert {page.name for page, _ in PYTHON} == {*RUN, *RUN_ELSEWHERE, *NOT_RUN}


@pytest.mark.slow
@pytest.mark.parametrize("name", RUN)
def test_python_runs_page_by_page(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run the blocks of a page in order, in a folder with the case and the log that pages speak of."""
    monkeypatch.chdir(tmp_path)
    if name == "import.md":
        made.labview(tmp_path / "log.lvm")
    else:
        write_short_case(tmp_path / "my_rig")
    names: dict[str, Any] = {"__name__": "__main__"}
    for page, text in PYTHON:
        if page.name == name:
            exec(compile(text, name, "exec"), names)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["own_metric.md", "own_engine.md"])
def test_a_script_prints_what_its_page_shows(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Run the page's script in an empty folder; its table has the rows and columns of the page."""
    monkeypatch.chdir(tmp_path)
    page = ROOT / "docs" / name
    ((_, code),) = blocks(page)
    exec(compile(code, name, "exec"), {"__name__": "__main__"})
    printed = capsys.readouterr().out
    shown = re.search(r"```text\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    assert shown is not None
    # First words only: how many decimals of a number agree depends on the processor.
    rows = [
        [line.split()[0] for line in text.splitlines() if re.search(r"\d\.\d\d", line)] for text in (printed, shown[1])
    ]
    assert rows[0] == rows[1]
    assert (tmp_path / "reports" / Path(name).stem / "metrics.csv").is_file()


def test_the_effect_of_the_page_is_the_file() -> None:
    """Show docs/examples/magnet.py, which tests of `--effects` run."""
    text = (ROOT / "docs" / "examples" / "magnet.py").read_text(encoding="utf-8")
    for name in ("own_effect.md", "diagnosis.md"):
        assert ("python", text) in blocks(ROOT / "docs" / name)


def test_what_readme_links_to_is_there() -> None:
    """Find every file that README links to, and every heading in it that a link names."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    links = {one for one in re.findall(r"\]\(([^)\s]+)\)", text) if not one.startswith(("http", "#"))}
    assert len(links) > 20
    for link in links:
        file, _, heading = link.partition("#")
        assert (ROOT / file).exists(), link
        if heading:
            titles = re.findall(r"^#+ (.*)$", (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
            anchors = {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}
            assert heading in anchors, link
