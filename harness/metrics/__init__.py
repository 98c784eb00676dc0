"""How far a model is from the measurement: metrics in physical units, one record a source and horizon.

You provide `Comparison`s (measured and model positions on common stamps; velocities, outlier mask and uncertainty if
known), one for a free run or one a window; `score` returns a `Score`, whose fields are the columns of
metrics.csv. `METRICS` says what each means, in which unit, and which values are better.
"""

from harness.metrics.catalogue import METRICS, Better, Metric, Score, find_metric
from harness.metrics.comparison import Comparison
from harness.metrics.score import TOLERANCE, WHOLE, horizon_name, score
from harness.metrics.validation import validation_uncertainty

__all__ = [
    "METRICS",
    "TOLERANCE",
    "WHOLE",
    "Better",
    "Comparison",
    "Metric",
    "Score",
    "find_metric",
    "horizon_name",
    "score",
    "validation_uncertainty",
]
