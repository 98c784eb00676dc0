"""Sweeps: many runs over settings of engines, step sizes, rig quantities, effects and recordings, kept as they end."""

from harness.sweeps.plan import Plan, Run, plan_of
from harness.sweeps.spec import Spec, read_spec
from harness.sweeps.store import Store
from harness.sweeps.work import Batch, do_batch

__all__ = ["Batch", "Plan", "Run", "Spec", "Store", "do_batch", "plan_of", "read_spec"]
