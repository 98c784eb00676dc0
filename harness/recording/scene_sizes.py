"""Sizes in a scene at which an engine would end the process or never come back, refused before it loads the file."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree.ElementTree import Element

from harness.errors import InputError

# Attributes whose product is a number of parts, and the largest that loads within seconds.
_NUMBERS = {"replicate": ("count",), "composite": ("count",), "flexcomp": ("count",), "hfield": ("nrow", "ncol")}
_MOST = {"hfield": 10_000_000}
_MOST_PARTS = 10_000
# Of URDF, whose sizes PyBullet does not check.
_LENGTHS = {"sphere": ("radius",), "box": ("size",), "cylinder": ("radius", "length"), "capsule": ("radius", "length")}


def check_sizes(file: Path, element: Element) -> None:
    """Check one element of an MJCF or URDF.

    Raises:
        InputError: it asks for too many parts, or a shape has a size that is not positive.
    """
    tag = str(element.tag)
    parts = math.prod(max(1.0, one) for name in _NUMBERS.get(tag, ()) for one in _numbers(element, name))
    most = _MOST.get(tag, _MOST_PARTS)
    if parts > most:
        names = " and ".join(_NUMBERS[tag])
        raise InputError(f"{file}: <{tag}> has {parts:.3g} parts, more than {most}. Lower {names}.")
    for name in _LENGTHS.get(tag, ()):
        if not all(0.0 < one < math.inf for one in _numbers(element, name)):
            raise InputError(f"{file}: <{tag}> has {name}='{element.get(name)}'. Give lengths above 0, in m.")


def _numbers(element: Element, name: str) -> list[float]:
    """The numbers of an attribute; none where it has none, which the engine itself refuses."""
    try:
        return [float(one) for one in element.get(name, "").split()]
    except ValueError:
        return []
