"""`harness export`: the identified model as source code, FMU, scene or linear model."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from harness.cli.options import PathType, Whole, is_quiet, number_in, quiet_option


class PointType(click.ParamType):
    """`position=0.1,angle=0`: an operating point [m], [rad]."""

    name = "POINT"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> dict[str, float]:
        """Parse the option."""
        if isinstance(value, dict):
            return value
        point: dict[str, float] = {}
        for part in str(value).split(","):
            key, equals, text = part.partition("=")
            key = key.strip()
            if not equals or key not in ("position", "angle") or key in point:
                self.fail(f"{value!r} is not an operating point; write position=0.1,angle=0 (m, rad)", param, ctx)
            try:
                point[key] = number_in(text)
            except ValueError as error:
                self.fail(f"{key}: {error}", param, ctx)
        return point


@click.command("export")
@click.argument("diagnosis", type=PathType())
@click.option(
    "--to",
    required=True,
    type=click.Choice(["fmu", "mjcf", "urdf", "c", "python", "statespace"]),
    help="Format: co-simulation FMU; scene for MuJoCo or as URDF; source code; linear model.",
)
@click.option("--out", type=PathType(), help="Folder to write into [default: export_<format> beside the diagnosis].")
@click.option("--fmi", type=click.Choice(["2", "3"]), help="Version of FMI, for fmu alone [default: 2].")
@click.option("--at", type=PointType(), help="Operating point of statespace [default: position=0,angle=0].")
@click.option(
    "--pade",
    type=Whole(min=1, max=10),
    metavar="N",
    help="Also write statespace with a Padé approximation of its delay.",
)
@click.option("--effects", multiple=True, type=PathType(), metavar="FILE", help="Python file with effects of your own.")
@click.option(
    "--force", is_flag=True, help="Replace files that this command did not write, or that have been changed since."
)
@click.option("--json", "as_json", is_flag=True, help="Print a summary as JSON on stdout.")
@quiet_option
def export(diagnosis: Path, to: Any, fmi: str | None, as_json: bool, **options: Any) -> None:
    """Take the identified model away: as an FMU, a scene, source code, or a linear model.

    DIAGNOSIS is a diagnosis.json or the folder it is in. README.txt beside the files tells of every effect whether they
    have it, and how, or what to do instead; export.json has their hashes.

    \b
    Examples:
      harness export reports/my_rig/ --to fmu --fmi 3
      harness export reports/my_rig/ --to c --out my_rig_in_c/
      harness export reports/my_rig/ --to statespace --at position=0.1,angle=0 --pade 2
    """
    from harness.api.export import export as write
    from harness.api.outputs import to_json

    made = write(diagnosis, to, fmi={"2": 2, "3": 3, None: None}[fmi], **options)
    if made.warning:
        click.echo(made.warning, err=True)
    if as_json:
        click.echo(to_json(made.content()))
        return
    for one in () if is_quiet() else made.carried:
        click.echo(f"  {'carried' if one.carried else 'NOT CARRIED':11} {one.name}: {one.how}")
    click.echo(f"{to}: {made.folder} ({', '.join(made.files)})")
