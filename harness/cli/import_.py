"""`harness import`: recordings of other programs and instruments become a case."""

from __future__ import annotations

import re
import shlex
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.cli.options import FiniteRange, PathType, is_quiet, number_in, quiet_option
from harness.errors import InputError, printable

if TYPE_CHECKING:
    from harness.importing import Ambiguity, Choice


@click.command("import")
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=PathType())
@click.option("--out", type=PathType(), help="Folder of the new case [default: <name of the first FILE>_case].")
@click.option("--into", type=PathType(), metavar="CASE", help="Add the recordings to this case instead.")
@click.option(
    "--as",
    "role",
    type=click.Choice(["identify", "predict"]),
    default="identify",
    show_default=True,
    help="With --into: whether the recordings are to identify from, or held out from every fit, to predict.",
)
@click.option("--join", is_flag=True, help="The FILEs hold signals of one recording, such as a channel each.")
@click.option("--time", metavar="COLUMN[:UNIT]", help="Column of the time, such as T:ms.")
@click.option(
    "--angle",
    metavar="COLUMN[:UNIT]",
    help="Column of the beam's angle, such as Enc1:deg or 'CH1:2.5 deg/V-0.3' (gain and offset).",
)
@click.option(
    "--position",
    metavar="COLUMN[:UNIT]",
    help="Column of the ball's position, such as Dist:cm or 'CH2:0.125 m/V+0.01'; none if there is none.",
)
@click.option(
    "--rate", type=FiniteRange(min=0.0, min_open=True), metavar="HZ", help="Sampling rate, if no column holds the time."
)
@click.option(
    "--where",
    multiple=True,
    metavar="COLUMN=VALUE",
    help="Take only rows with this value, such as state=RUNNING; repeatable: one of the values of each column.",
)
@click.option(
    "--linkage",
    metavar="r=M,L=M[,offset=ANGLE]",
    help="The angle θ is a crank's, of radius r, on a beam with the lever L, in m: α = asin(r sin(θ + offset) / L); "
    "offset in rad, or as 5deg.",
)
@click.option("--flip-angle", is_flag=True, help="Negate the angle.")
@click.option("--flip-position", is_flag=True, help="Negate the position.")
@click.option("--keep-signs", is_flag=True, help="Leave the signs although the data contradict them.")
@click.option(
    "--rig",
    multiple=True,
    metavar="TABLE.KEY=VALUE",
    help="Known quantity of the rig in SI units, such as ball.mass_kg=0.064; repeatable.",
)
@click.option(
    "--origin", metavar="TEXT", help="Where the data come from; begin with 'simulated' if they were not measured."
)
@click.option(
    "--force", is_flag=True, help="Replace files that this command did not write, or that have been changed since."
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON on stdout, and ask nothing.")
@quiet_option
def import_(files: tuple[Path, ...], rig: tuple[str, ...], as_json: bool, **options: Any) -> None:
    """Make a case of recordings as they come, and show how they were understood.

    FILE is a MAT-file (Simulink's structure with time, timeseries or Dataset; timetables, vectors, matrices), a
    spreadsheet (.xlsx), Parquet, JSON, text of an oscilloscope, of LabVIEW (.lvm), of a serial port or of anything
    else with columns, or a ROS bag. Writes rec_01.csv …, a rig.toml whose comments say what is known, estimated or
    unknown, and import.json. What cannot be told from the file is asked on a terminal; elsewhere the command ends with
    exit code 2 and the options to give. See docs/import.md.

    \b
    Examples:
      harness import log.mat --linkage r=0.0254,L=0.425
      harness import scope.csv --angle "CH1:2.5 deg/V" --position "CH2:0.125 m/V+0.01"
      harness import trial_1.lvm trial_2.lvm --out my_rig/ --rig ball.mass_kg=0.064
      harness import trial_3.lvm --into my_rig/
      harness import trial_4.lvm --into my_rig/ --as predict
    """
    from harness.api.importing import import_recording
    from harness.api.outputs import to_json

    asks = not as_json and sys.stdin.isatty() and sys.stderr.isatty()
    made = import_recording(
        files,
        rig=_values(rig),
        ask=_ask if asks else None,
        command=shlex.join(["harness", *sys.argv[1:]]),
        **options,
    )
    if as_json:
        click.echo(to_json(made.record()))
        return
    shown = made.summary()
    if is_quiet():
        click.echo(shown.title)
        return
    click.echo(replace(shown, lines=()).text())
    click.echo("\n" + "\n".join(shown.lines))


def _ask(ambiguity: Ambiguity) -> Choice:
    """The user's answer on the terminal."""
    from harness.importing import Choice

    if not ambiguity.choices and not ambiguity.role:
        raise ambiguity
    click.echo(printable(ambiguity.question), err=True)
    if not ambiguity.choices:
        click.echo(printable(ambiguity.advice), err=True)
        text = _prompted(ambiguity, f"--{ambiguity.role}")
        return Choice({ambiguity.role: text}, f"--{ambiguity.role} {shlex.quote(text)}", "typed")
    for number, one in enumerate(ambiguity.choices, start=1):
        click.echo(f"  {number}: {printable(one.typed)}  ({printable(one.text)})", err=True)
    if ambiguity.advice:
        click.echo(f"  (or stop with 0: {printable(ambiguity.advice)})", err=True)
    answer = _prompted(ambiguity, "which", click.IntRange(0, len(ambiguity.choices)))
    if answer == 0:
        raise ambiguity
    return ambiguity.choices[answer - 1]


def _prompted(ambiguity: Ambiguity, text: str, type_: click.ParamType | None = None) -> Any:
    """What the user types; at the end of the input (Ctrl-D) the question is an error like any other."""
    try:
        return click.prompt(text, type=type_, err=True)
    except click.Abort as abort:
        click.echo(err=True)
        if isinstance(abort.__context__, EOFError):
            raise ambiguity from None
        raise KeyboardInterrupt from None


def _values(texts: Iterable[str]) -> dict[str, float]:
    made: dict[str, float] = {}
    for text in texts:
        found = re.fullmatch(r"\s*([\w.]+)\s*=\s*(\S+)\s*", text)
        try:
            value = number_in(found[2]) if found else None
        except ValueError:
            value = None
        if found is None or value is None:
            raise InputError(
                f"--rig '{text}' is not TABLE.KEY=VALUE with a number in SI units, as in ball.mass_kg=0.064."
            )
        made[found[1]] = value
    return made
