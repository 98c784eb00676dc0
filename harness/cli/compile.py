"""`harness compile`: compile the kernels once, so that the first command need not."""

from __future__ import annotations

import click

from harness.cli.options import is_quiet, quiet_option


@click.command("compile")
@click.option("--json", "as_json", is_flag=True, help="Print what was compiled, function by function, as JSON.")
@quiet_option
def compile_(as_json: bool) -> None:
    """Compile the kernels that the commands need, so that the first of them need not wait for it.

    `make setup` does so; do it again after a change of the sources, or to fill another cache, which NUMBA_CACHE_DIR
    names. It takes about two minutes, and some ten seconds where everything has been compiled before.

    \b
    Examples:
      harness compile
      harness compile --json
    """
    from harness.api.compilation import compile_kernels
    from harness.api.outputs import to_json

    made = compile_kernels(progress=not is_quiet())
    if as_json:
        click.echo(to_json(made.record()))
        return
    for part in () if is_quiet() else made.parts:
        compiling = f"{len(part.kernels)} functions compiled" if part.kernels else "everything compiled before"
        click.echo(f"{part.name:12} {part.seconds:5.1f} s  {compiling}")
    click.echo(f"{len(made.kernels)} functions compiled in {made.seconds:.0f} s; kept in {made.cache} and beside it")
