"""`python -m benchmarks.performance`: times side by side, in `docs/performance.md`, `.json` and the README."""

from __future__ import annotations

import importlib.util
import json
import subprocess
import tempfile
from pathlib import Path

import click

from benchmarks.calibration.store import sources_digest
from benchmarks.performance import commands, engines, in_c
from benchmarks.performance.page import Line, in_readme, page, summary, table
from harness.progress import Progress

_DOCS, _README = Path("docs"), Path("README.md")
_CASES = Path("../shared/cases")
_KERNEL = (
    "200 runs of a recording of 16 s at 100 Hz in steps of 2.5 ms through `analytic.kernel.integrate`, against the "
    "same steps in C (`benchmarks/performance/rk4.c`, gcc {flags}), called once a run; results agree to a nanometre."
)
_ENGINE = (
    "A run of {seconds} s at 1 ms on a beam that swings by 0.6°, from the rig to the positions at 100 Hz with all "
    "checks of its health, against {other}, each from the making of the scene on; processor time."
)


@click.command()
@click.option("--pairs", type=click.IntRange(7), default=7, show_default=True, help="Pairs of each line.")
@click.option("--docs", type=click.Path(path_type=Path), default=_DOCS, show_default=True, help="Folder of the page.")
@click.option(
    "--readme", type=click.Path(path_type=Path), default=_README, show_default=True, help="File with the section."
)
def main(pairs: int, docs: Path, readme: Path) -> None:
    """Measure kernel, engines and commands beside what else one would use; a quarter of an hour.

    Example: python -m benchmarks.performance --pairs 9
    """

    def tell(text: str, *, share: float | None = None) -> None:
        click.echo(text, err=True)

    with tempfile.TemporaryDirectory(prefix="performance-") as scratch:
        lines, left_out = measured(pairs, Path(scratch), tell)
    told = summary(lines, left_out, sources_digest())
    (docs / "performance.json").write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    (docs / "performance.md").write_text(page(told), encoding="utf-8")
    readme.write_text(in_readme(told, readme.read_text(encoding="utf-8")), encoding="utf-8")
    click.echo(table(told))


def measured(pairs: int, folder: Path, tell: Progress) -> tuple[list[Line], list[str]]:
    """All lines, and those that could not be measured, with the reason."""
    lines, left_out = [], []
    tell("kernel")
    try:
        lines += _of_kernel(pairs, folder)
    except (in_c.CompilerMissing, subprocess.CalledProcessError) as error:
        left_out.append(f"kernel against C: {error}")
    tell("engines")
    lines += _of_engines(pairs)
    tell("first run against later ones")
    about = (
        "`harness run` with machine code and bytecode as `make setup` leaves them, against the run after it; processor "
        "time of all processes."
    )
    first = commands.first_against_later(pairs, folder)
    lines.append(Line.times("first `harness run` after set-up, time over that of a later one", 1.3, first, about))
    tell("diagnosis")
    if not _CASES.is_dir():
        return lines, [*left_out, "lines of `harness diagnose`: the folder ../shared with their cases is absent"]
    if importlib.util.find_spec("mujoco.sysid") is None:
        left_out.append("`harness diagnose` against `mujoco.sysid`: the extra `sysid` is not installed")
    else:
        lines.append(_of_diagnosis(pairs, _CASES / "viscous", folder))
    times, parts = commands.diagnoses(pairs, _CASES / "unlisted_wind", folder)
    title, about = "`harness diagnose` of the simulated case `unlisted_wind`", "Processor time of all processes."
    reason = _where(parts, _CASES / "unlisted_wind", folder)
    lines.append(Line(title, 10.0, True, tuple(times), about, unit="s", reason=reason))
    return lines, left_out


def _of_kernel(pairs: int, folder: Path) -> list[Line]:
    about = _KERNEL.format(flags=" ".join(in_c.FLAGS))
    smooth, sticking = in_c.smooth_against_c(pairs, folder), in_c.sticking_against_c(pairs, folder)
    rests = " A resistance of 0.016 brings the balls to rest again and again; they rest at every third stamp."
    return [
        Line.speed("kernel, speed over that of C", 0.8, smooth, about),
        Line.speed("kernel with resistance and sticking, speed over that of C", 0.7, sticking, about + rests),
    ]


def _of_engines(pairs: int) -> list[Line]:
    loop = "a loop in Python over the same scene that sets the beam's acceleration, steps and logs positions"
    pushed = loop + ", with the same viscous force evaluated and applied at each step in both"
    driven = "a loop in Python over the same scene that sets the beam's angle and rate, steps and logs positions"
    beside = (
        "Beside the steps there are the grid, positions in the beam's frame, interpolation to the stamps, and health."
    )
    shares = "Shares of a run in a profile, which slows Python's own functions down"
    extra = f"{beside} {shares}: {engines.profile('mujoco', 60.0)}."
    of_pybullet = f"{beside} {shares}: {engines.profile('pybullet', 20.0)}."
    force = "The velocity that the force is given is that at the instant, extrapolated; it is computed in Python."
    variants = (
        "64 runs of 10 s at 1 ms with as many coefficients of friction in two threads (`harness.engines.many`), all "
        "checked and interpolated to stamps, against `mujoco.rollout` of as many models in two threads; wall time."
    )
    return [
        Line.times(
            "MuJoCo, time over that of a bare loop in Python", 1.10, engines.against_loop(pairs),
            _ENGINE.format(seconds=60, other=loop), extra,
        ),
        Line.times(
            "MuJoCo with an injected force, time over that of a bare loop with the force", 1.10,
            engines.against_loop_with_force(pairs), _ENGINE.format(seconds=30, other=pushed), f"{extra} {force}",
        ),
        Line.times(
            "MuJoCo, time over that of `mujoco.rollout`", 1.02, engines.against_rollout(pairs),
            _ENGINE.format(seconds=60, other="`mujoco.rollout` of the same scene"), extra,
        ),
        Line.times(
            "PyBullet, time over that of a bare loop in Python", 1.10, engines.pybullet_against_loop(pairs),
            _ENGINE.format(seconds=20, other=driven), of_pybullet,
        ),
        Line.speed(
            "64 MuJoCo variants on two cores, speed over that of `mujoco.rollout` in two threads", 0.95,
            engines.many_against_rollout(pairs), variants, extra,
        ),
    ]  # fmt: skip


def _of_diagnosis(pairs: int, case: Path, folder: Path) -> Line:
    made, parts = commands.diagnosis_against_fit(pairs, case, folder)
    about = (
        "Processor time of a diagnosis of the simulated case `viscous` (whole catalogue, all recordings, fits without "
        "each of them, baselines, two engines, report), against one fit of viscosity, level and start to one recording "
        "by `mujoco.sysid` (`benchmarks/growth/by_sysid.py`)."
    )
    reason = _where(parts, case, folder)
    return Line.times("`harness diagnose` over one fit of four parameters by `mujoco.sysid`", 1.0, made, about, reason)


def _where(parts: str, case: Path, folder: Path) -> str:
    """Where the time of a diagnosis goes, and what would have to be faster."""
    functions = commands.functions_of(case, folder)
    return (
        f"Where the time goes (medians of shares of the wall time): {parts}. Processor time by samples of another run: "
        f"{functions}. What limits it are the filter, compiled, over all readings for each parameter of each "
        "hypothesis, and the engines' steps."
    )


if __name__ == "__main__":
    main()
