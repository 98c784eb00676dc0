"""What `mkdocs` (make docs) does beyond its configuration."""

from __future__ import annotations

import re
from typing import Any

from mkdocs.structure.pages import Page
from mkdocs.utils import get_relative_url

# A link out of the folder of documents leads to a file of the repository, which the site has not: its text remains.
_OUT = re.compile(r"\[([^\]]*)\]\((?:\.\./)+(?!docs/)[^)]*\)")
# The theme takes this from another machine, for searching pages that are opened as files.
_SHIM, _OWN_SHIM = "https://unpkg.com/iframe-worker/shim", "assets/iframe-worker/shim.js"


def on_page_markdown(markdown: str, **_: Any) -> str:
    """The page with its links to files of the repository as text."""
    return _OUT.sub(r"\1", markdown)


def on_post_page(output: str, page: Page, **_: Any) -> str:
    """The page with no script of another machine."""
    return output.replace(_SHIM, get_relative_url(_OWN_SHIM, page.url))


def on_post_template(output_content: str, **_: Any) -> str:
    """The same for the page of an address that is not there."""
    return output_content.replace(_SHIM, _OWN_SHIM)
