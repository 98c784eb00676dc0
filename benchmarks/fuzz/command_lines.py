"""Command lines: every command with options, values and files that fit and that do not; none computes for long."""

from __future__ import annotations

from hypothesis import strategies as st

from benchmarks.fuzz import strange
from benchmarks.fuzz.doors import CSV, EFFECTS, RIG
from harness.identify.record import FILE

FILES = (CSV, RIG, EFFECTS, FILE)
_ABSENT = ("missing", "missing.csv", "", "..", "a/b/c", "~", "-", "--", "é.csv", "x" * 300)
# Nothing is written outside of the folder: `--out` takes what it is given.
_PATHS = st.sampled_from((*FILES, *FILES, ".", *_ABSENT)) | strange.texts.filter(lambda text: "/" not in text)
_VALUES = st.sampled_from(("0.1", "1", "estimate", "0.36,0", "-0.16deg", "mujoco", "mujoco.friction=0.3")) | (
    strange.numbers | strange.texts
)
_OPTIONS = {
    "predict": ("--out", "--effects", "--force", "--json"),
    "replay": ("--refit", "--engines", "--effects", "--json"),
    "run": (
        *("--out", "--recording", "--engine", "--set", "--parameters", "--start", "--level-angle", "--window"),
        *("--tube", "--seed", "--check", "--tolerances", "--effects", "--force", "--yes", "--json"),
    ),
    "diagnose": ("--out", "--also", "--effects", "--accept", "--force", "--yes", "--json"),
    "import": (
        *("--out", "--into", "--join", "--time", "--angle", "--position", "--rate", "--linkage", "--flip-angle"),
        *("--keep-signs", "--rig", "--origin", "--json"),
    ),
    "export": ("--to", "--out", "--fmi", "--at", "--pade", "--effects", "--force", "--json"),
    "check": ("--out", "--force", "--json", "--quiet"),
    "check-scene": ("--beam-joint", "--ball", "--direction", "--driven-joint", "--out", "--force", "--json"),
    "tune": (
        *("--engine", "--free", "--set", "--parameters", "--diagnosis", "--effects", "--accept", "--out", "--force"),
        *("--yes", "--json"),
    ),
    "sweep": ("--out", "--jobs", "--on", "--force", "--yes", "--json"),
    "completion": (),
    "simulate": ("--out", "--hide", "--declare", "--imperfection", "--duration", "--seed", "--force"),
}
_OF_PATHS = ("--out", "--into", "--effects", "--also", "--parameters", "--tolerances", "--diagnosis")
_FLAGS = (
    *("--force", "--yes", "--json", "--refit", "--engines", "--check", "--join", "--flip-angle", "--keep-signs"),
    "--quiet",
)
_EXPORTED = ("python", "c", "statespace", "mjcf", "no_such", "")  # of an FMU the compiler takes long
# A case that is never good: what is before and beside it is what is tried.
_NO_CASES = st.sampled_from((*_ABSENT[:4], RIG + "x", EFFECTS, FILE)) | strange.texts.filter(
    lambda text: "." not in text
)


@st.composite
def command_lines(draw: st.DrawFn) -> list[str]:
    """Words after `harness`; at most a prediction or a replay's refusal is computed."""
    command = draw(st.sampled_from(tuple(_OPTIONS)))
    words = [command]
    if command in ("predict", "replay"):
        words += [draw(st.sampled_from((FILE, FILE, ".")) | _PATHS), draw(st.sampled_from((CSV, CSV)) | _PATHS)]
    elif command in ("run", "diagnose", "check", "check-scene", "tune", "sweep", "completion"):
        words.append(draw(_NO_CASES))
    elif command == "import":
        words.append(draw(st.sampled_from((CSV, CSV)) | _PATHS))
    elif command == "export":
        words += [draw(st.sampled_from((FILE, FILE, ".")) | _PATHS), "--to", draw(st.sampled_from(_EXPORTED))]
    else:
        words += ["--hide", "no_such_effect.size=1"]
    for _ in range(draw(st.integers(0, 3))):
        option = draw(st.sampled_from((*_OPTIONS[command], "--help")) | st.sampled_from(("--help", "--no-such", "-x")))
        words.append(option)
        if option.startswith("--") and option not in (*_FLAGS, "--help", "--no-such"):
            words.append(draw(_PATHS if option in _OF_PATHS else _VALUES))
    if draw(st.integers(0, 9)) == 0:
        words.append(draw(_PATHS))
    return words


def replaced_by(words: list[str]) -> tuple[str, ...]:
    """Files that a command is asked to replace, whatever they are."""
    return tuple(words[at + 1] for at, word in enumerate(words[:-1]) if word == "--out" and "--force" in words)
