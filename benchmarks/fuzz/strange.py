"""Values that programs stumble over, as hypothesis strategies."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

NUMBERS = (
    *(
        "0",
        "-0",
        "-1",
        "1",
        "0.5",
        "2",
        "1e-12",
        "1e-300",
        "5e-324",
        "1e19",
        "1e21",
        "1e38",
        "1e300",
        "1e999",
        "-1e300",
    ),
    *("nan", "-nan", "inf", "-inf", "NaN", "Infinity", "1_000", "0x10", "1e", "e5", "+", ".", "-", "--", "1.2.3"),
    *("1,5", "1.000,5", "1 000", "٣", "３", "−0.5", "½", "1e-3m", "0b1", "1d5", "True", "null", "#N/A"),
)
TEXTS = (
    *("", " ", "\u00a0", "\ufeff", "\u200b", "'", '"', '""', "\\", "{}", "[]", "%s", "%", "{0}", "\x1b[31m", "\x07"),
    *(
        "ß",
        "µ",
        "°",
        "α",
        "日本",
        "🎱",
        "e\u0301",
        "\u202e",
        "\ud7ff",
        "../..",
        "/",
        "NUL",
        "a" * 300,
        "=1+1",
        "-",
        "#",
    ),
)
HEADERS = (
    *("time", "time_s", "time_ms", "time_us", "time_ns", "Time (s)", "t", "T [ms]", "timestamp", "time_h", "time_"),
    *(
        "beam_angle",
        "beam_angle_rad",
        "beam_angle_deg",
        "angle",
        "Angle (deg)",
        "alpha",
        "α",
        "angle_mrad",
        "angle_rev",
    ),
    *("ball_position", "ball_position_m", "ball_position_mm", "position_cm", "x", "Distance (cm)", "position_in"),
    *("ball_velocity_m_s", "velocity", "velocity_mm_s", "beam_angle_rad_s", "current_a", "1", "0.5", "nan"),
)

numbers = st.sampled_from(NUMBERS) | st.floats().map(repr) | st.integers().map(str)
texts = st.sampled_from(TEXTS) | st.text(max_size=8)
headers = st.sampled_from(HEADERS) | texts
# Python's own decimals may have more digits than floats; JSON and TOML have integers of any length.
scalars: st.SearchStrategy[Any] = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.sampled_from((0, 1, -1, 2, 10**9, 10**25, -(10**400), 1e-300, 1e300, 0.0, -0.0)),
    st.floats(),
    texts,
)
trees: st.SearchStrategy[Any] = st.recursive(
    scalars, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3), max_leaves=6
)
pieces = st.sampled_from(
    (b"", b",", b";", b"\n", b"\r", b"\t", b'"', b"#", b"=", b"[", b"{", b"nan", b"-", b"1e999", b"\x00", b"\xb0")
) | st.binary(max_size=6)


@st.composite
def edited(draw: st.DrawFn, raw: bytes, *, most: int = 4) -> bytes:
    """`raw` with at most this many stretches replaced by pieces."""
    for _ in range(draw(st.integers(0, most))):
        begin = int(draw(st.floats(0.0, 1.0)) * len(raw))
        raw = raw[:begin] + draw(pieces) + raw[begin + draw(st.integers(0, 40)) :]
    return raw
