"""docs/tutorial.md: its commands are run, their outputs and pictures of the pages put in; minutes.

Needs Chromium (Debian: chromium, chromium-driver). Where a command fails, the page stays as it is.
"""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
from make_gallery import HEIGHT, environment, photographed, small

HERE = Path(__file__).resolve().parent
TEMPLATE, PAGE, FOLDER = HERE / "tutorial_template.md", HERE / "tutorial.md", HERE / "tutorial"
WORK = HERE.parent / "build" / "tutorial"
LOGS = ("log_1.csv", "log_2.csv", "log_3.csv")
PICTURES = {
    "check": "my_rig_check/check.html",
    "run": "reports/my_rig/report.html",
    "diagnosis": "reports/my_rig/diagnosis.html",
}
LONGEST = 46  # lines of an output that the page shows
_BLOCK = re.compile(r"```sh\n(.*?)```\n", re.DOTALL)


def commands(text: str) -> list[str]:
    """The commands of the page, in order."""
    return [line for block in _BLOCK.findall(text) for line in _joined(block)]


def _joined(block: str) -> list[str]:
    return [line for line in block.replace("\\\n", " ").splitlines() if line.strip()]


def ran(command: str, folder: Path) -> str:
    """What a command prints on stdout.

    Raises:
        SystemExit: it fails.
    """
    program, *arguments = shlex.split(command)
    done = subprocess.run(
        [sys.executable, "-m", program, *arguments], cwd=folder, capture_output=True, text=True, env=environment()
    )
    if done.returncode:
        raise SystemExit(f"{command}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def shown(output: str) -> str:
    """An output as a block, its middle left out where it is long."""
    lines = [line.rstrip() for line in output.strip("\n").splitlines()]
    if len(lines) > LONGEST:
        lines = [*lines[: LONGEST - 6], "⋮", *lines[-5:]]
    return "```text\n" + "\n".join(lines) + "\n```\n"


def write_logs() -> None:
    """The logs, as a data logger writes them, of a simulated rig: what is hidden in it stands on the page."""
    hidden = "--hide rolling_resistance.coefficient=0.004 --hide channel_delay.delay=0.02"
    ran(f"harness simulate --out virtual --seed 21 {hidden}", WORK)
    for number, name in enumerate(LOGS, start=1):
        read = pd.read_csv(WORK / "virtual" / f"rec_0{number}.csv", comment="#")
        columns = {
            "Time (ms)": (1e3 * read["time_s"]).round().astype(int),
            "Beam angle (deg)": np.degrees(read["beam_angle_rad"]).round(4),
            "Ball (cm)": (100.0 * read["ball_position_m"]).round(2),
        }
        pd.DataFrame(columns).to_csv(FOLDER / name, index=False)


def main() -> None:
    """Run the commands, write the page and its pictures."""
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    write_logs()
    for name in LOGS:
        shutil.copy(FOLDER / name, WORK)

    def with_outputs(block: re.Match[str]) -> str:
        print(block[1], end="", flush=True)
        printed = "".join(ran(command, WORK) for command in _joined(block[1]))
        return block[0] + ("\n" + shown(printed) if printed.strip() else "")

    text = _BLOCK.sub(with_outputs, TEMPLATE.read_text(encoding="utf-8"))
    for name, page in PICTURES.items():
        (FOLDER / f"{name}.png").write_bytes(small(photographed(WORK / page, HEIGHT)))
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
