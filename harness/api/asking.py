"""What cannot be told from a file is asked, and becomes options of the command that imports it without questions."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from harness.errors import InputError
from harness.importing import Ambiguity, Choice, Options, SourceFile, Understood, understand

Ask = Callable[[Ambiguity], Choice]
_NO = "no "
"""Before an option that an answer takes back."""


def understood_with(
    ask: Ask | None, group: tuple[SourceFile, ...], options: Options
) -> tuple[Understood, tuple[str, ...], Options]:
    """The recording, what was asked and answered, as options of the command, and all options with the answers.

    An answer holds for this recording: the next one may have other names, units and signs.

    Raises:
        Ambiguity: nobody answers, or the same again.
        InputError: a file or a choice is impossible.
    """
    answers: dict[str, str] = {}
    before: tuple[Ambiguity, Choice, Options] | None = None  # the last question that was answered in writing
    while True:
        try:
            return understand(group, options), tuple(answers.values()), options
        except Ambiguity as ambiguity:
            question = ambiguity
        except InputError as error:
            if before is None or f"--{before[0].role}" not in str(error):
                raise
            asked, _, options = before
            question = Ambiguity(str(error), (), asked.advice, asked.role)
        if ask is None:
            raise question
        answer = ask(question)
        new = replace(options, **answer.options)
        if new == options or (before is not None and answer == before[1]):  # it would be asked for ever
            raise question
        before = None if question.choices else (question, answer, options)
        options = new
        answers[answer.typed.removeprefix(_NO).split()[0]] = answer.typed


def as_before(kept: Mapping[str, Any], ask: Ask | None, used: list[str]) -> Ask:
    """Answers that an earlier recording of the same case needed, where they are possible for this one; else `ask`.

    Args:
        kept: options with which it was imported.
        ask: answers the others; `None` if nobody does.
        used: is given what was answered so, as options of the command.
    """

    def answer(ambiguity: Ambiguity) -> Choice:
        said = _kept_choice(kept, ambiguity)
        if said is not None and said.typed not in used:
            used.append(said.typed)
            return said
        if ask is None:
            raise ambiguity
        return ask(ambiguity)

    return answer


def _kept_choice(kept: Mapping[str, Any], ambiguity: Ambiguity) -> Choice | None:
    """The choice that was made before: the same one, its column with a gain, or a text that the advice asks for."""
    for choice in ambiguity.choices:
        if choice.options and all(kept.get(name) == value for name, value in choice.options.items()):
            return choice
    for choice in ambiguity.choices:
        for name, value in choice.options.items():
            if isinstance(value, str) and str(kept.get(name, "")).startswith(f"{value}:"):
                return _typed(name, kept[name])
    for name in ("linkage", "rate"):
        if name in kept and f"--{name}" in str(ambiguity):
            return _typed(name, kept[name])
    return None


def _typed(name: str, value: Any) -> Choice:
    return Choice({name: value}, f"--{name} {shlex.quote(str(value))}", "as before")


def changed(answers: Sequence[str]) -> str:
    """What to add to a command, and what to leave out."""
    added = [one for one in answers if not one.startswith(_NO)]
    dropped = [one.removeprefix(_NO) for one in answers if one.startswith(_NO)]
    texts = [f"{what}: {' '.join(words)}" for what, words in (("add", added), ("leave out", dropped)) if words]
    return "; ".join(texts)


def repeated(command: str, files: Sequence[str], answered: Sequence[tuple[str, ...]]) -> str:
    """The command that imports the same again without questions; a remark where there is none for all files."""
    if len(set(answered)) == 1:
        words = command.split(" ")
        dropped = {one.removeprefix(_NO) for one in answered[0] if one.startswith(_NO)}
        kept = [one for one in words if one not in dropped]
        return " ".join((*kept, *(one for one in answered[0] if not one.startswith(_NO))))
    remarks = "; ".join(
        f"for {file} {changed(answers)}" for file, answers in zip(files, answered, strict=True) if answers
    )
    return f"{command} (answered {remarks})"
