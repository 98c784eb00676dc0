"""`harness check-scene`: whether a scene of the user's own can be driven with the recordings."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from harness.cli.options import PathType, is_quiet, quiet_option


@click.command("check-scene")
@click.argument("case", type=PathType())
@click.option("--beam-joint", metavar="NAME", help="Hinge of the beam, in place of the one in rig.toml.")
@click.option("--ball", metavar="NAME", help="Body of the ball in an MJCF, in place of the one in rig.toml.")
@click.option(
    "--direction",
    type=click.Choice(["1", "-1"]),
    help="1 if α grows with the joint's angle, -1 if it falls; in place of the one in rig.toml.",
)
@click.option("--driven-joint", metavar="NAME", help="Joint of the crank that turns the beam, in place of rig.toml's.")
@click.option("--out", type=PathType(), help="Folder to write scene_check.json into [default: nothing is written].")
@click.option(
    "--force", is_flag=True, help="Replace a file that this command did not write, or that has been changed since."
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON on stdout.")
@quiet_option
def check_scene(case: Path, direction: str | None, out: Path | None, force: bool, as_json: bool, **names: Any) -> None:
    """Check a scene of your own: can the recorded angle drive it, and is it the rig that rig.toml describes?

    CASE is a folder whose rig.toml has a table [scene], or an MJCF or URDF alone. The beam's joint, the ball, the
    contact, the track and what else acts are looked up, and rolling radius, eccentricity, slope and length of the track
    are measured by touch. The exit code is 1 if the scene is not fit to be compared with the recordings.

    \b
    Examples:
      harness check-scene my_rig/
      harness check-scene my_beam.xml --beam-joint tilt --ball marble
      harness check-scene my_rig/ --direction -1 --json
    """
    from harness.api.outputs import to_json
    from harness.api.scene import check_scene as check
    from harness.engines.own_scene.checks import Status

    turn = None if direction is None else int(direction)
    made = check(case, direction=turn, progress=not is_quiet(), **names)
    if out is not None:
        made.save(out, force=force)
    if as_json:
        click.echo(to_json(made.record()))
    else:
        for engine, checks in made.checks.items():
            told = [one for one in checks if not is_quiet() or one.status is Status.ERROR]
            if told:
                click.echo(f"{engine}:")
            for one in told:
                click.echo(f"  {one.status.value:7} {one.name}: {one.text}")
        click.echo(made.sentence)
    sys.exit(0 if made.fit else 1)
