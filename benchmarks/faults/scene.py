"""The commands that faults are put into, and whether what lies in their folder is whole."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from harness.api.sweep import UNFINISHED
from harness.api.writing import settle, sha256_of, written
from harness.simulator import Experiment, write_case

ROOT = Path(__file__).parents[2]
MARK = "HARNESS_FAULTS"  # in the environment of all processes of a scene
MINE = "mine.txt"  # a file of the user's in the folder that is written into
PATIENCE = 300.0  # for a command [s]; the longest takes a tenth of it
_GRACE = 10.0  # for processes that the command has started, after its end [s]
ENDS = {"tune": 1}  # exit codes of whole results that are not 0: nothing of the case needs to be tuned
_RECORDS = {
    "run": "manifest.json",
    "diagnose": "diagnosis.json",
    "check": "check.json",
    "export": "export.json",
    "import": "import.json",
    "tune": "tuning.json",
    "sweep": "sweep.json",
}
_SWEEP = """\
cases = ["../case"]
sources = ["mujoco"]
window_s = 1.0
design = "grid"
time_step = [4e-3, 2e-3]

[mujoco]
friction = [0.3, {other}]
"""
Content = dict[str, str]  # SHA-256 by name


@dataclass
class Scene:
    """A short case with a diagnosis, and a folder that commands write into.

    Attributes:
        folder: of everything.
        made: contents of whole results by command.
        sizes: of the largest file of such a result by command [bytes].
    """

    folder: Path
    made: dict[str, list[Content]] = field(default_factory=dict)
    sizes: dict[str, int] = field(default_factory=dict)

    @property
    def out(self) -> Path:
        """What commands write into."""
        return self.folder / "out"

    @property
    def inputs(self) -> tuple[Path, ...]:
        """What commands only read."""
        return (self.folder / "case", self.folder / "diagnosed", self.folder / "specs")

    @staticmethod
    def of(folder: Path) -> Scene:
        """Simulate the case, and diagnose it."""
        scene = Scene(folder.resolve())
        friction = {"rolling_resistance": {"coefficient": 0.002}}
        write_case(scene.folder / "case", Experiment(declared=friction, duration=3.0, identify=1, predict=1))
        (scene.folder / "specs").mkdir()
        done = scene.run(["diagnose", "case", "--out", "diagnosed"])
        if done.returncode:
            raise RuntimeError(done.stderr)
        return scene

    def arguments(self, command: str, turn: int) -> list[str]:
        """What is typed; results of even and odd turns differ, those of sweeps in every turn.

        A sweep that was done before is only read again. Its spec of this turn is written.
        """
        if command == "sweep":
            spec = self.folder / "specs" / f"sweep_{turn}.toml"
            spec.write_text(_SWEEP.format(other=round(0.5 + 0.001 * turn, 6)), encoding="utf-8")
            return ["sweep", f"specs/{spec.name}", "--out", "out", "--jobs", "2", "--force"]
        recording = f"case/rec_0{1 + turn % 2}.csv"
        return {
            "check": ["check", ("case", "case/rec_01.csv")[turn % 2], "--out", "out"],
            "export": ["export", "diagnosed", "--to", "statespace", "--at", f"position=0.{turn % 2}", "--out", "out"],
            "import": ["import", recording, "--out", "out"],
            "tune": [
                *("tune", "case", "--out", "out", "--diagnosis", "diagnosed", "--free", "friction"),
                *("--set", f"mujoco.time_step={1 + turn % 2}e-3"),
            ],
            "run": ["run", "case", "--out", "out", "--engine", "mujoco", "--window", "1", "--seed", str(turn % 2)],
            "diagnose": ["diagnose", "case", "--out", "out"],
            "predict": ["predict", "diagnosed", "case/rec_02.csv", "--out", "out/predicted.csv"],
            "replay": ["replay", "diagnosed", "case"],
            "simulate": ["simulate", "--out", "out", "--duration", "2", "--seed", str(turn % 2), "--force"],
        }[command]

    def start(self, arguments: list[str], fault: str = "none") -> subprocess.Popen[str]:
        """Begin a command with a fault inside, and wait until Python has started."""
        begun = self.out.with_name(f"{self.out.name}.begun")
        begun.unlink(missing_ok=True)
        process = subprocess.Popen(
            [sys.executable, "-m", "benchmarks.faults.inside", fault, str(self.out), *arguments],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": str(ROOT), MARK: str(self.folder)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        while not begun.exists() and process.poll() is None:
            time.sleep(0.002)
        return process

    def run(
        self,
        arguments: list[str],
        fault: str = "none",
        meddle: Callable[[subprocess.Popen[str]], None] = lambda process: None,
    ) -> subprocess.CompletedProcess[str]:
        """Run a command with a fault inside, or one that `meddle` puts into its process."""
        process = self.start(arguments, fault)
        try:
            meddle(process)
            output, errors = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
        return subprocess.CompletedProcess(process.args, process.returncode, output, errors)

    def prepare(self, command: str) -> tuple[float, int]:
        """An empty folder with an earlier result; the time [s] and the number of file operations that one takes."""
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.mkdir()
        (self.out / MINE).write_text("mine", encoding="utf-8")
        for turn in (0, 1):
            begin = time.monotonic()
            done = self.run(self.arguments(command, turn), "count")
            took = time.monotonic() - begin
            if done.returncode != ENDS.get(command, 0):
                raise RuntimeError(done.stderr)
            self.made.setdefault(command, []).append(self.content())
        self.sizes[command] = max(one.stat().st_size for one in self.out.iterdir() if one.is_file())
        return took, int(done.stderr.rsplit("operations: ", 1)[1])

    def processes(self) -> list[str]:
        """Command lines of processes that commands have started, and that do not end by themselves."""
        end = time.monotonic() + _GRACE
        while (found := list(_marked(self.folder))) and time.monotonic() < end:
            time.sleep(0.05)
        return found

    def content(self) -> Content:
        """What lies in the folder beside the user's file, without what a killed command, or a sweep, left to go on."""
        left = (".unfinished-", ".finished-", UNFINISHED)
        return {
            one.name: sha256_of(one) for one in self.out.iterdir() if one.name != MINE and not one.name.startswith(left)
        }

    def hidden(self) -> list[str]:
        """What commands left that did not come to their end."""
        return [one.name for one in self.out.iterdir() if one.name.startswith((".unfinished-", ".finished-"))]

    def read(self) -> list[Content]:
        """What commands only read, to be compared with later."""
        return [{one.name: sha256_of(one) for one in folder.iterdir()} for folder in self.inputs]

    def wrong(self, command: str, before: Content) -> str:
        """What is lost or mixed, in words; empty if nothing is. Settles first, as every command does that reads.

        Args:
            before: what lay there before the fault.
        """
        settle(self.out)
        if not (self.out / MINE).exists() or (self.out / MINE).read_text(encoding="utf-8") != "mine":
            return "a file of the user's is lost"
        now = self.content()
        if now == before or now in self.made[command]:
            return ""
        record = _RECORDS.get(command)
        if record is not None and dict(written(self.out / record)) == now:
            return ""
        return f"neither the earlier result nor a new one: {', '.join(sorted(now)) or 'nothing'}"


def _marked(folder: Path) -> Iterator[str]:
    """Command lines of living processes with the scene's mark in their environment."""
    mark = f"{MARK}={folder}\0".encode()
    for one in Path("/proc").glob("[0-9]*"):
        try:
            if mark in (one / "environ").read_bytes():
                yield (one / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:  # it has ended, or is another user's
            continue
