"""docs/api.md from the docstrings of the public names: `make docs`."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path

from griffe import GriffeLoader, Parser
from griffe2md import render_object_docs

import harness

HEAD = """# Python API

What the commands do, for scripts and notebooks; typed, and silent unless asked. Results show themselves in an
interpreter and in a notebook. This page is made from the docstrings (`make docs`). What is in `diagnosis.json` is
described by its [JSON Schema](../harness/data/diagnosis.schema.json).

"""
NAMES = [name for name, module in harness._MODULES.items() if module.startswith("harness.")]
"""In the order of use; effects and their parts are in docs/diagnosis.md."""
ALSO = [("harness.identify.record", name) for name in ("EffectRecord", "ParameterRecord")]
CONFIG = {
    "docstring_section_style": "list",
    "heading_level": 2,
    "inherited_members": False,
    "members_order": "source",
    "merge_init_into_class": False,
    "separate_signature": True,
    "show_bases": False,
    "show_docstring_modules": False,
    "show_if_no_docstring": False,
    "show_object_full_path": False,
    "show_root_full_path": False,
    "show_root_heading": True,
    "show_submodules": False,
    "signature_crossrefs": False,
    "show_signature_annotations": True,
    "summary": False,
    "filters": ["!^_"],
    "annotations_path": "brief",
    "line_length": 100,
}


def text() -> str:
    """The page."""
    loader = GriffeLoader(docstring_parser=Parser("google"))
    package = loader.load("harness", submodules=True, try_relative_path=False)
    places = [(harness._MODULES[name], name) for name in NAMES] + ALSO
    objects = [package[f"{module}.{name}".removeprefix("harness.")] for module, name in places]
    return HEAD + "\n".join(_plain(render_object_docs(one, CONFIG, format_md=True)) for one in objects)


def _plain(page: str) -> str:
    """Types as code instead of links to pages that are not here, and members under short names."""

    def code(found: re.Match[str]) -> str:
        bare = re.sub(r"\[([^][]+)\]\(#[^)]*\)", r"\1", found[1]).replace("\\", "")
        return f"`{unescape(bare)}`"

    page = re.sub(r"<code>(.*?)</code>", code, page)
    page = re.sub(r"\[(\*\*\w+\*\*)\]\(#[^)]*\)", r"\1", page)
    return re.sub(r"(?m)^(#+ `)harness\.[\w.]+\.(\w+\.\w+`)", r"\1\2", page)


if __name__ == "__main__":
    (Path(__file__).parent / "api.md").write_text(text(), encoding="utf-8")
