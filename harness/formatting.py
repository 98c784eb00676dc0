"""Formats numbers for reports: significant digits, minus signs, suitable length units."""

import math
from collections.abc import Sequence
from decimal import Decimal

NONE = "—"  # printed for undefined values
_NARROW_SPACE = "\u202f"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MIN_LENGTH = 1e-9  # smaller lengths are printed as "< 1 nm" [m]
_LENGTHS = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))


def number(value: float, significant: int = 3) -> str:
    """`value` with `significant` digits; digits before the decimal point are never rounded off."""
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
    """`value` with `decimals` decimals."""
    if not math.isfinite(value):
        return _special(value) or NONE
    text = f"{value:,.{decimals}f}".replace(",", _NARROW_SPACE if abs(value) >= 1e4 else "")
    if float(f"{value:.{decimals}f}") == 0.0:
        text = text.lstrip("-")
    return text.replace("-", "−")


def brief(value: float, significant: int = 3) -> str:
    """As `number`, without trailing zeros: for round values such as window lengths and ticks."""
    text = number(value, significant)
    mantissa, times, power = text.partition("·")
    return (mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa) + times + power


def aligned(values: Sequence[float], significant: int = 3, most: int = 4) -> list[str]:
    """A column of numbers with a common number of decimals, at most `most`.

    The smallest value gets `significant` digits, unless the largest would then have more than two additional ones.
    """
    sizes = [abs(value) for value in values if math.isfinite(value) and value != 0.0]
    if not sizes:
        return [number(value, significant) for value in values]
    low, high = (math.floor(math.log10(size)) for size in (min(sizes), max(sizes)))
    decimals = min(significant - 1 - low, significant + 1 - high, most)
    return [fixed(value, max(decimals, 0)) for value in values]


def length(value: float, significant: int = 3) -> str:
    """A length [m] with the unit (m, mm, µm, nm) that gives one to three digits before the point."""
    if not math.isfinite(value) or value == 0.0:
        return f"{number(value)} m" if value == 0.0 or math.isinf(value) else NONE
    if abs(value) < _MIN_LENGTH:
        return f"< {length(_MIN_LENGTH, 1)}"
    scale, unit = next(((s, u) for s, u in _LENGTHS if abs(value) >= s * 0.9995), _LENGTHS[-1])
    return f"{number(value / scale, significant)} {unit}"


def plus_minus(value: float, std: float) -> str:
    """`value ± std`, std with two digits and the value with as many decimals; only the value without a valid std."""
    if not (math.isfinite(value) and math.isfinite(std) and std > 0.0):
        return number(value)
    decimals = max(0, 1 - math.floor(math.log10(std)))
    return f"{fixed(value, decimals)} ± {fixed(std, decimals)}"


def measured(value: float, half_width: float) -> str:
    """`value ± half_width`, rounded to one or two digits of the half width; only the value without a valid half width.

    Two digits if its first three digits are below 355, else one; 950 and above become 1000 (Particle Data Group, Review
    of Particle Physics, introduction, section 5.3). Rounding changes the half width by at most a seventh.
    """
    if not (math.isfinite(value) and math.isfinite(half_width) and half_width > 0.0):
        return number(value)
    three = f"{half_width:.2e}"
    first, power = three.split("e")
    decimals = (1 if float(first) <= 3.54 else 0) - int(power)
    kept = max(decimals, 0)
    return f"{fixed(round(value, decimals), kept)} ± {fixed(float(round(Decimal(three), decimals)), kept)}"


def listed(parts: Sequence[str]) -> str:
    """`a`, `a and b`, `a, b and c`."""
    return " and ".join(part for part in (", ".join(parts[:-1]), *parts[-1:]) if part)


def percent(share: float) -> str:
    """A share of 1 in percent, from 10 % on without decimals."""
    return f"{fixed(100.0 * share, 0 if abs(share) >= 0.0995 else 1)} %" if math.isfinite(share) else NONE


def _special(value: float) -> str | None:
    if math.isnan(value):
        return NONE
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    return "0" if value == 0.0 else None
