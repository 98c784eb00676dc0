"""What cannot be told from a file is asked, and becomes options of the command that imports it without questions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from harness.errors import InputError
from harness.importing import Ambiguity, Choice, Options, SourceFile, Understood, understand

Ask = Callable[[Ambiguity], Choice]
_NO = "no "
"""Before an option that an answer takes back."""


def understood_with(
    ask: Ask | None, group: tuple[SourceFile, ...], options: Options
) -> tuple[Understood, tuple[str, ...]]:
    """The recording, and what was asked and answered, as options of the command.

    An answer holds for this recording: the next one may have other names, units and signs.

    Raises:
        Ambiguity: nobody answers, or the same again.
        InputError: a file or a choice is impossible.
    """
    answers: dict[str, str] = {}
    before: tuple[Ambiguity, Choice, Options] | None = None  # the last question that was answered in writing
    while True:
        try:
            return understand(group, options), tuple(answers.values())
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
