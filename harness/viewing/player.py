"""The clock of a viewer: pause, seek, speed, and which of the runs is shown."""

from __future__ import annotations

from dataclasses import dataclass, field

SEEK = 1.0  # by which the arrow keys move [s]
FASTER = 2.0  # by which the arrow keys change the speed


@dataclass
class Player:
    """Time and choices of a viewer.

    Attributes:
        begin, end: of what is shown [s].
        runs: how many runs there are.
        speed: recorded seconds a second.
        time: shown now [s].
        run: number of the run that is shown.
        paused: whether time stands still; at the end it does.
    """

    begin: float
    end: float
    runs: int = 1
    speed: float = 1.0
    time: float = field(init=False)
    run: int = field(init=False)
    paused: bool = False

    def __post_init__(self) -> None:
        """Begin at the beginning, with the last run: that with the effects found, if there is one."""
        self.time, self.run = self.begin, self.runs - 1

    def advance(self, seconds: float) -> None:
        """Let `seconds` pass on the user's clock."""
        if not self.paused:
            self.seek(self.speed * seconds)
            self.paused = self.time >= self.end

    def seek(self, seconds: float) -> None:
        """Go to a time that is `seconds` later, or earlier, within what is shown."""
        self.time = min(max(self.time + seconds, self.begin), self.end)

    def press(self, key: str) -> None:
        """Do what a key says: `space`, `left`, `right`, `up`, `down`, `home`, `enter`; others do nothing."""
        if key == "space":
            if self.paused and self.time >= self.end:
                self.time = self.begin
            self.paused = not self.paused
        elif key in ("left", "right"):
            self.seek(SEEK if key == "right" else -SEEK)
        elif key in ("up", "down"):
            self.speed *= FASTER if key == "up" else 1.0 / FASTER
        elif key == "home":
            self.time, self.paused = self.begin, False
        elif key == "enter":
            self.run = (self.run + 1) % self.runs


def keys_told(runs: int) -> list[tuple[str, str]]:
    """Every key and what it does, in words."""
    told = [
        ("space", "pause"),
        ("left, right", f"{SEEK:g} s back, on"),
        ("up, down", "faster, slower"),
        ("home", "from the beginning"),
    ]
    return told if runs == 1 else [*told, ("enter", "effects on, off")]
