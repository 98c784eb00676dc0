"""The model of a problem with terms added, as the kernel and the filter take it for one recording after the other."""

from __future__ import annotations

import numpy as np

from analytic.effects import parameters_with
from analytic.motion import FloatArray
from analytic.slots import ORIGIN
from harness.identify.problem.hypothesis import Own, Terms
from harness.identify.problem.problem import Moving, PreparedRecording, Problem


class Dynamics:
    """The baseline model with the known effects and some terms.

    What the recordings have alike is computed once: of many short ones it would else take longer than their runs.

    Attributes:
        problem: of the recordings.
        added: terms beside the known effects.
        law: of the position sensor with all of them.
    """

    def __init__(self, problem: Problem, added: Terms) -> None:
        self.problem, self.added, self.law = problem, added, added.sensor_in(problem)
        self._latest: tuple[Own, FloatArray, Moving] | None = None

    def of(self, recording: PreparedRecording, own: Own | None = None) -> tuple[FloatArray, FloatArray]:
        """The kernel's vector, shape (SLOTS,) or longer where force laws follow, and the recording's beam table.

        Args:
            recording: any of the rig.
            own: what the recording has of its own; by default what the terms say.
        """
        own = self.added.own_of(recording.name) if own is None else own
        alike, moving = self._with(own)
        p = alike.copy()
        p[ORIGIN] = float(self.law.position(np.array(recording.origin)))
        table, spline = recording.moved_table(moving), self.added.spline
        if spline is not None:
            table = spline.load(table, recording.times, self.problem.rig.gravity)
        return p, table

    def _with(self, own: Own) -> tuple[FloatArray, Moving]:
        """The kernel's vector but for the origin, and what moves the beam, where recordings have this of their own."""
        latest = self._latest
        if latest is None or latest[0] != own:
            problem, added = self.problem, self.added
            effects = (*problem.declared, *added.effects_in(own))
            p = parameters_with(problem.model, problem.rig, effects, phase=own.phase)
            if added.spline is not None:
                added.spline.write(p, own.phase)
            latest = self._latest = own, p, Moving.by(effects)
        return latest[1:]
