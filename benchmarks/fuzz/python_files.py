"""Files of effects: a good one with its lines and arguments changed."""

from __future__ import annotations

from hypothesis import strategies as st

from benchmarks.fuzz import strange

FIRST = (
    "",
    "import sys; sys.exit(0)",
    "import sys; sys.exit('a text')",
    "raise SystemExit",
    "raise Exception",
    "raise ValueError('two\\nlines')",
    "raise GeneratorExit",
    "raise ExceptionGroup('x', [ValueError(1)])",
    "1/0",
    "x = (",
    "\tx = 1",
    "import no_such_module",
    "from analytic.effects import no_such_name",
    "def f(): f()\nf()",
    "print('noise')",
    "open('/no/such/file')",
    "__name__ = 5",
    "Effect = 5",
    "Force = None",
    "class A:\n    def __eq__(self, other): raise ValueError\nX = [A()]",
    "class E(Effect): pass\nX = E",
    "import warnings; warnings.warn('hm')",
    "assert False",
    "return 5",
    "# coding: no-such-codec",
    "import numpy as np; np.seterr(all='raise')",
    "import warnings; warnings.simplefilter('error')",
    "import json; x = json.loads('{')",
)
LAWS = (
    "lambda s, size: size * s",
    "lambda s, size: size",
    "lambda s, size: size * np.sin(s)",
    "lambda s: s",
    "lambda s, size: None",
    "lambda s, size: 'text'",
    "lambda s, size: [s, s]",
    "lambda s, size: s[:-1]",
    "lambda s, size: s * np.nan",
    "lambda s, size: 1j * s",
    "lambda s, size: s > 0",
    "lambda s, size: s.astype(object)",
    "lambda s, size: 1 / 0",
    "lambda s, size: s * 1e308 * 1e308",
    "lambda s, size: np.zeros((len(s), 2))",
    "lambda s, size: size * np.sqrt(s)",
    "lambda s, size: exit()",
    "lambda s, size: (_ for _ in ()).throw(MemoryError)",
    "lambda s, size: [[1.0], [1.0, 2.0]]",
    "lambda s, size: s.__setitem__(0, 5.0)",
    "5",
    "None",
    "print",
)
_NAMES = (
    '"mine"',
    '"level_error"',
    '""',
    '"a b"',
    '"1a"',
    "5",
    "None",
    '"é"',
    '"__class__"',
    '"' + "a" * 300 + '"',
    "b'x'",
)
_BY = ('"position"', '"velocity"', '"angle"', '"roll_angle"', '"time"', "None", "[]")
_OVER = ("None", "(0, 1)", "(1, 0)", "(0, float('nan'))", "5", "(0,)", "('a', 'b')", "(0, 1e300)", "(0, 1e-320)")
_NUMBERS = (
    "0.0",
    "1.0",
    "-1.0",
    "0.1",
    "float('nan')",
    "float('inf')",
    "None",
    "'a'",
    "1e300",
    "1e-300",
    "10**400",
    "1j",
    "[1]",
)
_ENDS = (
    "",
    "MINE = [MINE, MINE]",
    "OTHER = MINE",
    "del MINE",
    "MINE = {'a': MINE}",
    "MINE.name = 'other'",
    "from analytic.effects import CATALOGUE; X = list(CATALOGUE.values())",
)
OTHERS = (
    "sensor=lambda values: SensorLaw(gain=values['size'])",
    "sensor=lambda values: SensorLaw(gain='a')",
    "sensor=lambda values: SensorLaw(lag=None)",
    "sensor=lambda values: None",
    "sensor=5",
    "alter=lambda rig, values: rig",
    "alter=lambda rig, values: None",
    "write=lambda p, rig, values: None",
    "turn=lambda motion, time, values: None",
    "tilting=lambda values: 'a'",
    "transmission=lambda values: None",
    "write=5",
    "dry=True",
    "relations=None",
    "engine=None",
    "phrase=5",
    "no_such=1",
)


@st.composite
def effect_files(draw: st.DrawFn) -> bytes:
    """Bytes of a changed file of effects."""

    def one(usual: str, others: tuple[str, ...]) -> str:
        return draw(st.sampled_from((*[usual] * len(others), *others)))

    low, high, typical = one("-1.0", _NUMBERS), one("1.0", _NUMBERS), one("0.1", _NUMBERS)
    parameter = one('"size"', ('"other"', '""', "5", '"class"', '"s"', "None"))
    force = f"force=Force({one(_BY[0], _BY)}, {one(LAWS[0], LAWS)}, {one('None', _OVER)})"
    text = (
        "import numpy as np\nfrom analytic.effects import *\nfrom analytic.effects import Force, Parameter, SensorLaw\n"
        f"{one('', FIRST)}\n"
        f"MINE = Effect({one(_NAMES[0], _NAMES)}, {one(repr('F'), ('5', repr(''), 'None'))}, "
        f"({one('', ('Parameter(' + repr('b') + ', ' + repr('m') + ', 0.0, 1.0, 0.5),', '5,'))}"
        f"Parameter({parameter}, {one(repr('N'), ('5', repr('')))}, {low}, {high}, {typical}),), "
        f"source={one(repr('here'), ('5', 'None'))}, {one(force, (force, *OTHERS))})\n"
        f"{one('', _ENDS)}\n"
    )
    return draw(strange.edited(text.encode(), most=draw(st.sampled_from((0, 0, 0, 2)))))
