"""One recording through every model and engine: trajectories, scores, attribution, the paper's claims."""

from harness.compare.setting import Choices, Setting, prepare
from harness.compare.study import Study, study

__all__ = ["Choices", "Setting", "Study", "prepare", "study"]
