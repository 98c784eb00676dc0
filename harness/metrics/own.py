"""Metrics of the user's own: functions of a run and the measurement, each a further column of the scores."""

import re
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from harness.errors import InputError
from harness.metrics.catalogue import Score
from harness.metrics.run_comparison import RunComparison

OwnMetric = Callable[[RunComparison], float]


def check_names(metrics: Mapping[str, OwnMetric]) -> None:
    """Refuse what cannot be a column of the scores.

    Raises:
        InputError: a name is taken or none of a column, or there is no function of this name.
    """
    for name, function in metrics.items():
        if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9_]*", name):
            raise InputError(
                f"metrics: {name!r} cannot be the name of a column; use lower case, digits and _, with the unit at the "
                "end, as in overshoot_mm"
            )
        if name in Score.__dataclass_fields__:
            raise InputError(f"metrics: the name {name!r} is taken; choose another")
        if not callable(function):
            raise InputError(f"metrics: {name} is {function!r}, and not a function of a harness.metrics.RunComparison")


def own_value(name: str, function: OwnMetric, windows: Sequence[RunComparison], where: str) -> float:
    """Median over the windows where the metric is defined; NaN if it is in none.

    Args:
        name: of the metric.
        function: gives its value for one run, NaN where it is undefined.
        windows: runs of one source on one horizon.
        where: source and horizon, for messages.

    Raises:
        InputError: the function raises an error, or gives what is not a number.
    """
    values = []
    for window in windows:
        try:
            value = function(window)
        except Exception as error:
            raise InputError(f"metrics: {name} fails for {where}: {type(error).__name__}: {error}") from error
        if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.integer | np.floating):
            raise InputError(
                f"metrics: {name} gives {value!r} for {where}; return one number, NaN where it is undefined"
            )
        values.append(float(value))
    known = [value for value in values if not np.isnan(value)]
    return float(np.median(known)) if known else np.nan
