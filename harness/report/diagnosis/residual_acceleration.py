"""Section on the residual acceleration of the declared model, compared with the effects found."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from analytic.motion import FloatArray
from harness.formatting import number
from harness.numerics import rms
from harness.report.diagnosis.account import FOUND, MODEL, Account
from harness.report.page import Section
from harness.report.palette import INK, Look
from harness.report.plots import WIDTH, Picture, band, binned, frame, line, picture, sample, style, thinning

LEFT = Look("residual acceleration", MODEL.colour, None, 1.2, 3)
LAW = Look("effects found", FOUND.colour, None, 1.4, 6)
_MAX_DOTS = 1500  # per scatter plot
_AXES = ("position $s$ [m]", r"velocity $\dot s$ [m/s]", r"beam angle $\alpha$ [deg]")
_LABEL = "residual acceleration\n[m/s²]"


def section(account: Account) -> Section:
    """The section."""
    residual = np.concatenate([one.residual[one.trusted] for one in account.residual_accelerations])
    law = np.concatenate([one.law[one.trusted] for one in account.residual_accelerations])
    deviation = np.concatenate([one.deviation[one.trusted] for one in account.residual_accelerations])
    context = {
        "changed": account.changed,
        "before": number(rms(residual)),
        "after": number(rms(residual - law)),
        "uncertainty": number(rms(deviation), 2),
        "over_time": _over_time(account),
        "against": _against(account),
    }
    return Section("trace", "Residual acceleration", "Residual", "diagnosis/residual_acceleration.html", context)


def _legend(figure: Figure, account: Account) -> None:
    looks = [LEFT, LAW] if account.changed else [LEFT]
    figure.legend(handles=[sample(look, look.label) for look in looks], loc="outside upper left", ncols=2)


def _in_newtons(axes: Axes, account: Account) -> None:
    factor = 1e3 * account.force

    def force(acceleration: ArrayLike) -> FloatArray:
        return factor * np.asarray(acceleration, float)

    def acceleration(force: ArrayLike) -> FloatArray:
        return np.asarray(force, float) / factor

    right = axes.secondary_yaxis("right", functions=(force, acceleration))
    right.set_ylabel("force [mN]")


def _over_time(account: Account) -> Picture:
    with style():
        figure = Figure(figsize=(WIDTH, 1.0 + 1.9 * len(account.residual_accelerations)), layout="constrained")
        grid = figure.subplots(len(account.residual_accelerations), 1, squeeze=False)[:, 0]
        for axes, one, record in zip(
            grid, account.residual_accelerations, account.diagnosis.problem.recordings, strict=True
        ):
            thin = slice(None, None, thinning(len(one.time)))
            band(axes, one.time, one.residual - 2.0 * one.deviation, one.residual + 2.0 * one.deviation)
            line(axes, one.time[thin], one.residual[thin], LEFT)
            if account.changed:
                line(axes, one.time[thin], one.law[thin], LAW)
            axes.axhline(0.0, color=INK, linewidth=0.8, zorder=2)
            low, high = np.percentile(np.concatenate((one.residual, one.law)), (0.3, 99.7))
            envelope = 2.0 * float(np.median(one.deviation))
            frame(axes, np.array([low - envelope, high + envelope]), margin=0.1, least=0.0)
            axes.set_xlim(one.time[0], one.time[-1])
            axes.set_title(record.name)
            axes.set_ylabel(_LABEL)
            _in_newtons(axes, account)
        grid[-1].set_xlabel("time [s]")
        _legend(figure, account)
        alt = "Residual acceleration over time, and the acceleration by the effects found."
        caption = (
            "Residual acceleration: the ball's acceleration that the declared model does not explain, estimated from "
            "the recording alone, with its ± 2 σ band (grey), and the acceleration by the effects found along the same "
            "path. The estimate is smoothed, the effects are not. Right axis: the equivalent force."
        )
        return picture(figure, alt, caption)


def _against(account: Account) -> Picture:
    use = [one.trusted for one in account.residual_accelerations]
    joined = {
        name: np.concatenate(
            [getattr(one, name)[keep] for one, keep in zip(account.residual_accelerations, use, strict=True)]
        )
        for name in ("position", "velocity", "angle", "residual", "law")
    }
    thin = slice(None, None, max(1, len(joined["law"]) // _MAX_DOTS))
    low, high = np.percentile(np.concatenate((joined["residual"], joined["law"])), (1.0, 99.0))
    with style():
        figure = Figure(figsize=(WIDTH, 3.0), layout="constrained")
        row = figure.subplots(1, 3, sharey=True)
        wheres = (joined["position"], joined["velocity"], np.degrees(joined["angle"]))
        for axes, x, name in zip(row, wheres, _AXES, strict=True):
            _cloud(axes, x[thin], joined["residual"][thin], LEFT)
            if account.changed:
                _cloud(axes, x[thin], joined["law"][thin], LAW)
            centre, mean, error = binned(x, joined["residual"])
            axes.errorbar(centre, mean, yerr=error, color=INK, marker="o", markersize=3.5, linewidth=1.0, zorder=7)
            axes.axhline(0.0, color=INK, linewidth=0.8, zorder=2)
            axes.set_xlabel(name)
        frame(row[0], np.array([low, high]), margin=0.3, least=0.0)
        row[0].set_ylabel(_LABEL)
        _in_newtons(row[-1], account)
        _legend(figure, account)
        alt = "Residual acceleration and that of the effects against position, velocity and beam angle."
        caption = (
            "The same against position, velocity and beam angle, over all recordings. Black: bin means of the residual "
            "acceleration with their standard errors. A step at ṡ = 0 indicates dry friction, a slope in ṡ viscous "
            "damping, an offset a level error, a slope in s a curved track."
        )
        return picture(figure, alt, caption)


def _cloud(axes: Axes, x: FloatArray, y: FloatArray, look: Look) -> None:
    axes.plot(
        x,
        y,
        ".",
        color=look.colour,
        alpha=0.3,
        markersize=3,
        markeredgewidth=0,
        rasterized=True,
        zorder=look.layer,
    )
