"""`harness view`: an engine's run over a recording, in a window, as a video or as a log for the Rerun viewer."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from harness.cli.options import CaseType, Finite, FiniteRange, PathType, is_quiet, quiet_option
from harness.errors import InputError

_PATH = PathType()


@click.command()
@click.argument("case", type=CaseType())
@click.option("--engine", default="mujoco", show_default=True, metavar="NAME", help="mujoco, pybullet or dart.")
@click.option("--recording", metavar="NAME", help="Which recording of the case [default: the first to identify from].")
@click.option(
    "--video",
    type=_PATH,
    metavar="FILE",
    help="Write a video, .mp4 or .gif, instead of opening a window; needs no display.",
)
@click.option(
    "--rerun",
    type=_PATH,
    metavar="FILE",
    help="Write a log for the Rerun viewer, .rrd, instead of opening a window; needs the extra `rerun`.",
)
@click.option(
    "--speed",
    type=FiniteRange(min=0.0, min_open=True),
    default=1.0,
    show_default=True,
    help="Recorded seconds a second.",
)
@click.option("--from", "begin", type=Finite(), metavar="SECONDS", help="Show the recording from this time on.")
@click.option("--to", "end", type=Finite(), metavar="SECONDS", help="Show the recording up to this time.")
@click.option(
    "--effects",
    multiple=True,
    type=_PATH,
    metavar="DIAGNOSIS",
    help="diagnosis.json or its folder: the effects found act in a second run. Also a Python file with effects of your "
    "own that it or rig.toml names; repeatable.",
)
@click.option(
    "--set", "assignments", multiple=True, metavar="ENGINE.NAME=VALUE", help="Set a contact parameter; repeatable."
)
@click.option(
    "--parameters",
    type=_PATH,
    metavar="FILE",
    help="Contact parameters from a TOML file, such as `harness tune` writes; --set wins.",
)
@click.option(
    "--force", is_flag=True, help="Replace a file that this command did not write, or that has been changed since."
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON on stdout.")
@quiet_option
def view(
    case: Path,
    engine: str,
    effects: tuple[Path, ...],
    assignments: tuple[str, ...],
    parameters: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Show the driven rig with an engine's ball, and the recorded ball as a ghost.

    The engine runs over the whole recording first; then the run is played back in the viewer of MuJoCo (of PyBullet for
    its own runs), or written as a video of 960 × 540 pixels. Keys: space pauses, left and right go back and on, up and
    down change the speed, home begins anew, enter switches effects on and off. In a video the runs without and with
    effects are one above the other. A log (--rerun) has the beam with all balls, plots of angle, positions and
    residuals, and what happens in words; `rerun FILE` opens it.

    \b
    Examples:
      harness view open_ball_beam
      harness view my_rig/ --engine pybullet --recording swing_02.csv --speed 0.5
      harness view my_rig/ --effects reports/my_rig/ --video my_rig.mp4
      harness view paper_protocol --from 2 --to 6 --video clip.gif
      harness view my_rig/ --effects reports/my_rig/ --rerun my_rig.rrd
    """
    from harness.api.outputs import to_json
    from harness.api.same_rig import changed_since, of_another_rig
    from harness.api.saved import load_diagnosis
    from harness.api.view import view as show
    from harness.engines.catalogue import read_settings
    from harness.recording import load_case
    from harness.recording.rig_changes import with_rig_changes

    diagnoses = [one for one in effects if one.suffix.lower() != ".py"]
    if len(diagnoses) > 1:
        raise InputError(f"--effects names more than one diagnosis: {', '.join(map(str, diagnoses))}; name one")
    settings = read_settings(parameters, assignments)
    if idle := sorted(set(settings) - {engine}) if assignments else []:
        raise InputError(f"parameters of {', '.join(idle)} are set, but {engine} runs; drop them or choose --engine")
    own = [one for one in effects if one not in diagnoses]
    read = with_rig_changes(load_case(case), parameters)
    kept = load_diagnosis(diagnoses[0], effects=own) if diagnoses else None
    if kept is not None:
        for warning in (
            changed_since(kept.record, kept.origin),
            of_another_rig(kept.record, read.rig, read.sha256, case),
        ):
            if warning:
                click.echo(warning, err=True)
    made = show(
        read,
        engine=engine,
        diagnosis=kept,
        effects=own,
        settings=settings.get(engine, {}),
        progress=not is_quiet(),
        **options,
    )
    if as_json:
        click.echo(to_json(made.content()))
        return
    if not is_quiet():
        click.echo(str(made.summary().text()))
    if made.video is not None:
        counted = "1 frame" if made.frames == 1 else f"{made.frames} frames"
        click.echo(f"video: {made.video} ({counted}, {made.frames / made.frames_per_s:.1f} s)")
    if made.log is not None:
        click.echo(f"log: {made.log} ({made.stamps} stamps); open it with: rerun {made.log}")
