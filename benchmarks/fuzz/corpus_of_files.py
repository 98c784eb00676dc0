"""Kept inputs of the doors that take files of other programs: imports, sweeps, settings and scenes."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator

from benchmarks.fuzz.doors import MJCF, SETTINGS, SWEEP, URDF, seed
from benchmarks.fuzz.foreign import BINARIES, BOOK, TEXTS, with_member
from benchmarks.fuzz.scenes import ELEMENTS, PREFIXES

_DEEP = b"a = " + b"[" * 5000
_LONG = b"a = " + b"9" * 5000
_LAUGHS = (
    '<?xml version="1.0"?><!DOCTYPE lolz [<!ENTITY a "lol">'
    + "".join(f'<!ENTITY {new} "{f"&{old};" * 10}">' for old, new in zip("abcdefghi", "bcdefghij", strict=True))
    + "]>"
)


def foreign() -> Iterator[tuple[str, bytes]]:
    """Files to import."""
    for name in (*TEXTS, *BINARIES, BOOK):
        raw = seed(name)
        stem = name.replace(".", "_")
        yield f"{stem}_good", raw
        yield f"{stem}_half", raw[: len(raw) // 2]
        yield f"{stem}_hole", raw[: len(raw) // 3] + b"\xff" * 64 + raw[len(raw) // 3 + 64 :]
    for at, (old, new) in enumerate(
        (("0.02", "nan"), ("0.02", "-1"), ("0.02", "1e999"), ("S,", "parsec,"), ("TIME", ""), ("CH2", "CH1"))
    ):
        yield f"scope_{at}", seed("scope.csv").decode().replace(old, new, 1).encode()
    book = seed(BOOK)
    with zipfile.ZipFile(io.BytesIO(book)) as archive:
        name = next(one for one in archive.namelist() if "worksheets/" in one)
        sheet = archive.read(name).decode()
    body = sheet[sheet.index("<worksheet") :]
    yield "book_laughs", with_member(book, name, (_LAUGHS + body.replace("<v>", "<v>&j;", 1)).encode())
    entity = '<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/passwd">]>'
    yield "book_entity", with_member(book, name, (entity + body.replace("<v>", "<v>&b;", 1)).encode())
    yield "book_far_cell", with_member(book, name, body.replace("</row>", '<c r="XFD5"><v>1</v></c></row>', 1).encode())
    yield "book_no_sheet", with_member(book, name, b"")


def sweeps() -> Iterator[tuple[str, bytes]]:
    """Changes of sweep.toml."""
    good = seed(SWEEP).decode()
    yield "good", good.encode()
    changes = (
        *(("size = 8", f"size = {value}") for value in ("0", "-1", "2.5", "nan", "true", "'a'", "9" * 400)),
        *(("window_s = 1.0", f"window_s = {value}") for value in ("0", "nan", "1e300", "1e-300", "[]")),
        *(("time_step = [4e-3, 2e-3]", f"time_step = {value}") for value in ("[]", "[0.0]", "[nan]", "{}", "1e-300")),
        *(("low = 0.1, high = 0.5", text) for text in ("low = 0.5, high = 0.1", "low = nan, high = 1", "low = 0.1")),
        *(('cases = ["case"]', f"cases = {value}") for value in ("[]", '["no"]', '["case", "case"]', '["\\u0000"]')),
        ("coefficient", "no_such"),
        ("rolling_resistance", "no_such"),
        ("level_angle_rad", "level_angle"),
    )
    for at, (old, new) in enumerate(changes):
        yield f"changed_{at:02d}", good.replace(old, new).encode()
    yield "deep", _DEEP
    yield "long_integer", _LONG


def settings() -> Iterator[tuple[str, bytes]]:
    """Changes of a file of settings."""
    yield "good", seed(SETTINGS)
    texts = (
        "[mujoco]\nfriction = nan",
        "[mujoco]\ntime_step = 1e-300",
        "[mujoco]\nno_such = 1",
        "mujoco = 1",
        "[no_such]\na = 1",
        "[rig]\nmass_kg = 0",
        "[rig]\nmass_kg = 1" + "0" * 400,
        "[rig]\nno_such = 1",
        "rig = []",
        "[rig]\nrolling_radius_m = 1.0",
    )
    for at, text in enumerate(texts):
        yield f"changed_{at:02d}", text.encode()
    yield "deep", _DEEP
    yield "long_integer", _LONG
    yield "latin", "[mujoco]\n# é".encode("latin-1")


def scenes(name: str) -> Iterator[tuple[str, bytes]]:
    """Changes of a scene, `MJCF` or `URDF`."""
    good = seed(name).decode()
    root = "<mujoco" if name == MJCF else "<robot"
    body = good[good.index(root) :]
    yield "good", good.encode()
    for at, prefix in enumerate((*PREFIXES, _LAUGHS)):
        yield f"prefix_{at:02d}", (prefix + body).encode()
    end = body.index(">") + 1
    for at, element in enumerate(one for one in ELEMENTS if one.startswith("<link") == (name == URDF)):
        yield f"element_{at:02d}", (body[:end] + element + body[end:]).encode()
    yield "empty", b""
    yield "no_scene", b"<a/>"
    yield "half", good[: len(good) // 2].encode()
    yield "nested", b"<a>" * 20000
