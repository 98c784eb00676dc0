"""Commands and their options. Exit codes: 0 done, 1 the answer is no, 2 bad use or bad input, 3 a part failed.

Interrupted (SIGINT) a command ends with 130, terminated (SIGTERM) with 143; both clean up.
"""

import os
import shlex
import signal
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

from harness.cli.check import check
from harness.cli.check_scene import check_scene
from harness.cli.compile import compile_
from harness.cli.completion import completion
from harness.cli.doctor import doctor
from harness.cli.export import export
from harness.cli.import_ import import_
from harness.cli.options import (
    AngleType,
    CaseType,
    FiniteRange,
    PathType,
    StateType,
    Whole,
    is_quiet,
    quiet_option,
)
from harness.cli.sweep import sweep
from harness.cli.termination import terminable
from harness.cli.tune import tune
from harness.cli.view import view
from harness.errors import HarnessError, Terminated, printable


class Friendly(click.Group):
    """A group that turns a `HarnessError`, an interrupt or a termination into a message and its exit code."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; a `HarnessError` ends it with one message."""
        try:
            with terminable():
                return super().invoke(ctx)
        except HarnessError as error:
            click.echo(f"error: {error}", err=True)
            sys.exit(error.exit_code)
        except click.UsageError as error:
            # click itself breaks the list of choices into lines
            raise click.UsageError(printable(error.format_message().replace("\n\t", " ")), error.ctx) from error
        except KeyboardInterrupt:
            click.echo("error: interrupted", err=True)
            sys.exit(128 + signal.SIGINT)
        except Terminated:
            click.echo("error: terminated", err=True)
            sys.exit(128 + signal.SIGTERM)


class RunCommand(click.Command):
    """`harness run`, whose help also lists every parameter that `--set` takes."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the engines' parameters below the options."""
        from harness.engines.catalogue import DEFAULT_ENGINES, describe, engine_of

        for name in DEFAULT_ENGINES:
            with formatter.section(f"Parameters of {name} (--set {name}.NAME=VALUE, default in brackets)"):
                rows = [(key, f"[{default}] {text}") for key, default, text in describe(engine_of(name))]
                formatter.write_dl(rows, col_max=36)
        super().format_epilog(ctx, formatter)


_PATH = PathType()
_out_option = click.option("--out", type=_PATH, help="Folder to write into [default: reports/<name of the case>].")
_force_option = click.option(
    "--force", is_flag=True, help="Replace files that this command did not write, or that have been changed since."
)
_yes_option = click.option("--yes", is_flag=True, help="Go on although it takes over ten minutes or 4 GB.")
_effects_option = click.option(
    "--effects",
    multiple=True,
    type=_PATH,
    metavar="FILE",
    help="Python file with effects of your own, added to the catalogue; repeatable.",
)


@click.group(cls=Friendly, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(package_name="ball-beam-harness")
def main() -> None:
    """Cross-validate MuJoCo, PyBullet and analytic models of a ball-and-beam rig against its recordings.

    \b
    Examples:
      harness run                       the bundled, simulated recording of the paper's protocol
      harness diagnose open_ball_beam   a bundled recording that was measured
      harness run my_rig/               a folder with rig.toml and CSV recordings
      harness run swing.csv             one recording of the paper's rig
      harness check my_rig/             fit for use? which effects could it show?
      harness diagnose my_rig/          missing physics by name, with parameters and intervals
      harness predict reports/my_rig/ my_rig/rec_03.csv
      harness export reports/my_rig/ --to fmu
      harness replay reports/my_rig/ my_rig/
      harness simulate --out virtual/ --imperfect
      harness tune my_rig/              contact parameters of an engine, with intervals
      harness view my_rig/ --video my_rig.mp4   an engine's ball and the recorded one
      harness sweep sweep.toml          many runs over settings, step sizes, rigs and recordings
      harness check-scene my_rig/       a scene of your own, see docs/scenes.md
      harness import log.mat            a case of what Simulink, LabVIEW or an oscilloscope wrote
      harness compile                   kernels, once, so that the first command need not wait
      harness doctor                    what is installed here and works
      harness completion bash           completion for your shell, see docs/check.md

    Recordings hold time [s], beam angle [rad or deg] and ball position [m or mm]. Exit codes: 0 done, 1 the answer is
    no, 2 bad use or bad input, 3 an engine failed (or another part; all else is written).
    """


@main.command(cls=RunCommand)
@click.argument("case", required=False, type=CaseType())
@_out_option
@click.option("--recording", metavar="NAME", help="Which recording of the case [default: the first to identify from].")
@click.option(
    "--engine",
    "engines",
    multiple=True,
    metavar="NAME",
    help="Engine to run: mujoco, pybullet, dart; repeatable [default: mujoco and pybullet].",
)
@click.option(
    "--set", "assignments", multiple=True, metavar="ENGINE.NAME=VALUE", help="Set a contact parameter; repeatable."
)
@click.option(
    "--parameters",
    type=_PATH,
    metavar="FILE",
    help="Contact parameters from a TOML file, one table an engine; --set wins.",
)
@click.option(
    "--start",
    type=StateType(),
    default="estimate",
    show_default=True,
    help="Initial state at the first stamp, position [m] and velocity [m/s].",
)
@click.option(
    "--level-angle",
    type=AngleType(),
    metavar="ANGLE|estimate",
    help="Level angle α₀ in rad, or as -0.16deg [default: as in rig.toml; else 0, or estimated if rig quantities are "
    "unknown].",
)
@click.option(
    "--window",
    "windows",
    type=FiniteRange(min=0.05),
    multiple=True,
    metavar="SECONDS",
    help="Length of the windows; repeatable [default: 1, 2 and 5 s].",
)
@click.option(
    "--tube",
    type=FiniteRange(min=0.0, min_open=True),
    default=0.010,
    show_default=True,
    metavar="METRES",
    help="Half width of the tolerance tube.",
)
@click.option("--seed", type=Whole(min=0), default=0, show_default=True, help="Seed of the Monte Carlo draws.")
@click.option(
    "--check", "check_limits", is_flag=True, help="Check the result against tolerances; exit code 1 if one is violated."
)
@click.option(
    "--tolerances",
    type=_PATH,
    metavar="FILE",
    help="Limits for --check [default: tolerances.toml of the case, else the package's].",
)
@_effects_option
@_force_option
@_yes_option
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON on stdout.")
@quiet_option
def run(case: Path | None, **options: Any) -> None:
    """Drive every model and engine with the recorded beam angle and write the comparison report.

    CASE is a folder with rig.toml and CSV recordings, a CSV file (then the paper's rig is assumed), or a bundled case:
    paper_protocol, which is simulated and the default, or open_ball_beam, which was measured. Writes report.html,
    trajectories.csv, metrics.csv and manifest.json.

    \b
    Examples:
      harness run
      harness run my_rig/ --recording swing_02.csv --set mujoco.friction=0.3
      harness run my_rig/ --level-angle estimate --check
    """
    from harness.cli.run import run_case

    sys.exit(run_case(case, command=shlex.join(["harness", *sys.argv[1:]]), **options))


@main.command()
@click.argument("case", type=CaseType())
@_out_option
@click.option(
    "--also",
    multiple=True,
    type=_PATH,
    metavar="FILE",
    help="Further recording of the rig, with positions, for validation only: errors before and after are reported; "
    "repeatable.",
)
@click.option(
    "--parameters",
    type=_PATH,
    metavar="FILE",
    help="Settings of the engines that validate the result, from a TOML file such as `harness tune` writes; its table "
    "[rig] is left aside, as effects that are found stand for it.",
)
@_effects_option
@click.option(
    "--accept",
    multiple=True,
    metavar="CODE",
    help="Diagnose in spite of a finding about the input that makes a verdict worthless, such as angle-sign; the "
    "message names the code; repeatable.",
)
@_force_option
@_yes_option
@click.option("--json", "as_json", is_flag=True, help="Print diagnosis.json on stdout.")
@quiet_option
def diagnose(case: Path, out: Path | None, as_json: bool, **options: Any) -> None:
    """Identify missing physics: effects with parameters and intervals, and the errors before and after.

    CASE is a folder with rig.toml and CSV recordings, a CSV file (then the paper's rig is assumed), or a bundled case:
    paper_protocol (simulated) or open_ball_beam (measured). Writes diagnosis.json and diagnosis.html, prediction_*.csv
    for every recording that rig.toml lists to predict, and next_experiment.csv, the beam angle [rad] to record next, if
    one is proposed. Values are in SI units. If an engine, a candidate or a section of the report fails, the rest is
    written, and the exit code is 3. Input that contradicts physics (a reversed sign, exchanged columns, wrong units) is
    refused with exit code 1.

    \b
    Examples:
      harness diagnose open_ball_beam
      harness diagnose my_rig/
      harness diagnose my_rig/ --effects magnet.py
      harness diagnose my_rig/ --also my_rig/swing_07.csv
    """
    from harness.api.diagnosis import REPORT
    from harness.api.diagnosis import diagnose as find
    from harness.api.outputs import report_folder
    from harness.identify.record import FILE
    from harness.recording.findings import warnings_of

    folder = out or report_folder(case)
    made = find(case, out=folder, jobs=os.cpu_count() or 1, progress=not is_quiet(), **options)
    files = f"diagnosis: {folder / FILE}\nreport: {folder / REPORT}"
    warnings = "".join(f"  {one}\n" for one in warnings_of(made.findings))
    click.echo(made.record.text() if as_json else f"{made.sentence}\n{warnings if not is_quiet() else ''}{files}")
    for one in made.failures:
        click.echo(f"error: {one}", err=True)
    sys.exit(3 if made.failures else 0)


@main.command()
@click.argument("diagnosis", type=_PATH)
@click.argument("case", type=CaseType())
@click.option(
    "--refit", is_flag=True, help="Re-optimise every fit from its recorded parameters, and decide by the results."
)
@click.option("--engines", is_flag=True, help="Run the engines, too, and compare their errors.")
@_effects_option
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON on stdout.")
@quiet_option
def replay(diagnosis: Path, case: Path, refit: bool, as_json: bool, **options: Any) -> None:
    """Replay a diagnosis: check that its seal, its decisions and all that it concludes come out again.

    DIAGNOSIS is a diagnosis.json or the folder it is in, CASE what it was made from. Verdict, sentence, effects, model,
    prediction errors and baselines are computed anew, and every difference is listed. The exit code is 1 if anything
    differs, 2 if an input file has changed since.

    \b
    Examples:
      harness replay reports/my_rig/diagnosis.json my_rig/
      harness replay reports/my_rig/ my_rig/ --refit
    """
    from harness.api.outputs import to_json
    from harness.api.replay import replay as again

    done = again(diagnosis, case, refit=refit, progress=not is_quiet(), **options)
    if as_json:
        content = asdict(done)
        click.echo(to_json({"diagnosis": str(content.pop("origin")), "reproduced": done.reproduced, **content}))
    else:
        how = "re-optimised from their parameters" if refit else f"deviances within {done.largest:.1g}"
        lines = [f"{mismatch.where}: {mismatch.what}" for mismatch in done.mismatches]
        lines += [f"note: {name} has changed since: {change}" for name, change in done.other_versions.items()]
        lines += [f"not verified: {what}" for what in done.unverified]
        result = "nothing differs" if done.reproduced else f"{len(done.mismatches)} differ"
        click.echo("\n".join([*lines, f"{done.attempts} decisions, {done.fits} fits replayed ({how}): {result}"]))
    sys.exit(0 if done.reproduced else 1)


@main.command()
@click.argument("diagnosis", type=_PATH)
@click.argument("recording", type=_PATH)
@click.option("--out", type=_PATH, help="CSV to write [default: <recording>_predicted.csv beside it].")
@_effects_option
@_force_option
@click.option("--json", "as_json", is_flag=True, help="Print a summary as JSON on stdout.")
@quiet_option
def predict(diagnosis: Path, recording: Path, **options: Any) -> None:
    """Predict ball positions from the beam angle, with the model that a diagnosis identified.

    DIAGNOSIS is a diagnosis.json or the folder it is in. RECORDING is a CSV whose positions are blank after the first
    second or so; the initial state is estimated from the others. Writes time_s, ball_position_m and the 95 % interval
    low_m, high_m, and beside the CSV its hash in a hidden file, by which it is known when it is to be replaced.

    \b
    Examples:
      harness predict reports/my_rig/ my_rig/rec_03.csv
      harness predict reports/my_rig/diagnosis.json my_rig/rec_03.csv --out predicted.csv
    """
    from harness.cli.predict import predict_recording

    text, warnings = predict_recording(diagnosis, recording, **options)
    for warning in warnings:
        click.echo(warning, err=True)
    click.echo(text)


@main.command()
@click.option("--out", type=_PATH, required=True, help="Folder to write the case into; new, or empty.")
@click.option(
    "--hide",
    "hidden",
    multiple=True,
    metavar="NAME.PARAMETER=VALUE",
    help="Effect that acts and is not declared (SI units); repeatable.",
)
@click.option(
    "--declare",
    "declared",
    multiple=True,
    metavar="NAME.PARAMETER=VALUE",
    help="Effect that acts and is declared in rig.toml (SI units); repeatable.",
)
@click.option("--imperfect", is_flag=True, help="Record with imperfections of real rigs; kinds and sizes are drawn.")
@click.option(
    "--imperfection",
    "imperfections",
    multiple=True,
    metavar="KIND",
    help="Record with this kind of imperfection: sensor_lag, dropouts, spikes, worn_track, stamps, coarse_noise, "
    "zero_drift, commanded_angle, sampling; its size is drawn. Repeatable.",
)
@click.option(
    "--duration",
    type=FiniteRange(min=2.0, max=600.0),
    default=16.0,
    show_default=True,
    metavar="SECONDS",
    help="Length of each recording.",
)
@click.option("--seed", type=Whole(min=0), default=0, show_default=True, help="Seed of moves, noise and imperfections.")
@click.option("--force", is_flag=True, help="Write into a folder that is not empty, and replace files there.")
@quiet_option
def simulate(out: Path, **options: Any) -> None:
    """Simulate a case with a known truth on the paper's rig: rigid bodies in contact, none of the models under test.

    Writes rig.toml, two recordings to identify from, one to predict, and truth.json: the effects that act, the
    imperfections of the record, the seed. All files of the same seed are the same.

    \b
    Examples:
      harness simulate --out virtual/ --hide level_error.angle=0.004
      harness simulate --out virtual/ --imperfect --seed 7
      harness simulate --out virtual/ --imperfection spikes --imperfection commanded_angle
    """
    from harness.cli.simulate import simulate_case

    click.echo(simulate_case(out, **options))


main.add_command(check)
main.add_command(sweep)
main.add_command(tune)
main.add_command(view)
main.add_command(check_scene)
main.add_command(import_)
main.add_command(export)
main.add_command(compile_)
main.add_command(doctor)
main.add_command(completion)
