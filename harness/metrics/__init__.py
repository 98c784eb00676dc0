"""Validation metrics: the error of a model against the measurement, in physical units, per source and horizon.

The input is one `RunComparison` per run: measured and model positions on common time stamps, with velocities, outlier
mask and uncertainty if known. `score` pools them into a `Score`, whose fields are the columns of metrics.csv. `METRICS`
describes each metric, its unit, and which values are better.
"""

from harness.metrics.catalogue import METRICS, Better, Metric, Score, find_metric
from harness.metrics.errors import validation_uncertainty
from harness.metrics.own import OwnMetric, check_names, own_value
from harness.metrics.run_comparison import RunComparison
from harness.metrics.score import TOLERANCE, WHOLE, horizon_name, score

__all__ = [
    "METRICS",
    "TOLERANCE",
    "WHOLE",
    "Better",
    "Metric",
    "OwnMetric",
    "RunComparison",
    "Score",
    "check_names",
    "find_metric",
    "horizon_name",
    "own_value",
    "score",
    "validation_uncertainty",
]
