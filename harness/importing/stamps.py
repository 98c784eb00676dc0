"""Dates and clock times as loggers, spreadsheets and students write them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date

import numpy as np

from analytic.motion import FloatArray
from harness.recording.table import MISSING

DAY = 86400.0  # [s]
MILLISECONDS = 3  # digits behind a colon, as in `12:34:56:789`
_DATE = (
    r"(?:(?P<year>\d{4})[-/.](?P<month>\d{1,2})[-/.](?P<day>\d{1,2})"
    r"|(?P<a>\d{1,2})(?P<by>[./])(?P<b>\d{1,2})[./](?P<y>\d{2,4}))"
)
# Hours, minutes and seconds, or minutes and seconds; the fraction of a second behind a point, a comma or a colon.
_CLOCK = r"(?P<first>\d{1,2}):(?P<second>[0-5]\d)(?::(?P<third>[0-5]\d))?(?:(?P<mark>[.,:])(?P<fraction>\d+))?"
_END = r"\s*(?P<half>[AaPp]\.?[Mm]\.?)?\s*(?P<zone>Z|[+-]\d{2}:?\d{2})?"
_STAMP = re.compile(rf"(?:{_DATE}[T ]\s*)?{_CLOCK}{_END}", re.ASCII)
_DAY = re.compile(_DATE, re.ASCII)


def is_stamp(cell: str) -> bool:
    """Whether a cell is a date with a time, or a clock time."""
    return ":" in cell and bool(_STAMP.fullmatch(cell))


def is_date(cell: str) -> bool:
    """Whether a cell is a date without a time, which loggers write in a column of its own."""
    return bool(_DAY.fullmatch(cell))


def seconds(cells: Sequence[str]) -> FloatArray | None:
    """Dates or clock times as seconds since the first, shape (n,); `None` if a cell is none of these.

    A clock that passes midnight goes on. Two numbers without a date, as in `03:25.4`, are minutes and seconds: a clock
    without seconds would tell the time of no recording. In `03/05/2024` the day is what makes the column go on evenly.
    """
    found = [None if cell.casefold() in MISSING else _STAMP.fullmatch(cell) for cell in cells]
    known = [at for at, cell in enumerate(cells) if cell.casefold() not in MISSING]
    if not known or any(found[at] is None for at in known):
        return None
    stamps = [one for one in found if one is not None]
    by_colon = {len(one["fraction"]) for one in stamps if one["mark"] == ":"}
    if by_colon and max(by_colon) != MILLISECONDS:  # frames of a video, or what else
        return None
    dated = bool(stamps[0]["year"] or stamps[0]["a"])
    if any(bool(one["year"] or one["a"]) != dated for one in stamps):
        return None
    clock = np.array([_of_day(one, dated=dated) for one in stamps])
    if dated:
        days = _days(stamps)
        if days is None:
            return None
        clock += DAY * (days - days[0])
    else:
        clock += DAY * np.concatenate(([0.0], np.cumsum(np.diff(clock) < -DAY / 2)))
    made = np.full(len(cells), np.nan)
    made[known] = clock - clock[0]
    return made


def _of_day(stamp: re.Match[str], *, dated: bool) -> float:
    """Seconds since midnight, without its zone's offset."""
    numbers = [float(one) for one in (stamp["first"], stamp["second"], stamp["third"]) if one]
    fraction = stamp["fraction"] or ""
    if stamp["mark"] == ":":
        fraction = fraction.zfill(MILLISECONDS)
    if len(numbers) == 2 and not dated and not stamp["half"]:
        numbers = [0.0, *numbers]
    hours, minutes, second = [*numbers, 0.0][:3]
    if stamp["half"]:
        hours = hours % 12.0 + (12.0 if stamp["half"][0] in "Pp" else 0.0)
    zone = stamp["zone"] or ""
    shift = 0.0
    if len(zone) > 1:
        shift = (float(zone[1:3]) * 3600.0 + float(zone[-2:]) * 60.0) * (-1.0 if zone[0] == "-" else 1.0)
    return hours * 3600.0 + minutes * 60.0 + second + float(f"0.{fraction or 0}") - shift


def _days(stamps: Sequence[re.Match[str]]) -> FloatArray | None:
    """Day numbers, shape (n,); `None` where a date does not exist."""
    readings = []
    # With points the day comes first; with strokes it does in some countries.
    for order in ("day first", "month first") if stamps[0]["by"] == "/" else ("day first",):
        try:
            cache: dict[str, int] = {}
            days = []
            for one in stamps:
                text = one.string[: one.start("first")]
                if text not in cache:
                    cache[text] = _ordinal(one, order)
                days.append(cache[text])
        except ValueError:
            continue
        readings.append(np.array(days, dtype=np.float64))
    # Read the wrong way, the day after is a month or more away.
    return min(readings, key=lambda days: float(np.max(np.abs(np.diff(days)), initial=0.0)), default=None)


def _ordinal(stamp: re.Match[str], order: str) -> int:
    if stamp["year"]:
        return date(int(stamp["year"]), int(stamp["month"]), int(stamp["day"])).toordinal()
    day, month = (stamp["a"], stamp["b"]) if order == "day first" else (stamp["b"], stamp["a"])
    year = int(stamp["y"]) + (2000 if len(stamp["y"]) == 2 else 0)
    return date(year, int(month), int(day)).toordinal()
