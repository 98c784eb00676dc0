"""Name, colour and line style of each source in all reports; dashes distinguish sources without colour vision."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from markupsafe import Markup

from harness.formatting import listed

MEASURED_COLOUR = "#111111"
UNCERTAINTY_COLOUR = "#9aa3ad"
LEFT_OUT_COLOUR = "#b0413e"
INK = "#1c2733"  # as in report.mplstyle


@dataclass(frozen=True)
class Look:
    """Label, colour and line style.

    Attributes:
        label: name in texts, tables and legends.
        colour: hexadecimal.
        dash: on-off lengths in points; `None` for a solid line.
        width: of its line [pt].
        layer: drawing order; engines are drawn dashed above the model they should agree with.
    """

    label: str
    colour: str
    dash: tuple[float, ...] | None = None
    width: float = 1.3
    layer: int = 3


# After P. Tol's and Okabe & Ito's colour-blind safe sets.
LOOKS: Mapping[str, Look] = {
    "cum": Look("CUM", "#E69F00"),
    "cum_linear": Look("linear CUM", "#8C7A2B", (5.0, 2.0)),
    "cam": Look("CAM", "#0072B2", None, 2.6),
    "friction_printed": Look("friction (as printed)", "#CC6677"),
    "friction_printed_dissipative": Look("friction (|tanh|)", "#882255", (6.0, 1.6)),
    "friction_coulomb": Look("friction (Coulomb)", "#5B3FA8"),
    "friction_viscous": Look("friction (viscous)", "#AA4499", (7.0, 1.6, 1.4, 1.6)),
    "mujoco": Look("MuJoCo", "#2DB38A", (5.0, 3.5), 1.5, 5),
    "pybullet": Look("PyBullet", "#D55E00", (1.4, 2.6), 1.7, 6),
    "dart": Look("DART", "#56B4E9", (3.0, 1.5, 1.0, 1.5), 1.3, 6),
}
_SPARE = ("#66A61E", "#E7298A", "#1B9E77", "#7570B3")


def look_of(source: str) -> Look:
    """The look of a source; unknown sources get a spare colour that depends only on their name."""
    if source in LOOKS:
        return LOOKS[source]
    return Look(source, _SPARE[sum(source.encode()) % len(_SPARE)], (2.0, 1.0), 1.3, 5)


def label_of(source: str) -> str:
    """The displayed name of a source."""
    return look_of(source).label


def swatch(source: str) -> Markup:
    """The displayed name of a source after a mark in its colour."""
    look = look_of(source)
    return Markup('<span class="swatch" style="--colour:{}"></span>{}').format(look.colour, look.label)


def names(sources: Iterable[str]) -> str:
    """`CAM, MuJoCo and PyBullet`."""
    return listed([label_of(source) for source in sources])
