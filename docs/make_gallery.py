"""docs/gallery.md and its pictures, taken of the pages that the commands on it write: `make gallery`.

Needs Chromium (Debian: chromium, chromium-driver). Takes some three minutes. Where anything fails, what is in
docs/gallery stays as it is.
"""

from __future__ import annotations

import base64
import io
import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from PIL import Image

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
FOLDER = HERE / "gallery"
ANSWERS = FOLDER / "answers.json"  # what the commands said, by entry: the numbers of the page and of README
WORK = ROOT / "build" / "gallery"
CASES = ROOT / "harness" / "data"
WIDTH, HEIGHT = 1100, 1000  # of a picture, the height at most [px]
COLOURS = 256  # of its palette; the reports have few, and text stays sharp
_MARGIN = 12  # below what ends a picture [px]
LARGEST = 150_000  # bytes


@dataclass(frozen=True)
class Entry:
    """A picture of the gallery.

    Attributes:
        name: of its file, without suffix.
        title: heading.
        data: `simulated` or `measured`, and of what.
        seen: what one sees.
        commands: that make the page.
        said: beginnings of the lines printed by the last command that the page quotes.
        page: below the folder in which the commands run.
        at: CSS selector of what the picture begins with; empty for the top of the page.
        to: of what it ends with.
    """

    name: str
    title: str
    data: str
    seen: str
    commands: tuple[str, ...]
    said: tuple[str, ...]
    page: str
    at: str = ""
    to: str = "main figure"


ENTRIES = (
    Entry(
        "comparison",
        "Which model follows the recording?",
        "Simulated data: the bundled recording of a virtual rig.",
        "All models and both engines, driven by the same angle, beside the recorded ball (black) and the error "
        "that a perfect model would have (grey). Every source leaves the recording: they lack physics, and the "
        "engines are not to blame, as they agree with the paper's model.",
        ("harness run paper_protocol --out comparison",),
        ("No source follows", "MuJoCo and PyBullet agree"),
        "comparison/report.html",
    ),
    Entry(
        "diagnosis_simulated",
        "What does the model lack? With a known truth",
        "Simulated data: a virtual rig with a rolling resistance of 0.004 and a level error of 4 mrad hidden in it.",
        "Both hidden effects are named, with their sizes. From the angle and the first two seconds (shaded), the "
        "model with the effects found (orange) predicts the rest; the declared model (blue) leaves the picture.",
        (
            "harness simulate --out virtual --hide rolling_resistance.coefficient=0.004 --hide level_error.angle=0.004",
            "harness diagnose virtual --out diagnosis_simulated",
        ),
        ("A level error", "A rolling resistance"),
        "diagnosis_simulated/diagnosis.html",
    ),
    Entry(
        "diagnosis_measured",
        "What does the model lack? On a measured rig",
        "Measured data: the bundled recording of Open Ball & Beam (T. Summers Lab, UT Dallas; MIT licence, "
        "Copyright (c) 2021 Benjamin Gravell).",
        "A rolling resistance and a lag of the beam behind its command explain most of the error (orange, beside "
        "the declared model in blue). The wide grey band is what the model with these effects expects itself to "
        "err in so long a prediction. What the effects stand for was never measured.",
        ("harness diagnose open_ball_beam --out diagnosis_measured",),
        ("A rolling resistance",),
        "diagnosis_measured/diagnosis.html",
    ),
    Entry(
        "sweep",
        "How small a step, which friction?",
        "Simulated data: the bundled recording of a virtual rig.",
        "Error against computing time of both engines at three time steps. Against the paper's model (above) "
        "smaller steps pay; against the recording (below) they change nothing, as missing physics outweighs them.",
        ("harness sweep sweep.toml --out sweep",),
        ("MuJoCo: ", "PyBullet: "),
        "sweep/sweep.html",
        "#work-precision",
        "#work-precision table",
    ),
    Entry(
        "notebook",
        "A result in a notebook",
        "Simulated data: the bundled recording of a virtual rig.",
        "A comparison as the last expression of a cell: answer, picture and table without a further call. This is "
        "the first of three [notebooks](notebooks.md).",
        ("jupyter nbconvert --to html --execute first_comparison.ipynb",),
        (),
        "first_comparison.html",
        '[id="cell-id=first-03"]',
        '[id="cell-id=first-03"] table',
    ),
)

HEAD = """# Gallery

What the commands write, as a browser shows it. Every page is one file that opens offline; its plots zoom, and a click
switches sources on and off ([reports.md](reports.md)). What a command says is quoted below its picture. `make gallery`
runs the commands, takes the pictures anew and writes this page.
"""


def quoted(one: Entry, output: str) -> list[str]:
    """The lines of an output that the page quotes.

    Raises:
        ValueError: there is none, so that the words of the page are no longer true.
    """
    lines = [line for line in output.splitlines() if one.said and line.startswith(one.said)]
    if one.said and not lines:
        raise ValueError(f"{one.name}: no line begins with {' or '.join(one.said)}; change its words")
    return lines


def text(answers: Mapping[str, Sequence[str]]) -> str:
    """The page, with what the commands said."""
    parts = [HEAD]
    for one in ENTRIES:
        commands = "\n".join(one.commands)
        picture = f"![{one.title}](gallery/{one.name}.png)"
        said = "\n>\n".join(f"> {line}" for line in answers[one.name])
        words = f"**{one.data}** {one.seen}\n" + (f"\n{said}\n" if said else "")
        parts.append(f"## {one.title}\n\n{picture}\n\n{words}\n```sh\n{commands}\n```\n")
    return "\n".join(parts)


def main() -> int:
    """Make pages, pictures and text; the exit code."""
    missing = [name for name in ("chromium", "chromedriver") if shutil.which(name) is None]
    if missing:
        print(f"{' and '.join(missing)} not found; install them (Debian: chromium, chromium-driver)", file=sys.stderr)
        return 2
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    # Copies under the names of the built-in cases: reports name the path of their case, which is then of no machine.
    for name in ("paper_protocol", "open_ball_beam"):
        shutil.copytree(CASES / name, WORK / name)
    shutil.copy(HERE / "examples" / "sweep.toml", WORK)
    shutil.copy(HERE / "notebooks" / "first_comparison.ipynb", WORK)
    answers = {}
    for one in ENTRIES:
        for command in one.commands:
            print(command, flush=True)
            program, *arguments = shlex.split(command)
            done = subprocess.run(
                [sys.executable, "-m", program, *arguments],
                cwd=WORK,
                capture_output=True,
                text=True,
                env=environment(),
            )
            if done.returncode:
                print(f"{command}: exit code {done.returncode}\n{done.stderr}", file=sys.stderr)
                return 3
        answers[one.name] = quoted(one, done.stdout)
    pictures = _pictures()
    for name, content in pictures.items():
        if len(content) > LARGEST:
            print(f"{name}: {len(content)} bytes, more than {LARGEST}; lower COLOURS or HEIGHT", file=sys.stderr)
            return 1
    FOLDER.mkdir(exist_ok=True)
    for name, content in pictures.items():
        (FOLDER / name).write_bytes(content)
        print(f"{FOLDER / name}: {len(content) / 1e3:.0f} kB")
    ANSWERS.write_text(json.dumps(answers, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    (HERE / "gallery.md").write_text(text(answers), encoding="utf-8")
    return 0


def environment() -> dict[str, str]:
    """That the commands run in: packages of this tree, from whatever folder."""
    path = os.pathsep.join(one for one in (str(ROOT), os.environ.get("PYTHONPATH", "")) if one)
    return os.environ | {"PYTHONPATH": path}


def _pictures() -> dict[str, bytes]:
    """PNG files by name."""
    return {f"{one.name}.png": small(photographed(WORK / one.page, HEIGHT, one.at, one.to)) for one in ENTRIES}


def photographed(page: Path, height: int, at: str = "", to: str = "main figure") -> bytes:
    """A part of a page, as a PNG.

    Args:
        page: HTML file.
        height: of the picture at most [px].
        at: CSS selector of what the picture begins with; empty for the top of the page.
        to: of what it ends with.

    Raises:
        selenium.common.exceptions.NoSuchElementException: the page has not where it begins or ends.
    """
    sys.path.insert(0, str(ROOT))  # before installed packages, some of which bring tests along
    from tests.report import browser

    edge = "const r = arguments[0].getBoundingClientRect(); return scrollY + r[arguments[1]]"
    with browser.chromium() as driver:
        metrics = {"width": WIDTH, "height": HEIGHT, "deviceScaleFactor": 1, "mobile": False}
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        driver.get(page.as_uri())
        browser.settle(driver)
        top = driver.execute_script(edge, driver.find_element("css selector", at), "top") if at else 0.0
        bottom = driver.execute_script(edge, driver.find_element("css selector", to), "bottom") + _MARGIN
        clip = {"x": 0, "y": top, "width": WIDTH, "height": min(bottom - top, height), "scale": 1}
        shot = driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True, "clip": clip})
    return base64.b64decode(shot["data"])


def small(picture: bytes) -> bytes:
    """The same compressed, with a palette where that does not do."""
    image = Image.open(io.BytesIO(picture)).convert("RGB")
    # By maximum coverage: the median cut would give the thin lines of the plots the colours of their neighbours.
    palette = partial(image.quantize, COLOURS, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    full = _png(image)
    return full if len(full) <= LARGEST else _png(palette())


def _png(image: Image.Image) -> bytes:
    buffer = io.BytesIO()
    image.save(buffer, format="PNG", optimize=True)
    return buffer.getvalue()


if __name__ == "__main__":
    sys.exit(main())
