"""Section on the inputs: recordings, rig, reading noise, declared effects, findings, and the command."""

import math

from harness.formatting import length, number
from harness.recording.fast_sensor import neighbours_in_mean
from harness.recording.known_rig import NEEDED, UNITS
from harness.report.diagnosis.account import Account
from harness.report.page import Section
from harness.report.scenes import scenes_in_words
from harness.report.tables import Table, texts


def section(account: Account) -> Section:
    """The inputs."""
    context = {
        "origin": account.case.origin,
        "recordings": _recordings(account),
        "rig": _rig(account),
        "scenes": scenes_in_words(account.case.scene, account.diagnosis.engines),
        "declared": [(one.effect.name, list(one.values.items())) for one in account.diagnosis.problem.declared],
        "noise": length(math.sqrt(account.diagnosis.problem.reading_variance), 2),
        "means": _means(account),
        "colour": _colour(account),
        "noise_share": _noise_share(account),
        "roughness": _roughness(account),
        "findings": account.record.findings,
        "versions": account.record.inputs.versions,
        "command": account.command,
    }
    return Section("inputs", "Inputs", "Inputs", "diagnosis/inputs.html", context)


def _colour(account: Account) -> str:
    """What of the reading noise is coloured; empty for white noise."""
    colour = account.diagnosis.problem.colour
    if colour.share == 0.0:
        return ""
    return f"{number(100.0 * colour.share, 2)} % of its variance correlated over {number(1e3 * colour.time, 2)} ms"


def _means(account: Account) -> str:
    """Which fast readings are used in means; empty where none are."""
    told = []
    for one in account.diagnosis.problem.recordings:
        every = neighbours_in_mean(account.case.recordings[one.name])
        told += [f"{every} neighbours of {one.name}"] if every > 1 else []
    return f"means of {', '.join(told)}" if told else ""


def _noise_share(account: Account) -> str:
    """What of the angle's scatter is an error; empty where all of it is."""
    if account.diagnosis.problem.held_command:
        return "none: it is a command that answers the readings of the ball, and the beam follows it from row to row"
    share = account.diagnosis.problem.noise_share
    if share == 1.0:
        return ""
    told = f"{number(share, 2)} times the scatter of its readings, as the ball's readings tell"
    return f"{told}; the rest is motion of the beam, as of a command, or of a beam that turns far between readings"


def _roughness(account: Account) -> str:
    """By how much the beam moves more roughly, or smoothly, than its angle's readings show; empty where it does not."""
    factor = account.diagnosis.problem.roughness
    if factor == 1.0:
        return ""
    return f"third derivative {number(factor, 2)} times as dense as the angle's readings tell, by the ball's readings"


def _recordings(account: Account) -> Table:
    rows = []
    for one in account.diagnosis.problem.recordings:
        source = account.case.recordings[one.name]
        duration = number(float(one.time[-1] - one.time[0]))
        rows.append((one.name, duration, str(int(source.known.sum())), f"`{source.sha256[:16]}…`"))
    columns = [*texts("recording"), "length [s]", "positions", *texts("SHA-256")]
    return Table("Recordings used for identification", columns, rows)


def _rig(account: Account) -> Table:
    rig, known = account.diagnosis.problem.rig, account.case.rig
    rows = [
        (
            name.replace("_", " "),
            number(getattr(rig, name), 4),
            UNITS[name],
            _status(getattr(rig, name), getattr(known, name)),
        )
        for name in (*NEEDED, "level_angle")
    ]
    columns = [*texts("quantity"), "value", *texts("unit", "status")]
    return Table("Rig without the effects found", columns, rows)


def _status(used: float, given: float | None) -> str:
    """Where the value of a quantity is from."""
    if given is None:
        return "estimated or assumed"
    return (
        "given" if math.isclose(used, given, rel_tol=1e-9) else f"estimated, contrary to the given {number(given, 4)}"
    )
