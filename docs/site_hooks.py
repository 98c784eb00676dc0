"""What `mkdocs` (make docs) does beyond its configuration: notebooks as pages, links, no script of another machine."""

from __future__ import annotations

import posixpath
import re
from pathlib import Path
from typing import Any

import nbformat
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from mkdocs.utils import get_relative_url
from nbconvert import MarkdownExporter

_UPWARDS = re.compile(r"\[([^\]]*)\]\(((?:\.\./)+[^)#]*)(#[^)]*)?\)")
_FILE_NAME = re.compile(r"\[`?(?:docs/)?([\w/.-]+\.md)`?\]\(([\w/.-]+\.md)(#[^)]*)?\)")
_NOTEBOOK = re.compile(r"\]\(([\w/.-]+)\.ipynb\)")
# The theme takes this from another machine, for searching pages that are opened as files.
_SHIM, _OWN_SHIM = "https://unpkg.com/iframe-worker/shim", "assets/iframe-worker/shim.js"


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """The files with a page for each notebook, which is a file of its own beside it.

    The outputs are those of the notebook of the same name and the same cells in the folder `extra.executed_notebooks`.
    """
    executed = Path(config.config_file_path).parent / config.extra["executed_notebooks"]
    for file in [one for one in files if one.src_uri.endswith(".ipynb")]:
        assert file.abs_src_path is not None
        notebook = _with_outputs(Path(file.abs_src_path), executed)
        text, _ = MarkdownExporter().from_notebook_node(notebook)
        files.append(File.generated(config, file.src_uri.replace(".ipynb", ".md"), content=text))
    return files


def _with_outputs(path: Path, executed: Path) -> nbformat.NotebookNode:
    """A notebook as it was executed, or as it is where that was another text or not at all."""
    notebook = nbformat.read(path, as_version=4)
    if (executed / path.name).is_file():
        ran = nbformat.read(executed / path.name, as_version=4)
        if [cell.source for cell in ran.cells] == [cell.source for cell in notebook.cells]:
            return ran
    return notebook


def on_page_markdown(markdown: str, page: Page, files: Files, **_: Any) -> str:
    """The page with links to notebooks leading to their pages, those to files of the repository as text, and titles."""
    here = posixpath.dirname(page.file.src_uri)

    def upwards(link: re.Match[str]) -> str:
        leaves = posixpath.normpath(posixpath.join(here, link[2])).startswith("..")
        return link[1] if leaves else link[0]  # the site has only the folder of documents

    def titled(link: re.Match[str]) -> str:
        """What a page is called, where a link only has the name of its file."""
        file = files.get_file_from_path(posixpath.normpath(posixpath.join(here, link[2])))
        heading = file.content_string.split("\n", 1)[0] if file is not None else ""
        return f"[{heading[2:]}]({link[2]}{link[3] or ''})" if heading.startswith("# ") else link[0]

    text = _FILE_NAME.sub(titled, _NOTEBOOK.sub(r"](\1.md)", _UPWARDS.sub(upwards, markdown)))
    if files.get_file_from_path(page.file.src_uri.replace(".md", ".ipynb")) is None:
        return text
    heading, rest = text.split("\n", 1)
    name = posixpath.basename(page.file.src_uri).replace(".md", ".ipynb")
    return f"{heading}\n\n[Download this notebook]({name}){{: download}}\n{rest}"


def on_post_page(output: str, page: Page, **_: Any) -> str:
    """The page with no script of another machine."""
    return output.replace(_SHIM, get_relative_url(_OWN_SHIM, page.url))


def on_post_template(output_content: str, **_: Any) -> str:
    """The same for the page of an address that is not there."""
    return output_content.replace(_SHIM, _OWN_SHIM)
