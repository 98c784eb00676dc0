"""Jobs on this machine or on others, through one interface: a function, its arguments, results as they come."""

from harness.jobs.choose import executor_on
from harness.jobs.gather import gathered
from harness.jobs.interface import ATTEMPTS, DIED, TIME_LIMIT, Executor, Lost
from harness.jobs.local import Local
from harness.jobs.one_process import OneProcess

__all__ = ["ATTEMPTS", "DIED", "TIME_LIMIT", "Executor", "Local", "Lost", "OneProcess", "executor_on", "gathered"]
