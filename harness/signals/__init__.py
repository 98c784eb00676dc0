"""Smoothing of recorded signals: value, first and second derivative that belong together, with their covariance."""

from harness.signals.quantised import smooth_rounded
from harness.signals.spline_smoother import Smoothed, draw, smooth

__all__ = ["Smoothed", "draw", "smooth", "smooth_rounded"]
