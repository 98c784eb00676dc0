"""A case that is quickly run: a few seconds of the bundled recording."""

from __future__ import annotations

from pathlib import Path

from harness.recording.case import BUNDLED

BEGIN, END = 7.0, 10.0  # the ball is on its way, and so is the beam: both are felt in a contact [s]


def write_case(folder: Path, *, tolerances: str | None = None, angle_factor: float = 1.0) -> Path:
    """Three seconds of the bundled case's first recording, with these tolerances, or with none of its own."""
    folder.mkdir(parents=True, exist_ok=True)
    rig = (BUNDLED / "rig.toml").read_text(encoding="utf-8")
    lists = '[recordings]\nidentify = ["rec_01.csv"]\n'
    (folder / "rig.toml").write_text(rig[: rig.index("[recordings]")] + lists, encoding="utf-8")
    head, *rows = (BUNDLED / "rec_01.csv").read_text(encoding="utf-8").splitlines()
    names = head.split(",")
    time, angle = names.index("time_s"), names.index("beam_angle_rad")
    lines = [head]
    for row in rows:
        cells = row.split(",")
        if BEGIN <= float(cells[time]) <= END:
            cells[angle] = repr(angle_factor * float(cells[angle]))
            lines.append(",".join(cells))
    (folder / "rec_01.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    if tolerances is not None:
        (folder / "tolerances.toml").write_text(tolerances, encoding="utf-8")
    return folder
