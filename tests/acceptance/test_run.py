"""`harness run`: what a user gets when all is well."""

from __future__ import annotations

import csv
import hashlib
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from harness.recording.case import BUNDLED
from tests.acceptance.conftest import Harness, Outcome
from tests.acceptance.short import write_short_case
from tests.comparison.made import HIDDEN
from tests.shared_data import BUNDLED_RIG

FILES = {"report.html", "trajectories.csv", "metrics.csv", "manifest.json"}
COLUMNS = (
    "time_s,measured_m,cum_m,cum_linear_m,cam_m,friction_printed_m,friction_printed_dissipative_m,"
    "friction_coulomb_m,friction_viscous_m,mujoco_m,pybullet_m"
)
MODELS = [
    "cum",
    "cum_linear",
    "cam",
    *(f"friction_{x}" for x in ("printed", "printed_dissipative", "coulomb", "viscous")),
]


def table(file: Path) -> list[dict[str, str]]:
    """Rows of a CSV file."""
    with file.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_without_arguments_the_bundled_recording_is_compared(bundled_run: Outcome) -> None:
    """Write the four files below reports/, name the simulated origin, and exit with 0."""
    assert bundled_run.code == 0, bundled_run.err
    folder = bundled_run.folder / "reports" / "paper_protocol"
    assert {file.name for file in folder.iterdir()} == FILES
    assert bundled_run.errors == []
    assert "simulated" in bundled_run.out
    assert f"report: {Path('reports') / 'paper_protocol' / 'report.html'}" in bundled_run.out
    assert "horizon: whole" in bundled_run.out
    for source in (*MODELS, "mujoco", "pybullet"):
        assert f"\n{source} " in bundled_run.out


def test_trajectories_have_the_promised_columns(bundled_run: Outcome) -> None:
    """Write one column a source, in the promised order, on the recording's stamps."""
    file = bundled_run.folder / "reports" / "paper_protocol" / "trajectories.csv"
    assert file.read_text(encoding="utf-8").splitlines()[0] == COLUMNS
    rows, recorded = table(file), table(BUNDLED / "rec_01.csv")
    assert [float(row["time_s"]) for row in rows] == [float(row["time_s"]) for row in recorded]
    assert [row["measured_m"] and float(row["measured_m"]) for row in rows] == [
        row["ball_position_m"] and float(row["ball_position_m"]) for row in recorded
    ]
    values = {name: np.array([float(row[name]) for row in rows]) for name in COLUMNS.split(",")[2:]}
    assert all(np.isfinite(one).all() for one in values.values())
    assert {one[0] for one in values.values()} == {values["cam_m"][0]}  # all start alike
    for engine in ("mujoco_m", "pybullet_m"):
        # 14 s at 1 ms: both engines keep within 5 µm of CAM, and the file is rounded to 1 µm.
        np.testing.assert_allclose(values[engine], values["cam_m"], atol=6e-6)


def test_metrics_have_a_row_a_source_and_horizon(bundled_run: Outcome) -> None:
    """Score every source on the whole recording and on windows of 1, 2 and 5 s."""
    rows = table(bundled_run.folder / "reports" / "paper_protocol" / "metrics.csv")
    sources = {*MODELS, "mujoco", "pybullet"}
    assert {(row["source"], row["horizon"]) for row in rows} == {
        (source, horizon) for source in sources for horizon in ("whole", "1 s", "2 s", "5 s")
    }
    assert len(rows) == 4 * len(sources)
    assert all(float(row["rms_error_mm"]) > 0.0 for row in rows)


def test_manifest_names_inputs_and_versions(bundled_run: Outcome) -> None:
    """Record the hashes of what was read."""
    facts = json.loads((bundled_run.folder / "reports" / "paper_protocol" / "manifest.json").read_text("utf-8"))
    assert facts["inputs"] == {
        name: hashlib.sha256((BUNDLED / name).read_bytes()).hexdigest() for name in ("rec_01.csv", "rig.toml")
    }
    assert facts["command"] == "harness run"
    assert {"mujoco", "pybullet"} <= facts["versions"].keys()
    assert facts["failures"] == []


def test_the_report_opens_offline(bundled_run: Outcome) -> None:
    """Write one file that loads nothing from anywhere."""
    text = (bundled_run.folder / "reports" / "paper_protocol" / "report.html").read_text("utf-8")
    assert text.lstrip().lower().startswith("<!doctype html>")
    for word in ('src="http', "src='http", 'src="//', "<link", "@import", "url(http"):
        assert word not in text


@pytest.mark.slow
def test_json_is_all_there_is_on_stdout(process: Harness, tmp_path: Path) -> None:
    """Print JSON and nothing else on stdout, engines' greetings included."""
    case = write_short_case(tmp_path / "case")
    done = process("run", case, "--json", "--window", 1)
    assert done.code == 0, done.err
    answer = json.loads(done.out)
    assert Path(answer["report"]) == Path("reports") / "case" / "report.html"
    assert (done.folder / answer["report"]).exists()
    assert {score["source"] for score in answer["scores"]} == {*MODELS, "mujoco", "pybullet"}
    assert {claim["letter"] for claim in answer["claims"]} == {"a", "b", "c"}
    assert answer["failures"] == []


@pytest.mark.slow
def test_options_reach_the_run(harness: Harness, tmp_path: Path) -> None:
    """Take recording, engine, start, level angle, windows, settings and folder from the command line."""
    pytest.importorskip("dartpy", reason="the engine dart is optional", exc_type=ImportError)
    case = write_short_case(tmp_path / "case")
    (tmp_path / "contact.toml").write_text("[mujoco]\nfriction = 0.6\ntime_step = 1e-3\n", encoding="utf-8")
    done = harness(
        *("run", case, "--recording", "rec_02.csv", "--engine", "mujoco", "--engine", "dart"),
        *("--start", "0.35,0.02", "--level-angle=-0.16deg", "--window", 0.5, "--window", 1.5),
        *("--parameters", tmp_path / "contact.toml", "--set", "mujoco.time_step=2e-3", "--seed", 3, "--tube", 0.02),
        *("--out", tmp_path / "here", "--json"),
    )
    assert done.code == 0, done.err
    settings = json.loads((tmp_path / "here" / "manifest.json").read_text("utf-8"))["settings"]
    assert settings["recording"] == "rec_02.csv"
    assert settings["start"] == {"position": 0.35, "velocity": 0.02}
    assert settings["rig"]["level_angle"] == pytest.approx(np.radians(-0.16), rel=1e-12)
    assert settings["horizons"] == ["whole", "0.5 s", "1.5 s"]
    assert settings["tolerance_m"] == 0.02
    assert set(settings["engines"]) == {"mujoco", "dart"}
    assert (settings["engines"]["mujoco"]["friction"], settings["engines"]["mujoco"]["time_step"]) == (0.6, 2e-3)
    first = table(tmp_path / "here" / "trajectories.csv")[0]
    assert list(first) == [*COLUMNS.split(",")[:9], "mujoco_m", "dart_m"]
    assert float(first["cam_m"]) == 0.35


@pytest.mark.slow
def test_a_bare_recording_is_one_of_the_papers_rig(harness: Harness, tmp_path: Path) -> None:
    """Run a CSV file without any rig.toml, and say which rig is assumed."""
    shutil.copy(write_short_case(tmp_path / "case") / "rec_01.csv", tmp_path / "swing.csv")
    done = harness("run", tmp_path / "swing.csv", "--engine", "mujoco", "--level-angle", "estimate", "--json")
    assert done.code == 0, done.err
    answer = json.loads(done.out)
    assert any("the rig of the paper is assumed" in finding["text"] for finding in answer["findings"])
    facts = json.loads((done.folder / "reports" / "swing" / "manifest.json").read_text("utf-8"))
    assert list(facts["inputs"]) == ["swing.csv"]
    assert [one["name"] for one in facts["settings"]["estimates"]] == ["level angle α₀"]
    assert facts["settings"]["rig"]["eccentricity"] == 0.035


@pytest.mark.slow
def test_an_unknown_rig_is_estimated(harness: Harness, tmp_path: Path) -> None:
    """Run a rig of which only gravity is known, and print what was estimated."""
    case = write_short_case(tmp_path / "case", known=HIDDEN)
    done = harness("run", case, "--engine", "pybullet", "--window", 1)
    assert done.code == 0, done.err
    assert "rolling ratio K = 0.6" in done.out
    assert "level angle α₀ = " in done.out


@pytest.mark.slow
def test_the_same_input_gives_the_same_output(harness: Harness, tmp_path: Path) -> None:
    """Write the same tables twice, byte for byte."""
    case = write_short_case(tmp_path / "case")
    for name in ("one", "other"):
        assert harness("run", case, "--engine", "mujoco", "--window", 1, "--out", tmp_path / name).code == 0
    for file in ("trajectories.csv", "metrics.csv"):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "other" / file).read_bytes()


def test_help_lists_every_parameter(harness: Harness) -> None:
    """Show an example and every parameter of both engines with its default."""
    from harness.engines.catalogue import DEFAULT_ENGINES, describe, engine_of

    done = harness("run", "--help")
    assert done.code == 0
    assert "harness run my_rig/" in done.out
    for name in DEFAULT_ENGINES:
        for key, default, _ in describe(engine_of(name)):
            assert key in done.out
            assert f"[{default}]" in done.out


@pytest.mark.slow
@pytest.mark.parametrize("name", ["level", "rolling", "null_plain", "unlisted_wind", "backlash"])
def test_simulated_cases_run(harness: Harness, shared: Path, name: str) -> None:
    """Compare simulated cases of every kind."""
    done = harness("run", shared / "cases" / name)
    assert done.code == 0, done.err
    assert {file.name for file in (done.folder / "reports" / name).iterdir()} == FILES


@pytest.mark.slow
def test_the_bundled_real_recording_runs(harness: Harness) -> None:
    """Compare the measured recording that is a built-in case, by its name: files, windows, when the ball lifts off.

    Its angle is the commanded one, which jumps: a beam that followed it would throw the ball.
    """
    done = harness("run", BUNDLED_RIG.name, "--json")
    answer = json.loads(done.out)
    assert done.code == 0, done.err
    assert answer["failures"] == []
    assert {"cam", "mujoco", "pybullet"} <= set(answer["lift_off"])
    assert answer["headline"] in {"1 s", "2 s", "5 s"}
    assert {file.name for file in (done.folder / "reports" / BUNDLED_RIG.name).iterdir()} == FILES


@pytest.mark.slow
@pytest.mark.parametrize("name", ["daisy", "uts"])
def test_real_recordings_run(harness: Harness, shared: Path, name: str) -> None:
    """Compare real recordings of undocumented rigs: K estimated, engines run, judged by windows."""
    done = harness("run", shared / "recordings" / name, "--json")
    assert done.code == 0, done.err
    answer = json.loads(done.out)
    assert answer["headline"] in {"1 s", "2 s", "5 s"}
    facts = json.loads((done.folder / "reports" / name / "manifest.json").read_text("utf-8"))
    estimates = {one["name"]: one for one in facts["settings"]["estimates"]}
    # A solid ball rolls with K between a deep groove (0.3) and a plane (0.714), here within 3 standard errors.
    ratio = estimates["rolling ratio K"]
    assert 0.3 - 3 * ratio["std"] < ratio["value"] < 0.714 + 3 * ratio["std"]
    assert len(facts["inputs"]) == 1 + len(list((shared / "recordings" / name).glob("*.csv")))
