"""What is installed here and works: versions, engines, graphics, cores, memory, caches, disk."""

from __future__ import annotations

import os
import platform
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from ctypes.util import find_library
from dataclasses import asdict, dataclass, replace
from importlib.metadata import PackageNotFoundError, requires, version
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement

from harness.engines.catalogue import GraphicsVariable
from harness.report.tables import Row, Summarised, Summary, Table, texts

_DISTRIBUTION = "ball-beam-harness"
_DISK, _MEMORY = 500e6, 1e9  # [bytes]: a large sweep's scratch files; a diagnosis with its engines
_PATIENCE = 120.0  # for an engine to load and run ten steps on a busy machine [s]
_PATIENCE_GRAPHICS = 240.0  # for three kinds of OpenGL contexts, each of which may take a minute [s]
_OPTIONAL = ("dart",)  # engines that are an extra
EXTRAS = {
    "files": "MAT-files of version 7.3 and spreadsheets, for `harness import`",
    "matlab": "objects in MAT-files, for `harness import`",
    "ros": "ROS bags, for `harness import`",
    "control": "to use an exported state space",
    "video": "videos of `harness view`",
    "rerun": "logs of `harness view`",
    "dask": "jobs on other machines",
}
"""Extras of the package besides DART, which is looked at as an engine, and what only developing needs."""


@dataclass(frozen=True)
class Finding:
    """One line of the examination.

    Attributes:
        name: what was looked at.
        ok: whether it is as it should be.
        text: what was found.
        remedy: what to do; empty if nothing is to be done.
        needed: whether the harness does not work without it; else something is only slower or missing.
    """

    name: str
    ok: bool
    text: str
    remedy: str = ""
    needed: bool = True


@dataclass(frozen=True, repr=False)
class Doctor(Summarised):
    """What `doctor` found."""

    findings: tuple[Finding, ...]

    @property
    def fit(self) -> bool:
        """Whether all that is needed works."""
        return all(one.ok for one in self.findings if one.needed)

    @property
    def sentence(self) -> str:
        """The answer."""
        bad = [one for one in self.findings if not one.ok]
        if not bad:
            return "Everything is installed and works."
        names = ", ".join(one.name for one in bad)
        return f"{'What is needed works' if self.fit else 'Something that is needed does not work'}; not ok: {names}."

    def summary(self) -> Summary:
        """The answer and every finding."""
        rows = [
            Row((one.name, "ok" if one.ok else "not ok", one.text + (f" → {one.remedy}" if one.remedy else "")))
            for one in self.findings
        ]
        return Summary("Examination of this machine", [self.sentence], [Table("", texts("what", "", "finding"), rows)])

    def record(self) -> dict[str, Any]:
        """The same for machines."""
        return {
            "schema": 1,
            "fit": self.fit,
            "sentence": self.sentence,
            "findings": [asdict(one) for one in self.findings],
        }


def doctor() -> Doctor:
    """Examine versions, engines, graphics, cores, memory, caches and disk; each engine in a process of its own."""
    return Doctor(tuple(_examined()))


def _examined() -> Iterator[Finding]:
    from harness.engines.catalogue import ENGINES

    right = sys.version_info[:2] == (3, 11)
    yield Finding(
        "python",
        right,
        f"{platform.python_version()} ({sys.executable})",
        "" if right else "Python 3.11 is the tested one, and PyBullet has no wheels for newer ones.",
        needed=False,
    )
    yield from _packages()
    for name in ENGINES:
        yield _engine(name)
    yield from _extras()
    yield _graphics()
    yield from _videos()
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    yield Finding("cores", True, f"{cores} of {os.cpu_count()}")
    yield _memory()
    yield from _caches()
    yield _disk()


def _packages() -> Iterator[Finding]:
    """The harness, and every package that it requires, against the versions that it asks for."""
    try:
        yield Finding("harness", True, version(_DISTRIBUTION))
    except PackageNotFoundError:
        yield Finding("harness", False, "is not installed", "run `make setup`")
        return
    for text in requires(_DISTRIBUTION) or []:
        wanted = Requirement(text)
        if wanted.marker is not None and not wanted.marker.evaluate({"extra": ""}):
            continue
        try:
            found = version(wanted.name)
        except PackageNotFoundError:
            yield Finding(wanted.name, False, f"is not installed, {wanted.specifier} is needed", "run `make setup`")
            continue
        fits = wanted.specifier.contains(found, prereleases=True)
        remedy = "" if fits else f"{wanted.specifier} is needed: run `make setup`"
        yield Finding(wanted.name, fits, found, remedy)


def _extras() -> Iterator[Finding]:
    """Every package of an extra: installed in a version that it asks for, or not, without which the rest works."""
    try:
        asked = [Requirement(text) for text in requires(_DISTRIBUTION) or []]
    except PackageNotFoundError:  # which the harness itself is told as
        return
    for extra, purpose in EXTRAS.items():
        for wanted in asked:
            if wanted.marker is None or wanted.marker.evaluate({"extra": ""}):
                continue
            if not wanted.marker.evaluate({"extra": extra}):
                continue
            remedy = f"it is optional, {purpose}: `pip install 'ball-beam-harness[{extra}]'`"
            what = f"{wanted.name} [{extra}]"
            try:
                found = version(wanted.name)
            except PackageNotFoundError:
                yield Finding(what, False, "is not installed", remedy, needed=False)
                continue
            fits = wanted.specifier.contains(found, prereleases=True)
            text = found if fits else f"{found}, {wanted.specifier} is asked for"
            yield Finding(what, fits, text, "" if fits else remedy, needed=False)


def run_steps(name: str) -> str:
    """Load an engine, let a ball roll down a beam tilted by 0.05 rad for 20 ms, and give the engine's version.

    Raises:
        InputError: it cannot be loaded.
        EngineFailure: it does not simulate that.
    """
    import numpy as np

    from analytic.motion import State
    from analytic.quintic import QuinticMotion
    from analytic.rig import Rig
    from harness.engines.catalogue import engine_of

    engine = engine_of(name)
    beam = QuinticMotion(np.array([0.0, 1.0]), np.array([[0.05, 0.0, 0.0]] * 2))
    engine.run(Rig(), beam, State(0.3, 0.0), np.linspace(0.0, 0.02, 3))
    return engine.version()


def _engine(name: str) -> Finding:
    """Whether an engine loads and runs; a crash of its library ends only the process that tried it."""
    needed = name not in _OPTIONAL
    remedy = "run `make setup`" if needed else "it is optional: `pip install 'ball-beam-harness[dart]'` and libGL.so.1"

    def told(version: str) -> Finding:
        return Finding(what, True, f"{version}: loads and runs", needed=needed)

    what = f"engine {name}"
    return _tried(Finding(what, False, "did not run ten steps", remedy, needed), told, _PATIENCE, run_steps, name)


def drawing() -> tuple[str, str, str]:
    """The kind of OpenGL context that draws without a window, why others do not, and what to install if none does."""
    from harness.engines.catalogue import load_mujoco

    load_mujoco()
    from harness.viewing.offscreen import REMEDY, try_contexts

    tried = try_contexts()
    return tried.kind, str(tried), REMEDY


def encoder() -> str:
    """What writes videos.

    Raises:
        InputError: the packages for it are not installed.
    """
    from harness.engines.catalogue import load_mujoco

    load_mujoco()
    from harness.viewing.film import check_target

    check_target(Path("video.mp4"))
    return "MP4 and GIF can be written"


def _videos() -> Iterator[Finding]:
    """Whether `harness view --video` works: pictures without a window, and a writer for them."""

    def told(found: tuple[str, str, str]) -> Finding:
        kind, faults, remedy = found
        if kind:
            return Finding(what, True, f"works by {kind}", needed=False)
        return Finding(what, False, f"no OpenGL context can be made ({faults})", remedy, needed=False)

    what = "offscreen rendering"
    failed = Finding(what, False, "made no OpenGL context", "see engine mujoco, which draws", needed=False)
    yield _tried(failed, told, _PATIENCE_GRAPHICS, drawing)
    failed = Finding(
        "video encoder",
        False,
        "did not load",
        "`harness view --video` alone needs it",
        needed=False,
    )
    yield _tried(failed, lambda text: Finding("video encoder", True, text, needed=False), _PATIENCE, encoder)


def _tried(
    failed: Finding, told: Callable[[Any], Finding], patience: float, job: Callable[..., Any], *arguments: str
) -> Finding:
    """What a job in a process of its own tells, which a crash cannot take down with it.

    Args:
        failed: what to say if it does not end well; its text is what has not been done when time is up.
        told: the finding from what the job gives.
        patience: how long it may take [s].
        job: a function that a new process can import, and its arguments.
    """
    pool = ProcessPoolExecutor(1, mp_context=get_context("spawn"))
    try:
        return told(pool.submit(job, *arguments).result(patience))
    except BrokenProcessPool:
        return replace(failed, text="crashed the process that ran it")
    except TimeoutError:
        return replace(failed, text=f"{failed.text} within {patience:.0f} s", remedy="try again when less runs")
    except GraphicsVariable as error:
        return replace(failed, text=str(error), remedy="")  # which says what to do
    except Exception as error:  # whatever a foreign library raises is what the user wants to see
        return replace(failed, text=str(error) or type(error).__name__)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _graphics() -> Finding:
    found = find_library("GL")
    remedy = "" if found else "install it for DART and for viewers (Debian: libgl1)"
    return Finding("OpenGL", found is not None, found or "libGL is not installed", remedy, needed=False)


def _memory() -> Finding:
    try:
        free = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
        total = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError, AttributeError):
        return Finding("memory", True, "unknown on this system", needed=False)
    enough = total >= _MEMORY
    remedy = "" if enough else "a diagnosis needs about 1 GB; end other programs or take another machine"
    return Finding("memory", enough, f"{total / 1e9:.1f} GB, {free / 1e9:.1f} GB of it unused", remedy, needed=False)


def _caches() -> Iterator[Finding]:
    """Where compiled kernels are kept, whether they can be written, and whether there are any of this code."""
    from analytic.lean_step import path_of

    # There is no public access to where numba keeps machine code, and under which names.
    kept: Any = vars(path_of)["_cache"]
    folder, of_this_code = Path(kept.cache_path), kept._impl.filename_base.rsplit("-", 1)[-1]
    writable = _writable(folder)
    remedy = "" if writable else "set NUMBA_CACHE_DIR to a folder that can be written, or each start compiles anew"
    yield Finding("cache of kernels", writable, str(folder), remedy, needed=False)
    files = [file.name for file in folder.glob("*.nbi")]
    fresh = sum(of_this_code in name for name in files)
    stale = len(files) - fresh
    text = f"{fresh} of this code, {stale} of older code"
    remedy = "" if fresh else "the first command compiles them, which takes up to two minutes"
    yield Finding("compiled kernels", fresh > 0, text, remedy, needed=False)


def _writable(folder: Path) -> bool:
    there = next(one for one in (folder, *folder.parents) if one.exists())
    return os.access(there, os.W_OK)


def _disk() -> Finding:
    folder = tempfile.gettempdir()
    free = shutil.disk_usage(folder).free
    enough = free >= _DISK
    remedy = "" if enough else "make room there, or set TMPDIR to another folder"
    return Finding("temporary folder", enough, f"{folder}: {free / 1e9:.1f} GB free", remedy, needed=False)
