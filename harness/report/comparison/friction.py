"""Section on the readings of the paper's friction law: dimensional consistency and dissipation."""

from dataclasses import replace

import numpy as np
from markupsafe import Markup

from analytic.models import FRICTION, Reading
from analytic.rig import Rig
from harness.report.chart import Chart, Panel, Trace
from harness.report.comparison.subject import Subject
from harness.report.page import Section, typeset
from harness.report.palette import INK, look_of, swatch
from harness.report.plots import Picture, drawing, line, picture, sample, style, zero
from harness.report.tables import Table, texts

READING_LABELS = {
    Reading.NONE: "none",
    Reading.PRINTED: "as printed",
    Reading.PRINTED_DISSIPATIVE: "printed, |tanh|",
    Reading.COULOMB: "Coulomb-like",
    Reading.VISCOUS: "viscous",
}
_LAWS = {
    Reading.PRINTED: "F = f_b tanh(ṡ/v_t) m g cos α · ṡ",
    Reading.PRINTED_DISSIPATIVE: "F = f_b |tanh(ṡ/v_t)| m g cos α · ṡ",
    Reading.COULOMB: "F = f_b m g cos α tanh(ṡ/v_t)",
    Reading.VISCOUS: "F = f_b ṡ",
}


def force(reading: Reading, rig: Rig, velocity: np.ndarray) -> np.ndarray:
    """F_f [N] of a reading on a level beam at `velocity` [m/s], same shape; positive values oppose +ṡ."""
    weight, tanh = rig.mass * rig.gravity, np.tanh(velocity / rig.transition_velocity)
    factor = {
        Reading.PRINTED: tanh * weight * velocity,
        Reading.PRINTED_DISSIPATIVE: np.abs(tanh) * weight * velocity,
        Reading.COULOMB: weight * tanh,
        Reading.VISCOUS: velocity,
    }
    return rig.friction_coefficient * factor[reading]


def section(subject: Subject) -> Section:
    """The readings of eq. 15."""
    remarks = {
        Reading.PRINTED: "tanh(ṡ/v_t)·ṡ is even: for ṡ < 0 the force accelerates the ball",
        Reading.PRINTED_DISSIPATIVE: "dissipative in both directions; grows with speed like a viscous force",
        Reading.COULOMB: "dry friction, smoothed near rest; does not hold a ball at rest",
        Reading.VISCOUS: "the only reading consistent with the printed unit",
    }
    rows = [
        (
            swatch(FRICTION[reading].name),
            Markup('<span class="nowrap">{}</span>').format(typeset(law)),
            reading.unit,
            "yes" if reading.consistent_with_print else "no",
            "yes" if reading.dissipates else "no",
            remarks[reading],
        )
        for reading, law in _LAWS.items()
    ]
    table = Table(
        "Four readings of eq. 15, F_f = f_b · tanh(ṡ/v_t) · m g cos α · ṡ, with f_b printed in N s/m",
        texts("reading", "law", "required unit of f_b", "consistent with N s/m", "dissipates", "remark"),
        rows,
    )
    context = {"table": table, "picture": _picture(subject)}
    return Section("friction", "Readings of the friction law", "Friction", "comparison/friction.html", context)


@style()
def _picture(subject: Subject) -> Picture:
    rig, ball = subject.study.setting.rig, subject.study.setting.ball
    fastest = max(float(np.nanmax(np.abs(ball.velocity))), 2.0 * rig.transition_velocity)
    velocity = np.linspace(-fastest, fastest, 801)
    figure = drawing(2.9)
    left, right = figure.subplots(1, 2)
    entries = []
    forces, powers = [], []
    for reading, model in FRICTION.items():
        look = look_of(model.name)
        resistance = 1e3 * force(reading, rig, velocity)
        line(left, velocity, -resistance, look)
        line(right, velocity, -resistance * velocity, look)
        named = replace(look, label=READING_LABELS[reading])
        forces.append(Trace(model.name, named, velocity, -resistance))
        powers.append(Trace(model.name, named, velocity, -resistance * velocity))
        entries.append(sample(look, READING_LABELS[reading]))
    for axes, name in ((left, "force on the ball [mN]"), (right, "power into the ball [mW]")):
        zero(axes)
        axes.axvline(0.0, color=INK, linewidth=0.8)
        axes.set(xlim=(-fastest, fastest), xlabel="velocity ṡ [m/s]", ylabel=name)
    figure.legend(handles=entries, loc="outside right upper", handlelength=2.6)
    return picture(
        figure,
        "Friction force and its power against velocity for the four readings; only as printed is the power "
        "ever positive.",
        "Force and power of each reading with this run's f_b and v_t, on a level beam, over the speeds of "
        "this recording. Positive power adds energy.",
        Chart(
            "friction-readings",
            [
                Panel("force on the ball", "mN", forces, zero=True),
                Panel("power into the ball", "mW", powers, zero=True),
            ],
            "velocity",
            "m/s",
        ),
    )
