"""Smoothing of recorded signals: value, first and second derivative that belong together, with their covariance."""

from harness.smoothing.rounded import smooth_rounded
from harness.smoothing.wiener import Smoothed, draw, smooth

__all__ = ["Smoothed", "draw", "smooth", "smooth_rounded"]
