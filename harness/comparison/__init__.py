"""One recording through every model and engine: trajectories, scores, attribution, the paper's claims."""

from harness.comparison.setting import Choices, Setting, prepare
from harness.comparison.study import Study, study

__all__ = ["Choices", "Setting", "Study", "prepare", "study"]
