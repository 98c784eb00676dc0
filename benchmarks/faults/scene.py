"""The commands that faults are put into, and whether what lies in their folder is whole."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from harness.api.writing import settle, sha256_of, written
from harness.simulator import Experiment, write_case

ROOT = Path(__file__).parents[2]
MINE = "mine.txt"  # a file of the user's in the folder that is written into
PATIENCE = 300.0  # for a command [s]; the longest takes a tenth of it
Content = dict[str, str]  # SHA-256 by name


@dataclass
class Scene:
    """A short case with a diagnosis, and a folder that commands write into.

    Attributes:
        folder: of everything.
        made: contents of whole results by command.
    """

    folder: Path
    made: dict[str, list[Content]] = field(default_factory=dict)

    @property
    def out(self) -> Path:
        """What commands write into."""
        return self.folder / "out"

    @property
    def inputs(self) -> tuple[Path, ...]:
        """What commands only read."""
        return (self.folder / "case", self.folder / "diagnosed")

    @staticmethod
    def of(folder: Path) -> Scene:
        """Simulate the case, and diagnose it."""
        scene = Scene(folder.resolve())
        friction = {"rolling_resistance": {"coefficient": 0.002}}
        write_case(scene.folder / "case", Experiment(declared=friction, duration=3.0, identify=1, predict=1))
        done = scene.run(["diagnose", "case", "--out", "diagnosed"])
        if done.returncode:
            raise RuntimeError(done.stderr)
        return scene

    def arguments(self, command: str, turn: int) -> list[str]:
        """What is typed; results of even and odd turns differ."""
        return {
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
            env={**os.environ, "PYTHONPATH": str(ROOT)},
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
            if done.returncode:
                raise RuntimeError(done.stderr)
            self.made.setdefault(command, []).append(self.content())
        return took, int(done.stderr.rsplit("operations: ", 1)[1])

    def content(self) -> Content:
        """What lies in the folder beside the user's file, without what a killed command left."""
        left = (".unfinished-", ".finished-")
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
        record = {"run": "manifest.json", "diagnose": "diagnosis.json"}.get(command)
        if record is not None and dict(written(self.out / record)) == now:
            return ""
        return f"neither the earlier result nor a new one: {', '.join(sorted(now)) or 'nothing'}"
