"""The fenced code of the pages, as it is read: commands exist with all their options, Python compiles."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import click
import pytest

import harness
from harness.cli.main import main
from tests.docs.pages import PAGES, ROOT, Block, blocks, commands, words

_COMMAND = re.compile(r"(?:\.venv/bin/)?harness (.*)")
_MAKE = re.compile(r"make ([a-z-]+)")
COMMANDS = [(page.name, found[1]) for page in PAGES for line in commands(page) if (found := _COMMAND.match(line))]
TARGETS = [(page.name, found[1]) for page in PAGES for line in commands(page) if (found := _MAKE.match(line))]
PYTHON = [(page, block.text) for page in PAGES for block in blocks(page) if block.language == "python"]


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


def test_the_effect_of_the_page_is_the_file() -> None:
    """Show docs/examples/magnet.py, which tests of `--effects` run."""
    text = (ROOT / "docs" / "examples" / "magnet.py").read_text(encoding="utf-8")
    for name in ("own_effect.md", "diagnosis.md"):
        assert Block("python", text) in blocks(ROOT / "docs" / name)


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
