"""Scenes of users, MJCF and URDF: good ones with elements and attributes changed."""

from __future__ import annotations

import copy
from xml.etree import ElementTree

from hypothesis import strategies as st

from benchmarks.fuzz import strange
from benchmarks.fuzz.doors import MJCF, URDF, seed

PREFIXES = (
    '<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE a [<!ENTITY b "bbbbbbbbbb"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;">]>',
    "<?xml version='1.1'?>",
    '<?xml version="1.0" encoding="utf-16"?>',
    '<?xml version="1.0" encoding="no-such"?>',
    "<?xml-stylesheet href='file:///etc/passwd'?>",
    "\ufeff",
    "<!-- -- -->",
)
ELEMENTS = (
    '<include file="/etc/passwd"/>',
    '<include file="../other.xml"/>',
    '<include file="own.xml"/>',
    '<asset><mesh name="m" file="/etc/passwd"/></asset>',
    '<asset><mesh name="m" file="http://example.org/m.stl"/></asset>',
    '<asset><model name="m" file="own.xml"/></asset>',
    '<asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset>',
    '<extension><plugin plugin="mujoco.elasticity.cable"/></extension>',
    '<size memory="100G"/>',
    '<option timestep="0"/>',
    '<option timestep="1e-300"/>',
    '<compiler coordinate="global"/>',
    '<worldbody><replicate count="1000000"><geom size="1"/></replicate></worldbody>',
    '<worldbody><composite type="particle" count="100 100 100" spacing="1"/></worldbody>',
    '<worldbody><body name="ball"/></worldbody>',
    '<equality><weld body1="ball" body2="beam"/></equality>',
    '<link name="beam"/>',
    '<joint name="pivot" type="fixed"><parent link="beam"/><child link="beam"/></joint>',
    '<link name="l"><collision><geometry><mesh filename="/etc/passwd"/></geometry></collision></link>',
    '<link name="l"><collision><geometry><sphere radius="-1"/></geometry></collision></link>',
)
_NUMBERS = ("0", "-1", "nan", "inf", "1e300", "1e-300", "0 0 0", "1 2", "", "a", "0 1 0", "1 0 0", "100000")


@st.composite
def mjcf_files(draw: st.DrawFn) -> bytes:
    """Bytes of a changed MJCF."""
    return draw(_files(seed(MJCF)))


@st.composite
def urdf_files(draw: st.DrawFn) -> bytes:
    """Bytes of a changed URDF."""
    return draw(_files(seed(URDF)))


@st.composite
def _files(draw: st.DrawFn, raw: bytes) -> bytes:
    root = ElementTree.fromstring(raw)
    for _ in range(draw(st.integers(0, 3))):
        draw(_changed(root))
    text = ElementTree.tostring(root, encoding="unicode")
    if draw(st.integers(0, 4)) == 0:
        text = draw(st.sampled_from(PREFIXES)) + text
    return draw(strange.edited(text.encode("utf-8", errors="replace"), most=draw(st.sampled_from((0, 0, 0, 2)))))


@st.composite
def _changed(draw: st.DrawFn, root: ElementTree.Element) -> None:
    """One element or attribute, somewhere in the tree, changed in place."""
    homes = [one for one in root.iter() if len(one)]
    home = draw(st.sampled_from(homes or [root]))
    at = draw(st.integers(0, max(len(home) - 1, 0)))
    kind = draw(st.sampled_from(("attribute", "attribute", "number", "drop", "delete", "repeat", "add", "move", "tag")))
    if kind == "add" or not len(home):
        home.insert(at, ElementTree.fromstring(draw(st.sampled_from(ELEMENTS))))
        return
    one = home[at]
    keys = sorted(one.attrib)
    if kind in ("attribute", "number", "drop") and keys:
        key = draw(st.sampled_from(keys))
        if kind == "drop":
            del one.attrib[key]
        elif kind == "number":
            one.attrib[key] = draw(st.sampled_from(_NUMBERS))
        else:
            one.attrib[key] = _plain(draw(strange.numbers | strange.texts))
    elif kind == "delete":
        del home[at]
    elif kind == "repeat":
        home.insert(at, copy.deepcopy(one))
    elif kind == "move":
        root.append(one)
        del home[at]
    elif kind == "tag":
        one.tag = draw(st.sampled_from(("body", "geom", "joint", "freejoint", "link", "include", "default", "x")))


def _plain(text: str) -> str:
    """Without what no XML can hold."""
    return "".join(one for one in text if one >= " " and not "\ud800" <= one <= "\udfff" and one not in "\ufffe\uffff")
