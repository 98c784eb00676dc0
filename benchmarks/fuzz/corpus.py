"""`python -m benchmarks.fuzz.corpus`: write the kept inputs of tests/fuzz/corpus, and the table of their outcomes.

What is kept: inputs that went wrong once, and one of each kind of change to a good input. A file is what a door is
given; a change of diagnosis.json is kept as `{"at": [key, …], "value": …}`, as the whole is long, and a command line as
a list of words. Everything is made from the seeds, so that a changed format costs one command.
"""

from __future__ import annotations

import csv
import itertools
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from benchmarks.fuzz import corpus_of_files
from benchmarks.fuzz.doors import CSV, MJCF, RIG, URDF, Broken, seed
from benchmarks.fuzz.properties import outcome_of
from benchmarks.fuzz.python_files import FIRST, LAWS, OTHERS
from harness.identify.record import FILE

FOLDER = Path("tests/fuzz/corpus")
TABLE = "outcomes.csv"
SUFFIXES = {"csv": ".csv", "rig": ".toml", "diagnosis": ".json", "effects": ".txt", "options": ".json"}
SUFFIXES |= {"import": ".dat", "sweep": ".toml", "settings": ".toml", "mjcf": ".xml", "urdf": ".urdf"}
"""Effects are kept as text, so that no tool takes them for Python of the project."""
Kept = tuple[str, str, bytes]
"""Kind, name, content."""


def given_of(kind: str, content: bytes) -> bytes | list[str]:
    """What the door is given: a kept change is applied to the seed."""
    if kind == "options":
        words: list[str] = json.loads(content)
        return words
    if kind != "diagnosis" or not content.startswith(b'{"at"'):
        return content
    change = json.loads(content)
    whole = json.loads(seed(FILE))
    home = whole
    for key in change["at"][:-1]:
        home = home[key]
    home[change["at"][-1]] = change["value"]
    return json.dumps(whole).encode()


def recordings() -> Iterator[tuple[str, bytes]]:
    """Recordings, changed."""
    good = seed(CSV).decode().splitlines()[:60]
    head, rows = good[0], good[1:]

    def with_cell(value: str, column: int = 2, row: int = 20) -> bytes:
        cells = rows[row].split(",")
        cells[column] = value
        return "\n".join([head, *rows[:row], ",".join(cells), *rows[row + 1 :]]).encode()

    yield "good", "\n".join(good).encode()
    for at, text in enumerate(("nan", "inf", "1e999", "1e21", "1_000", "0x10", "٣", "½", "\x1b[31m", "", "text", '"')):
        yield f"position_{at:02d}", with_cell(text)
    for at, text in enumerate(("nan", "", "-1", "1e19", "0.0", "x")):
        yield f"stamp_{at:02d}", with_cell(text, 0)
        yield f"angle_{at:02d}", with_cell(text, 1)
    heads = (
        "",
        "a,b,c",
        "time_s,time_s,time_s",
        "t,angle,x",
        "time_ms,beam_angle_deg,ball_position_mm",
        "0,0,0",
        "Ωß,🎱,\x85",
    )
    for at, text in enumerate(heads):
        yield f"header_{at:02d}", "\n".join([text, *rows]).encode()
    whole = "\n".join(good)
    yield "utf16", whole.encode("utf-16")
    yield "utf16_no_mark", whole.encode("utf-16-le")
    yield "utf32", whole.encode("utf-32")
    yield "ebcdic", whole.encode("cp037")
    yield "carriage_returns", whole.replace("\n", "\r").encode()
    yield "vertical_tabs", whole.replace(",", "\x0b").encode()
    yield "line_separators", whole.replace("\n", "\u2028").encode()
    yield "semicolons_commas", whole.replace(",", ";").replace(".", ",").encode()
    yield "quoted", "\n".join(",".join(f'"{cell}"' for cell in row.split(",")) for row in good).encode()
    yield "empty", b""
    yield "blank", b"\n\n \n"
    yield "header_only", head.encode()
    yield "one_row", "\n".join(good[:2]).encode()
    yield "reversed", "\n".join([head, *rows[::-1]]).encode()
    yield "equal_stamps", "\n".join([head, *("0.0," + row.split(",", 1)[1] for row in rows)]).encode()
    yield "doubled", "\n".join([head, *(row for row in rows for _ in range(2))]).encode()
    yield "constant", "\n".join([head, *(row.rsplit(",", 1)[0] + ",0.3" for row in rows)]).encode()
    yield "zero_bytes", b"\0" * 100
    yield "spreadsheet", b"PK\x03\x04" + b"x" * 50


def rigs() -> Iterator[tuple[str, bytes]]:
    """rig.toml, changed."""
    good = seed(RIG).decode()
    yield "good", good.replace('"rec_01.csv", "rec_02.csv"', '"rec_01.csv"').replace('"rec_03.csv"', "").encode()
    changes = (
        *(
            ("mass_kg = 0.071", f"mass_kg = {value}")
            for value in ("nan", "-1", "0", "1e300", "1e-300", "'a'", "[]", "71")
        ),
        *(("radius_m = 0.0132", f"radius_m = {value}") for value in ("13.2", "inf", "true", "0.01", "1e-200")),
        *(("[ball]", value) for value in ("[[ball]]", "[Ball]", "ball = 1", "[ball]\nmass_kg = 1", "\x01\x0b")),
        *(("gravity_m_s2 = 9.81", f"gravity_m_s2 = {value}") for value in ("9,81", "-9.81", "10" + "0" * 400)),
        ('identify = ["rec_01.csv", "rec_02.csv"]', 'identify = ["../rec_01.csv"]'),
        ('identify = ["rec_01.csv", "rec_02.csv"]', 'identify = ["rec_01.csv", "rec_01.csv"]'),
        ('identify = ["rec_01.csv", "rec_02.csv"]', "identify = [1]"),
        ('identify = ["rec_01.csv", "rec_02.csv"]', 'identify = ["' + "a" * 300 + '"]'),
        ('identify = ["rec_01.csv", "rec_02.csv"]', 'identify = ["\\u0000"]'),
    )
    for at, (old, new) in enumerate(changes):
        yield f"changed_{at:02d}", good.replace(old, new).encode()


def diagnoses() -> Iterator[tuple[str, bytes]]:
    """Changes of diagnosis.json, and bytes that are none."""
    yield "empty", b""
    yield "no_object", b"[]"
    yield "half", seed(FILE)[:200]
    yield "deep", b"[" * 5000 + b"]" * 5000
    yield "long_integer", b'{"schema": ' + b"9" * 5000 + b"}"
    texts = ("schema", "verdict", "sentence", "effects", "model", "fits", "ledger", "sealed", "findings", "\x1e")
    inner = ("rig", "parameters", "covariance", "reading_variance_m2", "sensors", "effects", "no_such_key")
    places: list[list[str | int]] = [[text] for text in texts]
    places += [["model", text] for text in inner]
    places += [["effects", 0, "name"], ["effects", 0, "parameters"], ["effects", 0]]
    values: tuple[Any, ...] = (None, -1, {"a": 1e300})
    for at, (place, value) in enumerate(itertools.product(places, values)):
        yield f"changed_{at:02d}", json.dumps({"at": place, "value": value}).encode()


def effects() -> Iterator[tuple[str, bytes]]:
    """Files of effects."""
    form = (
        "import numpy as np\nfrom analytic.effects import Effect, Force, Parameter, SensorLaw\n{first}\n"
        'MINE = Effect("mine", "F", (Parameter("size", "N", -1.0, 1.0, 0.1),), source="here", {law})\n'
    )
    usual = 'force=Force("position", lambda s, size: size * s)'
    for at, first in enumerate(FIRST):
        yield f"first_{at:02d}", form.format(first=first, law=usual).encode()
    for at, law in enumerate(LAWS):
        yield f"law_{at:02d}", form.format(first="", law=f'force=Force("position", {law})').encode()
    for at, other in enumerate(OTHERS):
        yield f"other_{at:02d}", form.format(first="", law=other).encode()
    yield "bytes", bytes(range(1, 256))
    yield "level_error", form.format(first="", law=usual).replace('"mine"', '"level_error"').encode()


def options() -> Iterator[tuple[str, bytes]]:
    """Command lines."""
    lines: tuple[tuple[str, ...], ...] = (
        ("predict", FILE, CSV, "--out", "out.csv"),
        ("predict", FILE, CSV, "--out", CSV, "--force"),
        ("predict", FILE, CSV, "--out", FILE, "--force"),
        ("predict", FILE, CSV, "--out", RIG),
        ("predict", FILE, CSV, "--out", ""),
        ("predict", FILE, CSV, "--out", ".."),
        ("predict", FILE, CSV, "--effects", "mine.py", "--effects", "mine.py"),
        ("predict", CSV, FILE),
        ("predict", ".", RIG),
        ("replay", FILE, CSV),
        ("replay", RIG, FILE),
        ("run", "missing", "--parameters", "\x85", "--force"),
        ("run", "a", "b\x9bc"),
        ("run", "missing", "--window", "nan"),
        ("run", "missing", "--tube", "inf"),
        ("run", "missing", "--seed", "-1"),
        ("run", "missing", "--set", "mujoco.time_step=1e-12"),
        ("run", "missing", "--set", "mujoco.friction="),
        ("run", "missing", "--start", "1,2,3"),
        ("run", "missing", "--level-angle", "1e400deg"),
        ("diagnose", "missing", "--accept", "nothing"),
        ("diagnose", "x" * 300),
        ("simulate", "--out", CSV),
        ("simulate", "--out", "new", "--hide", "level_error.angle=nan"),
        ("simulate", "--out", "new", "--duration", "1e9"),
        ("no_such_command",),
        ("import", FILE, "--out", "new"),
        ("import", "missing", "--linkage", "r=0"),
        ("import", CSV, "--rig", "ball.mass_kg=nan"),
        ("import", CSV, "--out", RIG),
        ("export", FILE, "--to", "python", "--out", CSV),
        ("export", FILE, "--to", "statespace", "--at", "position=nan"),
        ("export", RIG, "--to", "c"),
        ("check-scene", "."),
        ("check-scene", RIG),
        ("sweep", CSV),
        ("sweep", "missing", "--on", "dask://"),
        ("tune", "missing", "--parameters", FILE),
        ("run", "missing", "--set", "mujoco.friction=" + "9" * 5000),
        ("run", "missing", "--set", "mujoco.friction=" + "[" * 5000),
    )
    for at, words in enumerate(lines):
        yield f"line_{at:02d}", json.dumps(words).encode()


def every() -> Iterator[Kept]:
    """All that is kept."""
    for kind, made in (
        ("csv", recordings()),
        ("rig", rigs()),
        ("diagnosis", diagnoses()),
        ("effects", effects()),
        ("options", options()),
        ("import", corpus_of_files.foreign()),
        ("sweep", corpus_of_files.sweeps()),
        ("settings", corpus_of_files.settings()),
        ("mjcf", corpus_of_files.scenes(MJCF)),
        ("urdf", corpus_of_files.scenes(URDF)),
    ):
        for name, content in made:
            yield kind, name, content


def place_in(message: str) -> str:
    """File, row and column that a message names first; what follows may be Python's own and change with it."""
    return message.partition(": ")[0]


def write(folder: Path = FOLDER) -> None:
    """All files, and the table with the exit code of each, and the place that its message names."""
    folder.mkdir(parents=True, exist_ok=True)
    rows, broken = [], []
    for kind, name, content in every():
        (folder / kind).mkdir(exist_ok=True)
        file = f"{kind}/{name}{SUFFIXES[kind]}"
        (folder / file).write_bytes(content)
        try:
            made = outcome_of(kind, given_of(kind, content))
        except Broken as error:
            broken.append(f"{file}: {error}")
            continue
        rows.append((file, made.code, place_in(made.message)))
    with (folder / TABLE).open("w", encoding="utf-8", newline="") as table:
        writer = csv.writer(table, lineterminator="\n")
        writer.writerows([("file", "code", "place"), *rows])
    print(*broken, f"{len(rows)} inputs kept in {folder}", sep="\n")


if __name__ == "__main__":
    write()
