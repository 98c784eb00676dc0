"""Section on errors by horizon without and with the effects found, for CAM and engines, and on innovations."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from harness.engines.health import largest_of_each
from harness.formatting import NONE, brief, fixed, number
from harness.identify.problem.windows import GROUPS, KNOWN
from harness.identify.validation.beam_dependence import SIGNIFICANT
from harness.identify.validation.engine_errors import entries
from harness.identify.validation.held_out import BeforeAfter, Errors
from harness.metrics.score import WHOLE
from harness.report.diagnosis.account import Account
from harness.report.diagnosis.growth import picture_of
from harness.report.page import Section
from harness.report.scenes import scenes_in_words
from harness.report.tables import Column, Table, texts
from harness.report.wording import error_size, words

_ENGINES = {"mujoco": "MuJoCo", "pybullet": "PyBullet"}
_INPUTS = {"angle": "α", "rate": "α̇", "acceleration": "α̈"}

Engines = Mapping[str, Mapping[str, Any]]


def section(account: Account) -> Section:
    """The section."""
    diagnosis = account.diagnosis
    held = {name: one["heldout"] for name, one in diagnosis.engines.items() if "heldout" in one}
    tables = [
        _table(account, "Held out", diagnosis.heldout, held),
        _table(account, "Identification", diagnosis.identify, diagnosis.engines),
    ]
    for name, one in diagnosis.also.items():
        tables.append(_table(account, f"Also {name}, not used for fitting", one.errors, one.engines))
    context = {
        "split": _split(len(diagnosis.problem.recordings)),
        "ran": _ran(account),
        "known": brief(KNOWN),
        "scenes": scenes_in_words(account.case.scene, diagnosis.engines),
        "changed": account.changed,
        "picture": picture_of(account),
        "tables": tables,
        "enter": [(words(name), place) for name, place in entries(diagnosis.found).items()],
        "failures": _failures(account),
        "warnings": _warnings(account),
        "innovations": _innovations(account),
        "significant": brief(SIGNIFICANT),
    }
    return Section("errors", "Errors before and after", "Errors", "diagnosis/errors.html", context)


def _split(recordings: int) -> str:
    """How recordings were held out."""
    if recordings == 1:
        return "each half of the recording, with parameters fitted to the other"
    what = "each recording" if recordings <= GROUPS else f"each of {GROUPS} groups of recordings"
    return f"{what} in turn, with parameters fitted to the others"


def _ran(account: Account) -> str:
    """The recordings that the engines ran, if those were not all."""
    names = [tuple(one.get("recordings", ())) for one in account.diagnosis.engines.values()]
    all_of_them = len(account.diagnosis.problem.recordings)
    ran = next((each for each in names if 0 < len(each) < all_of_them), ())
    return f"{', '.join(ran)}, {len(ran)} of {all_of_them} recordings" if ran else ""


def _whens(account: Account) -> tuple[str, ...]:
    """Only `before` if nothing was found."""
    return ("before", "after") if account.changed else ("before",)


def _heads(account: Account, names: Iterable[str]) -> list[Column]:
    """One or two columns per name."""
    if not account.changed:
        return [Column(name, apart=True) for name in names]
    return [column for name in names for column in (Column(f"{name}, before", apart=True), Column("after"))]


def _table(account: Account, caption: str, cam: BeforeAfter, engines: Engines) -> Table:
    sources: list[Mapping[str, Mapping[str, float]]] = [{"before": cam.before.rms, "after": cam.after.rms}]
    sources += [{when: one[when]["rms_m"] for when in ("before", "after")} for one in engines.values()]
    names = ["CAM", *(_ENGINES.get(one, one) for one in engines)]
    columns = [*texts("RMS error over"), *_heads(account, names)]
    rows = []
    for horizon in dict.fromkeys(name for one in (cam.before, cam.after) for name in one.rms):
        cells = [each[when].get(horizon) for each in sources for when in _whens(account)]
        title = f"rest after the first {brief(KNOWN)} s" if horizon == WHOLE else f"windows of {horizon}"
        rows.append((title, *(NONE if cell is None else error_size(cell) for cell in cells)))
    return Table(caption, columns, rows)


def _failures(account: Account) -> list[str]:
    """Messages of failed engines, each once, and whether only the model without the effects found fails so."""
    diagnosis = account.diagnosis
    sets = [diagnosis.engines, *(one.engines for one in diagnosis.also.values())]
    runs = [run for each in sets for one in each.values() for run in (one, one.get("heldout", {}))]
    before, after = (
        dict.fromkeys(_failure(run[when]) for run in runs if "failed" in run.get(when, {}))
        for when in ("before", "after")
    )
    only = "without the effects found, " if account.changed else ""
    return [*after, *(f"{only}{text}" for text in before if text not in after)]


def _failure(run: Mapping[str, Any]) -> str:
    """How an engine failed, and that it did not over every horizon."""
    failed = str(run["failed"])
    return f"{failed}; over the horizons that have an error it ran through" if run["rms_m"] else failed


def _warnings(account: Account) -> list[tuple[str, str]]:
    """Engine and text of what each engine warns of in its runs."""
    diagnosis = account.diagnosis
    sets = [diagnosis.engines, *(one.engines for one in diagnosis.also.values())]
    return [
        (_ENGINES.get(name, name), text)
        for name in dict.fromkeys(name for each in sets for name in each)
        for text in largest_of_each(text for each in sets for text in each.get(name, {}).get("warnings", ()))
    ]


def _innovations(account: Account) -> Table:
    diagnosis = account.diagnosis
    named = {"held out": diagnosis.heldout, "identification": diagnosis.identify}
    named |= {f"also {Path(name).name}": one.errors for name, one in diagnosis.also.items()}
    columns = [*texts("innovations"), *_heads(account, named)]
    each: list[Errors] = [getattr(one, when) for one in named.values() for when in _whens(account)]
    rows = [
        ("RMS over the reading noise", *(number(one.innovation_over_noise) for one in each)),
        ("autocorrelation at lag 1", *(fixed(one.innovation_correlation, 3) for one in each)),
    ]
    for key, symbol in _INPUTS.items():
        tests = [one.beam.get(key) for one in each]
        chances = [NONE if one is None or not one.freedom else _chance(one.p) for one in tests]
        rows.append((f"independent of {symbol}: p", *chances))
    return Table("Tests of the innovations", columns, rows)


def _chance(p: float) -> str:
    return "< 0.0001" if p < 1e-4 else fixed(p, 4 if p < SIGNIFICANT else 2)
