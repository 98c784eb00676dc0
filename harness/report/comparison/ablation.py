"""Ablation section: all combinations of radius, α̈ term, level angle and friction law, each fitted."""

import itertools
import math
from collections.abc import Sequence

from markupsafe import Markup

from analytic.models import Reading
from harness.comparison.ablation import Combination, one_radius
from harness.formatting import aligned, length, number
from harness.report.comparison.friction import READING_LABELS
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.tables import Column, Table, texts

_EQUAL_CONTRAST = 0.179  # luminance on which white and black have the same contrast: √(1.05 · 0.05) − 0.05
_LIGHT, _DARK = (240, 247, 252), (33, 113, 181)  # RGB of smallest and largest error in the heat map


def section(subject: Subject) -> Section:
    """The ablation."""
    study, over = subject.study, subject.over(subject.study.headline)
    differences = [(one.choice, length(one.rms), length(one.largest)) for one in study.differences]
    context = {
        "once": one_radius(study.setting.rig),
        "heat": _heat(subject),
        "fitted": _fitted(subject),
        "differences": Table(
            f"Displacement of the ball by one choice, {over}", [*texts("choice"), "RMS", "largest"], differences
        ),
        "floor": study.floor(study.headline),
    }
    return Section(
        "ablation", "Ablation: contribution of each model term", "Ablation", "comparison/ablation.html", context
    )


def _heat(subject: Subject) -> Table:
    combinations = subject.study.combinations
    errors = {key: 1e3 * one.rms_error for key, one in combinations.items()}
    logs = [math.log(error) for error in errors.values() if 0.0 < error < math.inf]
    low, high = min(logs), max(max(logs), min(logs) + 1e-9)
    least = min(errors.values())
    columns = texts("friction, f_b fitted")
    once = one_radius(subject.study.setting.rig)
    radii = "R" if once else "Rr"  # the columns of r would repeat those of R
    shown = list(itertools.product((False, True), radii, (False, True)))
    for level, radius, eccentric in shown:
        term = f"{'with' if eccentric else 'no'} α̈"
        columns.append(Column(term if once else f"{radius}, {term}", "α₀ fitted" if level else "α₀ = 0"))
    rows = []
    for reading in Reading:
        cells: list[str | Markup] = [READING_LABELS[reading]]
        for level, radius, eccentric in shown:
            error = errors[radius, eccentric, level, reading]
            share = 1.0 if not error < math.inf else (math.log(max(error, math.exp(low))) - low) / (high - low)
            cells.append(_heat_cell(number(error), share, error <= least))
        rows.append(cells)
    caption = f"RMS error in mm {subject.over(subject.study.headline)}; darker is larger, the smallest is framed"
    return Table(caption, columns, rows)


def _heat_cell(text: str, share: float, best: bool) -> Markup:
    colour = tuple(round(a + share * (b - a)) for a, b in zip(_LIGHT, _DARK, strict=True))
    return Markup('<span class="heat{}" style="background:rgb{};color:{}">{}</span>').format(
        " best" if best else "", colour, "#fff" if _luminance(colour) < _EQUAL_CONTRAST else "#000", text
    )


def _luminance(colour: Sequence[int]) -> float:
    """Relative luminance of a colour of sRGB, 0 to 255 each, as WCAG 2 defines it."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (part / 255 for part in colour)]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def _fitted(subject: Subject) -> Table:
    """Fitted parameters of CUM and CAM for each friction law."""
    chosen: list[Combination] = [
        subject.study.combinations[key]
        for reading in Reading
        for key in (("R", False, True, reading), ("r", True, True, reading))
    ]
    rms = aligned([1e3 * one.rms_error for one in chosen])
    largest = aligned([1e3 * one.max_error for one in chosen])
    rows = [
        (
            "CAM" if one.eccentric else "CUM",
            READING_LABELS[one.reading],
            f"{math.degrees(one.level_angle):+.3f}".replace("-", "−"),
            number(one.friction_coefficient) if one.reading else "—",
            one.reading.unit if one.reading else "",
            r,
            m,
            number(one.e_disp),
        )
        for one, r, m in zip(chosen, rms, largest, strict=True)
    ]
    columns = [
        *texts("model", "friction"), "α₀ [deg]", "f_b", *texts("unit of f_b"), "RMS error [mm]", "largest [mm]",
        "E_disp [m s]",
    ]  # fmt: skip
    return Table(f"Fitted α₀ and f_b {subject.over(subject.study.headline)}", columns, rows)
