"""Numbers as a person wants to read them: few digits, true minus signs, a unit of fitting size."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal

NONE = "—"  # printed for what is not defined
_NARROW_SPACE = "\u202f"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SMALLEST = 1e-9  # below this a length means nothing here [m]
_LENGTHS = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))


def number(value: float, significant: int = 3) -> str:
    """`value` with so many significant digits; whole numbers are never cut."""
    special = _special(value)
    if special is not None:
        return special
    # Rounding may carry over (9.996 → 10.0); the magnitude is that of the rounded number.
    magnitude = math.floor(math.log10(abs(float(f"{value:.{significant - 1}e}"))))
    if magnitude < -4 or magnitude > 8:
        mantissa = value / 10.0**magnitude
        return f"{fixed(mantissa, significant - 1)}·10{str(magnitude).translate(_SUPERSCRIPT)}"
    return fixed(value, max(0, significant - 1 - magnitude))


def fixed(value: float, decimals: int) -> str:
    """`value` with so many decimals."""
    if not math.isfinite(value):
        return _special(value) or NONE
    text = f"{value:,.{decimals}f}".replace(",", _NARROW_SPACE if abs(value) >= 1e4 else "")
    if float(f"{value:.{decimals}f}") == 0.0:
        text = text.lstrip("-")
    return text.replace("-", "−")


def brief(value: float, significant: int = 3) -> str:
    """As `number`, without trailing zeros: for round figures such as lengths of windows and ticks."""
    text = number(value, significant)
    mantissa, times, power = text.partition("·")
    return (mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa) + times + power


def aligned(values: Sequence[float], significant: int = 3, most: int = 4) -> list[str]:
    """A column of numbers with common decimals, so that they can be compared at a glance.

    The decimals give the smallest of them `significant` digits, unless the largest then had two more than that.
    """
    sizes = [abs(value) for value in values if math.isfinite(value) and value != 0.0]
    if not sizes:
        return [number(value, significant) for value in values]
    low, high = (math.floor(math.log10(size)) for size in (min(sizes), max(sizes)))
    decimals = min(significant - 1 - low, significant + 1 - high, most)
    return [fixed(value, max(decimals, 0)) for value in values]


def length(value: float, significant: int = 3) -> str:
    """A length given in metres, with the unit that leaves one to three digits before the point."""
    if not math.isfinite(value) or value == 0.0:
        return f"{number(value)} m" if value == 0.0 or math.isinf(value) else NONE
    if abs(value) < _SMALLEST:
        return f"< {length(_SMALLEST, 1)}"
    scale, unit = next(((s, u) for s, u in _LENGTHS if abs(value) >= s * 0.9995), _LENGTHS[-1])
    return f"{number(value / scale, significant)} {unit}"


def plus_minus(value: float, std: float) -> str:
    """`value ± std`, the deviation with two digits and the value with as many decimals; alone if there is none."""
    if not (math.isfinite(value) and math.isfinite(std) and std > 0.0):
        return number(value)
    decimals = max(0, 1 - math.floor(math.log10(std)))
    return f"{fixed(value, decimals)} ± {fixed(std, decimals)}"


def measured(value: float, reach: float) -> str:
    """`value ± reach`, both cut where the reach has one or two digits left; alone if there is none.

    Two where its first three digits are below 355, else one; 950 and more become 1000 (Particle Data Group, Review of
    Particle Physics, introduction, section 5.3): so rounding never changes the reach by more than a seventh.
    """
    if not (math.isfinite(value) and math.isfinite(reach) and reach > 0.0):
        return number(value)
    three = f"{reach:.2e}"
    first, power = three.split("e")
    decimals = (1 if float(first) <= 3.54 else 0) - int(power)
    kept = max(decimals, 0)
    return f"{fixed(round(value, decimals), kept)} ± {fixed(float(round(Decimal(three), decimals)), kept)}"


def percent(share: float) -> str:
    """A share of 1 in percent, without pretending to more than it holds."""
    return f"{fixed(100.0 * share, 0 if abs(share) >= 0.0995 else 1)} %" if math.isfinite(share) else NONE


def _special(value: float) -> str | None:
    if math.isnan(value):
        return NONE
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    return "0" if value == 0.0 else None
