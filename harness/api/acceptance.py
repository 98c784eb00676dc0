"""Whether an input can be diagnosed: findings that make a verdict worthless stop it, unless they are accepted."""

from collections.abc import Sequence
from dataclasses import replace

from analytic.naming import did_you_mean
from harness.errors import InputError, WorthlessInput
from harness.recording import Case, DataFinding, Recording
from harness.recording.findings import STOPPING


def findings_of(case: Case, further: Sequence[Recording] = ()) -> tuple[DataFinding, ...]:
    """Findings on a case and on further recordings, each located by the name under which it is given."""
    beside = (
        replace(one, where=each.name + one.where.removeprefix(each.path.name))
        for each in further
        for one in each.findings
    )
    return (*case.findings, *beside)


def check_codes(accept: Sequence[str]) -> None:
    """Refuse codes that no finding has which stops a diagnosis.

    Raises:
        InputError: one of them is unknown.
    """
    for code in accept:
        if code not in STOPPING:
            known = ", ".join(STOPPING)
            raise InputError(
                f"--accept {code}: no finding of this code stops a diagnosis.{did_you_mean(code, STOPPING)} There are: "
                f"{known}."
            )


def refuse_worthless(case: Case, further: Sequence[Recording], accept: Sequence[str]) -> None:
    """Refuse an input on which a verdict would be worthless; recordings to predict do not bear on the verdict.

    Args:
        case: to diagnose.
        further: recordings that the result is held against.
        accept: codes of findings that are meant so.

    Raises:
        WorthlessInput: a finding stops the diagnosis and is not accepted.
    """
    bearing = (*case.findings_on(case.identify), *findings_of(case, further)[len(case.findings) :])
    found = [one for one in bearing if one.stops and one.code not in accept]
    if not found:
        return
    lines = "\n".join(f"  {one.where}: {one.text} [{one.code}]" for one in found)
    options = " ".join(f"--accept {code}" for code in dict.fromkeys(one.code for one in found))
    raise WorthlessInput(
        f"{case.path}: a verdict on this input would be worthless:\n{lines}\n"
        f"Correct the input. If it is right as it is: {options}"
    )
