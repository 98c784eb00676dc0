"""Many runs of an engine side by side, each exactly as alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from functools import partial

from analytic.motion import BallForce, BeamMotion, FloatArray, State
from analytic.rig import Rig
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine, EngineRun
from harness.errors import EngineFailure
from harness.parallel import side_by_side


@dataclass(frozen=True)
class Variant:
    """What `Engine.run` is given for one of many runs; see there."""

    rig: Rig
    motion: BeamMotion
    start: State
    time: FloatArray
    parameters: EngineParameters | None = None
    force: BallForce | None = None


def run_many(
    engine: Engine,
    variants: Sequence[Variant],
    *,
    workers: int = 1,
    on_done: Callable[[int], None] = lambda _: None,
) -> list[EngineRun | EngineFailure]:
    """Run all `variants`; the results are those of `engine.run`, bit for bit, with the same checks of their health.

    Args:
        engine: runs them.
        variants: any rigs, motions, stamps and settings, in any mixture.
        workers: how many run side by side, in threads where the engine computes outside of Python's lock (MuJoCo
            without an additional force), else in forked processes as in `harness.parallel`.
        on_done: called after each run with the number of finished runs.

    Returns:
        In the order of `variants` the run, or the failure where it was invalid: one bad variant costs no other.

    Raises:
        InputError: as `Engine.run`.
        HarnessError: a process ended during a run.
    """
    jobs = [partial(_run, engine, one) for one in variants]
    if not engine.threads or workers < 2 or any(one.force is not None for one in variants):
        return side_by_side(jobs, workers, on_done)
    with ThreadPoolExecutor(workers) as pool:
        pending = [pool.submit(job) for job in jobs]
        try:
            for done, future in enumerate(as_completed(pending), start=1):
                future.result()
                on_done(done)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [future.result() for future in pending]


def _run(engine: Engine, one: Variant) -> EngineRun | EngineFailure:
    try:
        return engine.run(one.rig, one.motion, one.start, one.time, parameters=one.parameters, force=one.force)
    except EngineFailure as failure:
        return failure
