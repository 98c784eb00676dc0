"""Section on the proposed next experiment: beam motion, expected discrimination, assumed limits of the rig."""

from harness.formatting import NONE, brief, fixed, length
from harness.identify.design.proposal import FILE, NOTHING, Proposal, sentence
from harness.report.diagnosis.account import FOUND, Account
from harness.report.page import Section
from harness.report.proposed import picture_of
from harness.report.tables import Column, Row, Table, texts


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
        "picture": picture_of(proposal, FOUND, "the model with the effects found"),
        "reveals": proposal.separations[0].rival == NOTHING,
        "separations": _separations(proposal),
        "tried": _tried(proposal),
    }
    return Section("experiment", "The next experiment", "Next", "diagnosis/experiment.html", context)


def _separations(proposal: Proposal) -> Table:
    reveals = proposal.separations[0].rival == NOTHING
    ordered = sorted(proposal.separations, key=lambda one: -one.expected if reveals else one.expected)
    rows = [
        (
            f"`{one.found}`",
            *(() if reveals else (f"`{one.rival}`", fixed(one.at_hand, 1))),
            fixed(one.expected, 1),
            fixed(one.needed, 1) if one.needed > 0.0 else NONE,
            "yes" if one.told else "no",
        )
        for one in ordered
    ]
    if reveals:
        columns = [*texts("effect of typical size"), "expected [σ]", "required [σ]", *texts("detectable")]
        return Table("Expected detection of effects", columns, rows)
    expected = Column("expected", "σ", hint="with the present recordings and the new one")
    columns = [*texts("found", "rival"), "current [σ]", expected, "required [σ]", *texts("distinguishable")]
    return Table("Expected discrimination", columns, rows)


def _tried(proposal: Proposal) -> Table:
    reveals = proposal.separations[0].rival == NOTHING
    ordered = sorted(proposal.tried.items(), key=lambda one: -one[1])
    rows = [
        Row((name, fixed(value, 0 if reveals else 1)), "best" if name == proposal.profile.name else "")
        for name, value in ordered
    ]
    columns = [*texts("profile"), "detectable effects" if reveals else "smallest separation [σ]"]
    return Table("All profiles within the operating envelope", columns, rows)
