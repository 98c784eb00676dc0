"""Help that can be typed: every command has examples, and they name options that it has."""

from __future__ import annotations

import re
import shlex

import pytest
from click.testing import CliRunner

from harness.cli.main import main

COMMANDS = sorted(main.commands)


def examples(*words: str) -> list[list[str]]:
    """The example commands in a help text, as words without `harness`; what is aligned behind them is their comment."""
    shown = CliRunner().invoke(main, [*words, "--help"], prog_name="harness").stdout
    lines = [line.strip() for line in shown.splitlines() if line.startswith(" ")]
    return [shlex.split(re.split(r" {2,}", line)[0])[1:] for line in lines if line.startswith("harness ")]


@pytest.mark.parametrize("name", COMMANDS)
def test_examples_name_options_that_exist(name: str) -> None:
    """Show at least one example of the command, with as many arguments as it needs and with its own options."""
    command = main.commands[name]
    options = {text: param for param in command.params if param.param_type_name == "option" for text in param.opts}
    needed = [one for one in command.params if one.param_type_name == "argument"]
    shown = examples(name)
    assert shown
    for first, *words in shown:
        assert first == name
        given = [word for word in words if word.startswith("--")]
        assert set(given) <= set(options), words
        values = sum(not getattr(options[word], "is_flag", False) for word in given)
        arguments = len(words) - len(given) - values
        most = float("inf") if any(one.nargs == -1 for one in needed) else len(needed)
        assert sum(one.required for one in needed) <= arguments <= most, words


def test_the_first_help_shows_every_command_at_work() -> None:
    """Give an example of each command to a user who knows none of them."""
    assert {one[0] for one in examples()} == set(COMMANDS)


def test_help_tells_units_and_exit_codes() -> None:
    """Name the units of what is recorded and of every number that an option takes, and what the exit codes mean."""
    shown = CliRunner().invoke(main, ["--help"]).stdout
    for text in ("time [s]", "angle [rad or deg]", "position [m or mm]", "Exit codes: 0", "3 an engine failed"):
        assert text in " ".join(shown.split())
    told = " ".join(CliRunner().invoke(main, ["run", "--help"]).stdout.split())
    for text in ("position [m] and velocity [m/s]", "in rad, or as -0.16deg", "--window SECONDS", "--tube METRES"):
        assert text in told
