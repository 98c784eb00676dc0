"""`harness export`: what a user gets in each format, and what is refused."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import harness as api
from harness.api.export import FORMATS, README, RECORD
from harness.errors import InputError
from harness.exports.model import LONGEST_STEP
from tests.acceptance.conftest import Harness
from tests.exports.exported import motion, ours

SEED = Path(__file__).parents[2] / "benchmarks" / "fuzz" / "seeds" / "diagnosis.json"


@pytest.fixture
def diagnosis(tmp_path: Path) -> Path:
    """A folder with a diagnosis that found a rolling resistance."""
    folder = tmp_path / "report"
    folder.mkdir()
    (folder / "diagnosis.json").write_bytes(SEED.read_bytes())
    return folder


@pytest.mark.parametrize("to", FORMATS)
def test_every_format_is_written_and_told(harness: Harness, diagnosis: Path, to: str) -> None:
    """Write all files, a README that names the effect, and the record; write the same again over it."""
    done = harness("export", diagnosis, "--to", to, "--json")
    assert done.code == 0, done.err
    told = json.loads(done.out)
    folder = diagnosis / f"export_{to}"
    assert {one.name for one in folder.iterdir()} == set(told["files"]) >= {README, RECORD}
    text = (folder / README).read_text(encoding="utf-8")
    assert "rolling_resistance: " in text
    assert ("NOT CARRIED" in text) == (not told["complete"])
    assert ("The beam reaches from " in text) == (to in ("mjcf", "urdf"))
    assert ("0.9 to 18 mm elsewhere" in " ".join(text.split())) == (to in ("c", "python"))
    before = {one.name: one.read_bytes() for one in folder.iterdir()}
    again = harness("export", diagnosis, "--to", to)
    assert again.code == 0, again.err
    assert before == {one.name: one.read_bytes() for one in folder.iterdir()}


def test_a_quiet_export_prints_where_the_files_are(harness: Harness, diagnosis: Path) -> None:
    """Print a line; what is not carried is said in the README as ever."""
    done = harness("export", diagnosis, "--to", "python", "--quiet")
    assert done.code == 0, done.err
    assert done.out.startswith(f"python: {diagnosis / 'export_python'} (")
    assert done.out.count("\n") == 1


def test_a_changed_file_is_not_replaced(harness: Harness, diagnosis: Path) -> None:
    """Exit with 2 where the user changed the source, and replace it with --force."""
    assert harness("export", diagnosis, "--to", "c").code == 0
    source = diagnosis / "export_c" / "ball_beam.c"
    source.write_text("mine", encoding="utf-8")
    done = harness("export", diagnosis, "--to", "c")
    assert done.code == 2
    assert "ball_beam.c: exists, and this command did not write it" in done.err
    assert source.read_text(encoding="utf-8") == "mine"
    assert harness("export", diagnosis, "--to", "c", "--force").code == 0
    assert source.read_text(encoding="utf-8") != "mine"


def test_a_folder_holds_one_format(harness: Harness, diagnosis: Path) -> None:
    """Refuse to write over an export to another format, and with --force leave nothing of it."""
    assert harness("export", diagnosis, "--to", "c", "--out", "out").code == 0
    done = harness("export", diagnosis, "--to", "python", "--out", "out")
    assert done.code == 2
    assert "out: holds an export to c, and one to python needs a folder of its own; choose another --out" in done.err
    assert harness("export", diagnosis, "--to", "c", "--out", "out").code == 0
    forced = harness("export", diagnosis, "--to", "python", "--out", "out", "--force", "--json")
    assert forced.code == 0
    assert {one.name for one in (forced.folder / "out").iterdir()} == set(json.loads(forced.out)["files"])


def test_an_unlisted_law_is_among_what_is_carried(harness: Harness, diagnosis: Path) -> None:
    """Tell on the terminal, in JSON and in export.json that a scene lacks a law that no catalogue lists."""
    file = diagnosis / "diagnosis.json"
    content = json.loads(file.read_text(encoding="utf-8"))
    model = content["model"]
    model["spline_term"] = {"depends": "time", "friction": False, "low": 0.0, "step": 1.0, "nodes": 4}
    model["parameters"] += [0.1, 0.2, 0.1, 0.0]
    count = len(model["parameters"])
    model["covariance"] = [[1e-6 * (i == j) for j in range(count)] for i in range(count)]
    file.write_text(json.dumps(content), encoding="utf-8")
    done = harness("export", diagnosis, "--to", "mjcf")
    assert "  NOT CARRIED spline of time: a law that no catalogue lists" in done.out
    told = json.loads(harness("export", diagnosis, "--to", "mjcf", "--json").out)
    kept = json.loads((diagnosis / "export_mjcf" / RECORD).read_text(encoding="utf-8"))
    assert not told["complete"]
    assert told["effects"] == kept["effects"]
    assert told["effects"][-1]["name"] == "spline of time"
    carried = json.loads(harness("export", diagnosis, "--to", "fmu", "--json").out)
    assert carried["complete"]
    assert "its t is the time of the recordings, from 0 to 3 s" in carried["effects"][-1]["how"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--to", "matlab"), "matlab"),
        (("--to", "c", "--fmi", "3"), "a version of FMI is for fmu, not for c"),
        (("--to", "statespace", "--at", "position=1e9,angle=0"), "it must lie on the beam"),
        (("--to", "statespace", "--at", "angle=5"), "it must lie within ± 90°"),
        (("--to", "c", "--pade", "2"), "are for statespace, not for c"),
        (("--to", "statespace", "--pade", "2"), "no Padé approximation: there is no delay"),
        (("--to", "statespace", "--at", "place=3"), "write position=0.1,angle=0"),
        (("--to", "statespace", "--at", "position=nan"), "not a finite number"),
    ],
)
def test_bad_use_is_one_message(harness: Harness, diagnosis: Path, options: tuple[str, ...], message: str) -> None:
    """Exit with 2, say what is wrong, write nothing."""
    done = harness("export", diagnosis, *options)
    assert done.code == 2
    assert message in done.err
    assert [one.name for one in diagnosis.iterdir()] == ["diagnosis.json"]


def test_missing_compiler_leaves_nothing(harness: Harness, diagnosis: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Exit with 2 where no FMU can be built, and write nothing."""
    monkeypatch.setenv("CC", "no_such_compiler")
    done = harness("export", diagnosis, "--to", "fmu")
    assert done.code == 2
    assert "no C compiler" in done.err
    assert [one.name for one in diagnosis.iterdir()] == ["diagnosis.json"]


def test_exported_source_runs_as_the_readme_says(diagnosis: Path, tmp_path: Path) -> None:
    """Run the Python and the compiled C on rows, and find the run of our own kernel with what was diagnosed."""
    kept = api.load_diagnosis(diagnosis)
    made = {to: api.export(kept, to, out=tmp_path / to) for to in ("c", "python")}  # type: ignore[arg-type]
    beam = motion()
    rows = np.column_stack((beam.time, beam.states))
    text = "\n".join(",".join(f"{one:.17g}" for one in row) for row in rows)
    program = tmp_path / "ball_beam"
    sources = [made["c"].folder / name for name in ("main.c", "ball_beam.c")]
    subprocess.run([os.environ.get("CC", "cc"), "-O2", "-o", program, *sources, "-lm"], check=True)
    expected = ours(made["c"].model.declared_rig, made["c"].model.acting, beam, 0.36)
    assert LONGEST_STEP >= 0.01
    for command in ([program], [sys.executable, made["python"].folder / "ball_beam.py"]):
        done = subprocess.run([*command, "0.36"], input=text, capture_output=True, text=True, check=True)
        told = [float(line.split(",")[1]) for line in done.stdout.splitlines()[1:]]
        np.testing.assert_allclose(told, expected, atol=1e-9)  # nine decimals are printed
        for wrong in ("1,2,3\n", "0,0\n0,0.1\n", ""):
            refused = subprocess.run([*command, "0.36"], input=wrong, capture_output=True, text=True, check=False)
            assert refused.returncode == 2
            assert refused.stderr.count("\n") == 1


def test_python_interface_refuses_what_there_is_not(diagnosis: Path) -> None:
    """Raise the project's error for a format or an FMI version that there is not."""
    with pytest.raises(InputError, match="no format 'matlab'"):
        api.export(diagnosis, "matlab")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="no FMI 1"):
        api.export(diagnosis, "fmu", fmi=1)  # type: ignore[arg-type]
