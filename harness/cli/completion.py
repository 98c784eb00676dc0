"""`harness completion`: the script that completes commands, options and paths in a shell."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

SHELLS = ("bash", "zsh", "fish")
_VARIABLE = "_HARNESS_COMPLETE"


@click.command()
@click.argument("shell", type=click.Choice(SHELLS))
@click.pass_context
def completion(ctx: click.Context, shell: str) -> None:
    """Print the script that completes commands, options, bundled cases and paths in SHELL.

    \b
    Examples:
      harness completion bash  to append to ~/.bashrc
      harness completion zsh   to append to ~/.zshrc
      harness completion fish  to write into ~/.config/fish/completions/harness.fish
    """
    made = get_completion_class(shell)
    assert made is not None  # of click's own shells
    root = ctx.find_root()
    # `source` would run bash to look at its version, which need not be installed here.
    click.echo(made.source_template % made(root.command, {}, "harness", _VARIABLE).source_vars())
