"""Executes the notebooks of docs/notebooks for the site: build/notebooks, with pictures and tables (two minutes).

One whose text and whose packages are those of the last time is not executed again.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterable
from pathlib import Path

import nbclient
import nbformat

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
NOTEBOOKS = sorted((HERE / "notebooks").glob("*.ipynb"))
EXECUTED = ROOT / "build" / "notebooks"
PACKAGES = ("analytic", "harness", "mjcf", "urdf")
KINDS = (".py", ".csv", ".toml")  # of the files in them that results depend on
LONGEST_CELL = 300  # [s]; the longest takes half a minute on two idle cores


def executed(path: Path, folder: Path) -> nbformat.NotebookNode:
    """A notebook with its outputs.

    Args:
        path: of the notebook.
        folder: in which its cells run.

    Raises:
        nbclient.exceptions.CellExecutionError: a cell fails; an assertion of what the text says, for example.
    """
    notebook = nbformat.read(path, as_version=4)
    client = nbclient.NotebookClient(
        notebook, timeout=LONGEST_CELL, kernel_name="python3", resources={"metadata": {"path": str(folder)}}
    )
    client.execute()
    return notebook


def main() -> None:
    """Execute what is not up to date."""
    EXECUTED.mkdir(parents=True, exist_ok=True)
    # The kernels take the packages of this tree, and no start-up files of the user.
    os.environ["PYTHONPATH"] = os.pathsep.join(one for one in (str(ROOT), os.environ.get("PYTHONPATH")) if one)
    code = _digest(
        one for name in PACKAGES for one in (ROOT / name).rglob("*") if one.suffix in (".py", ".html", ".csv")
    )
    for path in NOTEBOOKS:
        target, made_from = EXECUTED / path.name, code + _digest([path])
        if target.is_file() and nbformat.read(target, as_version=4).metadata.get("made_from") == made_from:
            continue
        print(f"{path.name} ...", flush=True)
        with tempfile.TemporaryDirectory() as scratch:
            os.environ["IPYTHONDIR"] = str(Path(scratch) / "ipython")
            work = Path(scratch) / "work"
            # Copies under the names of the built-in cases: a result names the path of its case, here one of no machine.
            shutil.copytree(ROOT / "harness" / "data", work)
            notebook = executed(path, work)
        notebook.metadata["made_from"] = made_from
        nbformat.write(notebook, target)


def _digest(files: Iterable[Path]) -> str:
    """One hash of all contents."""
    return hashlib.sha256(b"".join(hashlib.sha256(one.read_bytes()).digest() for one in sorted(files))).hexdigest()


if __name__ == "__main__":
    main()
