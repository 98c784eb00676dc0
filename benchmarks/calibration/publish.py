"""The tables as files, with the page that shows them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.calibration.page import FOLDER, PICTURE, page
from benchmarks.calibration.picture import draw
from benchmarks.calibration.rows import Row
from benchmarks.calibration.sizes import SIZES
from benchmarks.calibration.tables import tables


def publish(rows: Sequence[Row], docs: Path, source: str) -> list[Path]:
    """Write `calibration/*.csv`, a picture and `calibration.md` into `docs`, and delete tables of former rows.

    Returns:
        What was written.
    """
    folder, made = docs / FOLDER, tables(rows)
    folder.mkdir(parents=True, exist_ok=True)
    for former in (*folder.glob("*.csv"), *folder.glob(PICTURE)):
        former.unlink()
    written = []
    for name, table in made.items():
        written.append(folder / f"{name}.csv")
        table.to_csv(written[-1], index=False, float_format="%.6g", lineterminator="\n")
    confusions = {size: made[f"confusion_{size}"] for size in SIZES if f"confusion_{size}" in made}
    if confusions:
        written.append(folder / PICTURE)
        draw(confusions, written[-1])
    written.append(folder.with_suffix(".md"))
    written[-1].write_text(page(rows, made, source), encoding="utf-8", newline="\n")
    return written
