"""Errors for the user; each message names fault, place and remedy."""


def printable(text: str) -> str:
    """The text in one line: what a terminal would take for a command or a line's end is escaped.

    Messages quote what users give, which may hold any character.
    """
    return "".join(one if one.isprintable() or one in "\u00a0\u202f" else ascii(one)[1:-1] for one in text)


class HarnessError(Exception):
    """Base of all errors meant for the user; `exit_code` is what the command returns."""

    exit_code = 2

    def __str__(self) -> str:
        """One line."""
        return printable(super().__str__())


class InputError(HarnessError):
    """Bad use or bad input: a file, a value or a name that cannot be worked with (exit code 2)."""

    exit_code = 2


class WorthlessInput(HarnessError):
    """Input that was read, but contradicts physics so that a verdict on it would be worthless (exit code 1)."""

    exit_code = 1


class EngineFailure(HarnessError):
    """A physics engine gave no trustworthy trajectory (exit code 3).

    Attributes:
        engine: name of the engine.
        failure: what went wrong, one of the values of `harness.engines.health.Failure`.
        time: when, in the recording's time [s].
    """

    exit_code = 3

    def __init__(self, engine: str, failure: object, time: float, detail: str) -> None:
        self.engine = engine
        self.failure = failure
        self.time = time
        self._detail = detail
        super().__init__(f"{engine} failed at t = {time:.3f} s: {detail}")

    @property
    def of_the_rig(self) -> bool:
        """Whether the models say the same at that instant, so that no engine is to blame."""
        return bool(getattr(self.failure, "of_the_rig", False))

    @property
    def reason(self) -> str:
        """What went wrong, without engine and time."""
        return self._detail

    def __reduce__(self) -> tuple[type, tuple[object, ...]]:
        """Its own arguments: those of an exception are its text, from which no process could make it again."""
        return type(self), (self.engine, self.failure, self.time, self._detail)


class Terminated(BaseException):
    """SIGTERM came."""


INTERRUPTS = (KeyboardInterrupt, Terminated)
"""What a signal raises; no handler of somebody else's errors may take it for one of these."""
