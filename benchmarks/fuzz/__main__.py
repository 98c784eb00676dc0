"""`python -m benchmarks.fuzz`: change good inputs for some minutes, see that each has a result or one message.

Coverage-guided by atheris where that is installed (`pip install atheris`, Linux): hypothesis makes inputs from its
bytes, so that both know the structure of a file. Without it hypothesis draws them at random. Stops at the first input
that breaks the property, shrunk by hypothesis where it is alone, and ends with exit code 1.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import time
from collections import Counter

import click
from hypothesis import Phase

from benchmarks.fuzz.doors import Broken
from benchmarks.fuzz.guided import counts_file
from benchmarks.fuzz.properties import INPUTS, property_of, table_row

_ROUND = 20  # inputs between two looks at the clock


@click.command()
@click.option("--seconds", type=click.IntRange(min=1), default=600, show_default=True, help="For all inputs together.")
@click.option("--input", "kinds", multiple=True, type=click.Choice(INPUTS), help="Repeatable [default: all].")
@click.option("--guided/--random", default=None, help="With atheris or without [default: with, if it is installed].")
def run(seconds: int, kinds: tuple[str, ...], guided: bool | None) -> None:
    """Fuzz every kind of input for its share of the time; exit code 1 where one breaks the property."""
    kinds = kinds or INPUTS
    guided = importlib.util.find_spec("atheris") is not None if guided is None else guided
    share = max(1, seconds // len(kinds))
    broken = []
    for kind in kinds:
        if guided:  # libFuzzer ends the process that it runs in
            words = [sys.executable, "-m", "benchmarks.fuzz.guided", kind, str(share)]
            counts_file(kind).unlink(missing_ok=True)
            failed = subprocess.run(words, check=False).returncode != 0
            if counts_file(kind).exists():
                click.echo(counts_file(kind).read_text(encoding="utf-8"))
        else:
            failed = not _at_random(kind, share)
        broken += [kind] if failed else []
    click.echo(f"broken: {', '.join(broken)}" if broken else f"nothing broken in {seconds} s")
    sys.exit(1 if broken else 0)


def _at_random(kind: str, seconds: float) -> bool:
    """Whether the property holds for this long."""
    seen: Counter[str] = Counter()
    end = time.monotonic() + seconds
    phases = (Phase.generate, Phase.shrink)
    try:
        while time.monotonic() < end:
            property_of(kind, seen, max_examples=_ROUND, phases=phases, database=None)()
    except (Broken, BaseExceptionGroup) as error:
        notes = "\n".join(getattr(error, "__notes__", ()))
        click.echo(f"{kind}: {error}\n{notes}", err=True)
        return False
    finally:
        click.echo(table_row(kind, seen))
    return True


if __name__ == "__main__":
    run()
