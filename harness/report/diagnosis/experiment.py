"""Section on the proposed next experiment: beam motion, expected discrimination, assumed limits of the rig."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from harness.formatting import brief, fixed, length
from harness.identify.design.proposal import FILE, NOTHING, Proposal, sentence
from harness.report.diagnosis.account import FOUND, Account
from harness.report.page import Section
from harness.report.palette import INK
from harness.report.plots import WIDTH, Picture, line, picture, style, thinning
from harness.report.tables import Column, Row, Table

_EDGE = "#8a94a0"


def section(account: Account) -> Section | None:
    """The section; `None` without a proposal."""
    proposal = account.diagnosis.next_experiment
    if proposal is None:
        return None
    context = {
        "sentence": sentence(proposal).replace("_", " "),
        "does": proposal.profile.words,
        "file": FILE,
        "drift": length(proposal.open_loop_drift, 2),
        "end": brief(float(proposal.time[-1])),
        "picture": _picture(proposal),
        "reveals": proposal.separations[0].rival == NOTHING,
        "separations": _separations(proposal),
        "tried": _tried(proposal),
    }
    return Section("experiment", "The next experiment", "Next", "diagnosis/experiment.html", context)


def _picture(proposal: Proposal) -> Picture:
    envelope, thin = proposal.envelope, slice(None, None, thinning(len(proposal.time)))
    with style():
        figure = Figure(figsize=(WIDTH, 4.0), layout="constrained")
        top, bottom = figure.subplots(2, 1, sharex=True)
        line(top, proposal.time[thin], np.degrees(proposal.angle[thin]), FOUND)
        line(bottom, proposal.time[thin], proposal.reading[thin], FOUND)
        for axes, edges in (
            (top, np.degrees([-envelope.angle, envelope.angle])),
            (bottom, (envelope.low, envelope.high)),
        ):
            for edge in edges:
                axes.axhline(edge, color=_EDGE, linewidth=1.0, dashes=(4.0, 3.0), zorder=2)
            axes.margins(y=0.08)
        top.axhline(0.0, color=INK, linewidth=0.8, zorder=2)
        top.set_ylabel(r"beam angle $\alpha$ [deg]")
        bottom.set_ylabel("position $s$ [m]")
        bottom.set_xlabel("time [s]")
        bottom.set_xlim(proposal.time[0], proposal.time[-1])
        alt = f"Beam angle of the profile {proposal.profile.name} and the ball's position to be expected, over time."
        caption = (
            f"The profile “{proposal.profile.name}”: {proposal.profile.words}. Above: beam angle, below: position "
            "expected by the model with the effects found. Dashed: assumed operating envelope, 1.2 times the largest "
            "angle of the recordings and the permitted range of the ball."
        )
        return picture(figure, alt, caption)


def _separations(proposal: Proposal) -> Table:
    if proposal.separations[0].rival == NOTHING:
        columns = [Column("effect of typical size", text=True), Column("expected", "σ"), Column("required", "σ")]
        columns.append(Column("detectable", text=True))
        ordered = sorted(proposal.separations, key=lambda one: -one.expected)
        rows = [
            Row((f"`{one.found}`", fixed(one.expected, 1), fixed(one.needed, 1), _yes(one.told))) for one in ordered
        ]
        return Table("Expected detection of effects", columns, rows)
    columns = [
        Column("found", text=True),
        Column("rival", text=True),
        Column("current", "σ"),
        Column("expected", "σ", hint="with the present recordings and the new one"),
        Column("required", "σ"),
        Column("distinguishable", text=True),
    ]
    rows = [
        Row(
            (
                f"`{one.found}`",
                f"`{one.rival}`",
                fixed(one.at_hand, 1),
                fixed(one.expected, 1),
                fixed(one.needed, 1),
                _yes(one.told),
            )
        )
        for one in sorted(proposal.separations, key=lambda one: one.expected)
    ]
    return Table("Expected discrimination", columns, rows)


def _yes(told: bool) -> str:
    return "yes" if told else "no"


def _tried(proposal: Proposal) -> Table:
    reveals = proposal.separations[0].rival == NOTHING
    last = Column("detectable effects") if reveals else Column("smallest separation", "σ")
    ordered = sorted(proposal.tried.items(), key=lambda one: -one[1])
    rows = [
        Row((name, fixed(value, 0) if reveals else fixed(value, 1)), "best" if name == proposal.profile.name else "")
        for name, value in ordered
    ]
    return Table("All profiles within the operating envelope", [Column("profile", text=True), last], rows)
