"""The identified model as an FMU for co-simulation, FMI 2.0 or 3.0, built from the exported C."""

from __future__ import annotations

import hashlib
import io
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from harness.errors import InputError
from harness.exports.model import ExportModel
from harness.exports.source import context_of, render

Fmi = Literal[2, 3]
_IDENTIFIER = "ball_beam"
_BUILD_TIME = (1980, 1, 1, 0, 0, 0)  # in the archive, so that the same model gives the same file
_MACHINES = {"amd64": "x86_64", "arm64": "aarch64"}  # names of FMI 3 for those of Python
_LONGEST_BUILD = 120.0  # [s]


@dataclass(frozen=True)
class Variable:
    """A variable of the FMU; `number` is its value reference."""

    number: int
    name: str
    causality: str
    unit: str
    meaning: str

    @property
    def variability(self) -> str:
        """As FMI calls it."""
        return "fixed" if self.causality == "parameter" else "continuous"


VARIABLES = (
    Variable(1, "angle", "input", "rad", "beam angle as measured or commanded"),
    Variable(2, "rate", "input", "rad/s", "its rate"),
    Variable(3, "angular_acceleration", "input", "rad/s2", "its second derivative"),
    Variable(4, "start_position", "parameter", "m", "position of the ball at the start"),
    Variable(5, "start_velocity", "parameter", "m/s", "velocity of the ball at the start"),
    Variable(6, "phase", "parameter", "rad", "how the ball lies at the start, for laws of the rolled angle"),
    Variable(7, "position", "output", "m", "what the sensor records"),
    Variable(8, "ball_position", "output", "m", "position of the ball"),
    Variable(9, "ball_velocity", "output", "m/s", "velocity of the ball"),
)


def fmu_bytes(model: ExportModel, fmi: Fmi, readme: str) -> bytes:
    """The FMU, an archive: description, binary for this platform, sources.

    Args:
        model: the model.
        fmi: version of the standard.
        readme: text of its documentation.

    Raises:
        InputError: there is no compiler, or it fails; or an effect cannot be written as source code.
    """
    context = dict(context_of(model, "an FMU"))
    sources = {name: render(name, context) for name in ("ball_beam.h", "ball_beam.c")}
    token = hashlib.sha256("".join(sources.values()).encode() + str(fmi).encode()).hexdigest()
    # FMI 2 asks for a text that looks like a GUID, in braces.
    token = f"{{{token[:8]}-{token[8:12]}-{token[12:16]}-{token[16:20]}-{token[20:32]}}}"
    context |= {"fmi": fmi, "token": token, "variables": list(VARIABLES)}
    sources["fmu.c"] = render("fmu.c", context)
    folder, suffix = _place(fmi)
    content: dict[str, bytes] = {"modelDescription.xml": render("modelDescription.xml", context).encode()}
    content |= {f"sources/{name}": text.encode() for name, text in sources.items()}
    if fmi == 3:
        content["sources/buildDescription.xml"] = render("buildDescription.xml", context).encode()
    content["documentation/README.txt"] = readme.encode()
    content[f"binaries/{folder}/{_IDENTIFIER}{suffix}"] = _built(sources, suffix)
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
        for name, data in content.items():
            file.writestr(zipfile.ZipInfo(name, _BUILD_TIME), data, zipfile.ZIP_DEFLATED)
    return archive.getvalue()


def _place(fmi: Fmi) -> tuple[str, str]:
    """Folder of the binary for this platform, and the suffix of a shared library."""
    system = {"linux": "linux", "darwin": "darwin", "win32": "windows"}.get(sys.platform)
    if system is None:
        raise InputError(f"no FMU can be built on {sys.platform}; export with --to c and compile it where it is to run")
    suffix = {"linux": ".so", "darwin": ".dylib", "windows": ".dll"}[system]
    if fmi == 2:
        return {"linux": "linux64", "darwin": "darwin64", "windows": "win64"}[system], suffix
    machine = platform.machine().lower()
    return f"{_MACHINES.get(machine, machine)}-{system}", suffix


def _compiler() -> list[str]:
    """The C compiler and its first arguments: what the variable CC says, such as `ccache gcc`; else cc, gcc or clang.

    Raises:
        InputError: there is none.
    """
    asked = os.environ.get("CC", "").strip()
    # The whole may be a path with blanks.
    for words in [[asked], _words(asked)] if asked else [["cc"], ["gcc"], ["clang"]]:
        found = shutil.which(words[0]) if words else None
        if found:
            return [found, *words[1:]]
    raise InputError(
        f"no C compiler ({asked or 'cc, gcc or clang'}), which an FMU needs; install one, name it in the variable "
        f"CC, or "
        "take the sources with --to c"
    )


def _words(command: str) -> list[str]:
    """The words of a command, as a shell has them; none where its quotes do not end."""
    try:
        return shlex.split(command, posix=os.name != "nt")
    except ValueError:
        return []


def _built(sources: dict[str, str], suffix: str) -> bytes:
    """The shared library of these sources."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in sources.items():
            (folder / file).write_text(text, encoding="utf-8")
        library = folder / f"{_IDENTIFIER}{suffix}"
        # No contraction of products and sums, so that it computes as the exported C does elsewhere.
        flags = ["-std=c99", "-O2", "-ffp-contract=off", "-shared", "-fPIC", "-fvisibility=hidden"]
        command = [*_compiler(), *flags, "-o", library.name, "fmu.c", "ball_beam.c", "-lm"]
        try:
            done = subprocess.run(
                command, cwd=folder, capture_output=True, text=True, timeout=_LONGEST_BUILD, check=False
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            raise InputError(f"{command[0]}: cannot compile the FMU ({error}); take the sources with --to c") from error
        if done.returncode:
            told = " ".join(done.stderr.split())[-400:]
            raise InputError(f"{command[0]}: cannot compile the FMU ({told}); take the sources with --to c")
        return library.read_bytes()
