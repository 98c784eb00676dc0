"""The fenced code of README and docs: blocks of a page in order, commands of a shell block."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# The reference has no code of its own, and a template's page has that of the template.
PAGES = sorted(
    {ROOT / "README.md", *(page for page in (ROOT / "docs").rglob("*.md") if not page.stem.endswith("_template"))}
    - {ROOT / "docs" / "api.md"}
)
_COMMENT = re.compile(r"(?:^|\s)#\s.*$")
_BLOCK = re.compile(r"^( *)```(python|console|sh|bash)\n(.*?)^ *```$", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """A fenced block.

    Attributes:
        language: `python`, or one of those of a shell.
        text: what stands between the fences.
    """

    language: str
    text: str

    @property
    def commands(self) -> list[str]:
        """Its lines of shell without comments, those that are continued as one; none of Python."""
        if self.language == "python":
            return []
        lines = [_COMMENT.sub("", line) for line in self.text.replace("\\\n", " ").splitlines()]
        return [" ".join(line.split()) for line in lines if line.strip()]


def blocks(page: Path) -> list[Block]:
    """The blocks of a page."""
    return [Block(found[2], found[3]) for found in _BLOCK.finditer(page.read_text(encoding="utf-8"))]


def commands(page: Path) -> list[str]:
    """The lines of shell of a page."""
    return [command for block in blocks(page) for command in block.commands]


def words(command: str) -> list[str]:
    """Words of a command without what follows a redirection."""
    split = shlex.split(command)
    return split[: next((i for i, word in enumerate(split) if word in (">", ">>", "<", "|")), len(split))]
