"""The error of a beam's angle behind a linkage with play, as a Gauss–Markov process.

A beam that the linkage turns has the error of the measured angle. One that stands within the gap keeps the error which
it had when the linkage turned back, until that meets it again. Where within the gap it stood when the recording began
is not known, and neither is its angle before it has been met from both sides.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.effects import beam_in_play
from analytic.motion import BeamMotion, FloatArray
from harness.signals.error_process import ErrorProcess
from harness.signals.triangular_roots import PIVOT, root_of

_BEGINS = np.linspace(-1.0, 1.0, 65)[1::2]  # where a beam may begin within its gap, of half its width [1]
_MET = 1e-9  # of the gap: below, beams that began at its two ends are one


def behind_play(error: ErrorProcess, angle: BeamMotion, stamps: FloatArray, width: float, delay: float) -> ErrorProcess:
    """The error of the angle of a beam that begins mid-gap behind `angle`.

    Args:
        error: of `angle` at the stamps, shape (n,) [s].
        width: of the gap [rad].
        delay: by which the beam is looked at later than it moves [s].
    """
    middle, lowest, highest = (beam_in_play(angle, stamps, width, begin) for begin in (0.0, -1.0, 1.0))
    seen = stamps - delay
    here = middle.evaluate(seen)
    low, high = lowest.evaluate(seen) - here, highest.evaluate(seen) - here
    known = high - low > _MET * width
    begins = 0.5 * width * _BEGINS[:, None]
    apart = np.where(known, np.clip(begins, low, high), 0.0)  # of a beam that begins elsewhere, until it is met
    variance, product = np.mean(apart**2, axis=0), np.mean(apart[:, 1:] * apart[:, :-1], axis=0)
    made = ErrorProcess(*(part.copy() for part in error))
    _stand(error.covariance, error.transition, ~middle.moved_at(seen), variance, product, *made)
    return made


@njit(cache=True)
def _stand(
    known: FloatArray,
    forgets: FloatArray,
    standing: NDArray[np.bool_],
    variance: FloatArray,
    product: FloatArray,
    covariance: FloatArray,
    transition: FloatArray,
    root: FloatArray,
) -> None:
    """Replace covariance, transition and root, those of the measured angle, where the beam stands.

    Of the state (e, ė, ë) at the turn of the linkage, the beam keeps e; when it is met again, the error of the measured
    angle is what that e tells of it, and the rest.

    Args:
        known, forgets: covariance and transition of the error of the measured angle.
        standing: whether the beam stands at a stamp, shape (n,).
        variance: of where the beam may be that has not been met from both sides yet, shape (n,) [rad²].
        product: its covariance with that of the next stamp, shape (n − 1,) [rad²].
    """
    first = known[0, 0, 0]
    carried, at_turn = np.zeros(3), 0.0  # covariance of the measured angle's error with e of the turn; variance of e
    if variance[0] > 0.0:
        covariance[0] = 0.0
        covariance[0, 0, 0] = first + variance[0]
    for k in range(len(transition)):
        stands = standing[k + 1]
        if variance[k + 1] > 0.0:
            before, after, both = first + variance[k], first + variance[k + 1], first + product[k]
            transition[k], root[k], covariance[k + 1] = 0.0, 0.0, 0.0
            covariance[k + 1, 0, 0] = after
            transition[k, 0, 0] = both / before
            root[k, 0, 0] = np.sqrt(max(after - both * both / before, 0.0))
        elif variance[k] > 0.0:  # met from both sides: nothing of the first error is left
            carried[:], at_turn = known[k + 1, :, 0], known[k + 1, 0, 0]
            transition[k], root[k] = 0.0, 0.0
            if stands:
                covariance[k + 1] = 0.0
                covariance[k + 1, 0, 0] = at_turn
                root[k, 0, 0] = np.sqrt(at_turn)
            else:
                root_of(known[k + 1], root[k], 0)
        elif stands:
            if not standing[k]:
                carried[:], at_turn = known[k, :, 0], known[k, 0, 0]
            carried[:] = forgets[k] @ carried
            transition[k], root[k], covariance[k + 1] = 0.0, 0.0, 0.0
            transition[k, 0, 0] = 1.0
            covariance[k + 1, 0, 0] = at_turn
        elif standing[k]:
            carried[:] = forgets[k] @ carried
            transition[k], root[k] = 0.0, 0.0
            rest = known[k + 1].copy()
            for i in range(3):
                told = carried[i] / at_turn if at_turn > 0.0 else 0.0
                transition[k, i, 0] = told
                for j in range(3):
                    rest[i, j] -= told * carried[j]
                rest[i, i] = max(rest[i, i], PIVOT * known[k + 1, i, i])
            root_of(rest, root[k], 0)
