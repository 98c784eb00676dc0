"""Section on the paper: its Table 2 next to this recording, and tests of its three claims."""

from __future__ import annotations

from analytic.models import FRICTION
from harness.comparison.horizons import Horizon
from harness.comparison.paper import TABLE_2, Verdict
from harness.formatting import fixed, number
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import label_of
from harness.report.tables import Column, Table, texts

_INDICATORS = {
    "max_error_m": ("max displacement error", "m"),
    "e_disp_m_s": ("E_disp = ∫|e_s| dt", "m s"),
    "max_velocity_error_m_s": ("max velocity error", "m/s"),
    "e_vel_m": ("E_vel = ∫|e_v| dt", "m"),
}
_KIND = {Verdict.CONFIRMED: "good", Verdict.REFUTED: "bad", Verdict.UNDECIDABLE: "plain"}


def section(subject: Subject) -> Section:
    """The section."""
    study = subject.study
    horizons = [subject.whole] if study.headline is subject.whole else [subject.whole, study.headline]
    context = {
        "claims": [(one, _KIND[one.verdict]) for one in study.claims],
        "over": subject.over(study.headline),
        "tables": [_table(subject, one) for one in horizons],
        "simulated": subject.simulated,
    }
    return Section("paper", "The paper's claims on this recording", "Paper", "comparison/paper.html", context)


def _table(subject: Subject, horizon: Horizon) -> Table:
    models = ["cum", "cam", *(model.name for model in FRICTION.values())]
    columns = texts("indicator")
    columns += [Column(name, "paper") for name in ("CUM", "CAM", "friction")]
    columns += [Column(label_of(name), "here", apart=name == models[0]) for name in models]
    scores = [subject.study.score_of(name, horizon) for name in models]
    rows = []
    for key, (title, unit) in _INDICATORS.items():
        printed = [fixed(value, 4 if round(value, 3) != value else 3) for value in TABLE_2[key].values()]
        rows.append((f"{title} [{unit}]", *printed, *(number(getattr(score, key)) for score in scores)))
    kind = "simulated recording" if subject.simulated else "recording"
    return Table(f"Table 2 of the paper and this {kind}, {subject.over(horizon)}", columns, rows)
