"""The models' own lines of code, executed on symbols instead of numbers, and the symbols they share."""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType, SimpleNamespace
from typing import Any

import sympy as sp

from analytic import law, models
from analytic.models import Model
from analytic.rig import Rig

m, J, R, r, h, g, v_t = sp.symbols("m J R r h g v_t", positive=True)
f_b = sp.symbols("f_b", nonnegative=True)
s, v, alpha, alpha_0, rate, angular = sp.symbols("s v α α_0 α̇ α̈", real=True)


class SymbolicRig(SimpleNamespace):
    """A rig whose quantities are symbols; what follows from them is computed by `Rig` itself."""

    lever = Rig.lever


RIG = SymbolicRig(
    mass=m,
    inertia=J,
    radius=R,
    rolling_radius=r,
    eccentricity=h,
    gravity=g,
    level_angle=alpha_0,
    friction_coefficient=f_b,
    transition_velocity=v_t,
)


def on_symbols(function: Callable[..., Any]) -> Callable[..., Any]:
    """The same code with sympy's functions in place of numpy's."""
    algebra = SimpleNamespace(sin=sp.sin, cos=sp.cos, tanh=sp.tanh, exp=sp.exp, zeros=lambda count: [0.0] * count)
    return FunctionType(function.__code__, {**function.__globals__, "np": algebra})


def kernel_acceleration(model: Model) -> sp.Expr:
    """s̈ as `models.coefficients` and `law.acceleration` compute it, in the symbols of this module."""
    p = on_symbols(models.coefficients)(model, RIG)
    return sp.nsimplify(on_symbols(law.acceleration.py_func)(s, v, alpha, rate, angular, p))
