"""`harness doctor`: what is installed on this machine and works."""

from __future__ import annotations

import sys

import click


@click.command()
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON on stdout.")
def doctor(as_json: bool) -> None:
    """Examine this machine: versions, engines (each runs some steps), OpenGL, videos, cores, memory, caches, disk.

    Every line that is not ok says what to do. The exit code is 1 if something that is needed does not work, such as an
    engine that does not load; DART, what `harness view --video` needs and the extras of the package are optional.

    \b
    Examples:
      harness doctor
      harness doctor --json
    """
    from harness.api.doctor import doctor as examine
    from harness.api.outputs import to_json

    made = examine()
    if as_json:
        click.echo(to_json(made.record()))
    else:
        click.echo(made.sentence)
        width = max(len(one.name) for one in made.findings)
        for one in made.findings:
            told = f"{one.text}; {one.remedy}" if one.remedy else one.text
            click.echo(f"  {'ok' if one.ok else 'not ok':6}  {one.name:{width}}  {told}")
    sys.exit(0 if made.fit else 1)
