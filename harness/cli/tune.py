"""`harness tune`: fit an engine's contact and scene parameters to recordings."""

from __future__ import annotations

import os
import shlex
import sys
from pathlib import Path
from typing import Any

import click

from harness.cli.options import CaseType, PathType, is_quiet, quiet_option

_PATH = PathType()


@click.command()
@click.argument("case", type=CaseType())
@click.option("--engine", default="mujoco", show_default=True, metavar="NAME", help="mujoco, pybullet or dart.")
@click.option(
    "--free",
    metavar="NAME[=LOW:HIGH],…",
    help="What may be tuned: parameters of the engine (`harness run --help` lists them) and, under their keys in "
    "rig.toml, rolling_radius_m, inertia_kg_m2, eccentricity_m, gravity_m_s2, each within its bounds or within these "
    "narrower ones [default: a set for each engine]. The level angle, level_angle_rad, is fitted in any case.",
)
@click.option(
    "--set",
    "assignments",
    multiple=True,
    metavar="ENGINE.NAME=VALUE",
    help="Set a parameter that is not to be tuned; repeatable.",
)
@click.option("--parameters", type=_PATH, metavar="FILE", help="The same from a TOML file; --set wins.")
@click.option(
    "--diagnosis",
    type=_PATH,
    metavar="FOLDER",
    help="Diagnosis of the same recordings, whose effects CAM is given [default: search for them].",
)
@click.option("--effects", multiple=True, type=_PATH, metavar="FILE", help="Python file with effects; repeatable.")
@click.option(
    "--on",
    default="",
    metavar="dask://HOST:PORT",
    help="Hand the fits to the workers of this Dask cluster (extra dask).",
)
@click.option("--accept", multiple=True, metavar="CODE", help="Go on in spite of a finding; repeatable.")
@click.option("--out", type=_PATH, help="Folder to write into [default: reports/<name of the case>].")
@click.option(
    "--force", is_flag=True, help="Replace files that this command did not write, or that have been changed since."
)
@click.option("--yes", is_flag=True, help="Go on although it takes over ten minutes or 4 GB.")
@click.option("--json", "as_json", is_flag=True, help="Print tuning.json on stdout.")
@quiet_option
def tune(
    case: Path,
    free: str | None,
    assignments: tuple[str, ...],
    parameters: Path | None,
    out: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Fit contact and scene parameters of an engine to the recordings, with 95 % intervals.

    CASE is a folder with rig.toml and CSV recordings, a CSV file, or a bundled case. Writes tuning.json, tuning.html
    and tuned.toml, which `run`, `diagnose` and pytest take with --parameters. Exit code 1: nothing was tuned, because
    nothing needs it (nothing_to_tune) or because no parameter helps (physics_missing); tuned.toml is not written then.

    \b
    Examples:
      harness tune my_rig/
      harness tune my_rig/ --engine pybullet --free lateral_friction_rail,rolling_friction
      harness tune my_rig/ --free friction=0.005:0.2,level_angle_rad=-0.01:0.01
      harness tune my_rig/ --set mujoco.time_step=2e-3 --diagnosis reports/my_rig/
    """
    from harness.api.outputs import report_folder, to_json
    from harness.api.tuning import REPORT, SETTINGS
    from harness.api.tuning import tune as fit
    from harness.engines.catalogue import read_settings
    from harness.recording import load_case
    from harness.recording.findings import warnings_of
    from harness.recording.rig_changes import with_rig_changes

    settings = read_settings(parameters, assignments)
    folder = out or report_folder(case)
    loaded = with_rig_changes(load_case(case), parameters)
    made = fit(
        loaded,
        free=None if free is None else [name for name in free.split(",") if name.strip()],
        settings=settings,
        out=folder,
        jobs=os.cpu_count() or 1,
        command=shlex.join(["harness", *sys.argv[1:]]),
        progress=not is_quiet(),
        **options,
    )
    if as_json:
        click.echo(to_json(made.content()))
    elif is_quiet():
        # The last sentence of an incomplete model says that physics is missing.
        warning = [] if made.tuned.selection.found.complete else made.sentences[-1:]
        click.echo("\n".join([*made.sentences[:1], *warning, f"report: {folder / REPORT}"]).replace("`", ""))
    else:
        click.echo(str(made.summary().text()))
        for one in warnings_of(loaded.findings):
            click.echo(f"  {one}")
        written = [f"settings: {folder / SETTINGS}"] if made.settings_text else []
        click.echo("\n".join(["", *written, f"report: {folder / REPORT}"]))
    for failed in made.failures:
        click.echo(f"error: {failed}", err=True)
    if made.failures:
        sys.exit(3)
    sys.exit(0 if made.settings_text else 1)
