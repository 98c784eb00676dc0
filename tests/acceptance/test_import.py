"""`harness import`: files of instruments and programs become cases in one command."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from rosbags.rosbag2 import StoragePlugin

from harness.cli.main import main
from harness.recording import load_case
from tests.importing import made
from tests.importing.test_ros import write_ros2


def call(*words: object) -> Result:
    """A command in this process."""
    return CliRunner().invoke(main, ["import", *map(str, words)])


def import_of(name: str, folder: Path, *more: object) -> Result:
    """Import one of the files of `made.FILES` with what its user has to say."""
    write, options = made.FILES[name]
    return call(write(folder / name), "--out", folder / "case", *options, *more)


@pytest.mark.slow
@pytest.mark.parametrize("name", made.FILES)
def test_a_file_becomes_a_case(tmp_path: Path, name: str) -> None:
    """Make a case in one command whose recording is the simulated one, in SI units."""
    done = import_of(name, tmp_path)
    assert done.exit_code == 0, done.stderr
    (one,) = load_case(tmp_path / "case").recordings.values()
    time, angle, position = made.truth()
    # Trigger in the middle: the first stamp of some is −6 s. Stamps are written to microseconds.
    np.testing.assert_allclose(one.time - one.time[0], time, atol=1.1e-6)
    # The coarsest files write the angle as 1e-4 V (2.5e-6 rad) or 1e-4 deg (0.9e-6 rad), rounded by half of that, and
    # the position as 1e-4 V (6.25e-6 m) or 1e-3 cm (5e-6 m).
    np.testing.assert_allclose(one.angle, angle, atol=2.6e-6)
    np.testing.assert_allclose(one.position, position, atol=6.3e-6)
    assert f"next: harness diagnose {tmp_path / 'case'}" in done.stdout
    assert "sign right" in done.stdout
    assert not [each for each in load_case(tmp_path / "case").findings if each.severity == "warning"]


def documented() -> list[list[str]]:
    """The commands of docs/import.md, as words behind `harness import`."""
    page = (Path(__file__).resolve().parents[2] / "docs" / "import.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```sh\n(.*?)```", page, re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines() if line.startswith("harness import")]
    return [shlex.split(line, comments=True)[2:] for line in lines]


@pytest.mark.slow
@pytest.mark.parametrize("words", documented(), ids=lambda words: words[0])
def test_the_documented_commands_work(tmp_path: Path, words: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Run every example of the page as it stands there, and get the simulated recording."""
    monkeypatch.chdir(tmp_path)
    for word in words:
        if word in made.FILES:
            made.FILES[word][0](tmp_path / word)
        elif word.endswith(".CSV"):
            made.tektronix_channel(tmp_path / word, int(word[-5]))
        elif word == "bag/":
            write_ros2(tmp_path / "bag", StoragePlugin.SQLITE3)
    done = call(*words, "--out", "case")
    assert done.exit_code == 0, done.stderr
    (one,) = load_case("case").recordings.values()
    if words[0] != "bag/":
        np.testing.assert_allclose(one.position, made.truth()[2], atol=6.3e-6)  # as above


def test_channels_in_files_of_their_own_are_joined(tmp_path: Path) -> None:
    """Make one recording of two files with a channel each."""
    files = [made.tektronix_channel(tmp_path / f"F0001CH{channel}.CSV", channel) for channel in (1, 2)]
    done = call(*files, "--join", "--out", tmp_path / "case", *made.SCOPE_OPTIONS)
    assert done.exit_code == 0, done.stderr
    (one,) = load_case(tmp_path / "case").recordings.values()
    np.testing.assert_allclose(one.position, made.truth()[2], atol=1e-6)  # 1e-5 V are 1.25e-6 m, halved by rounding


def test_a_voltage_needs_a_calibration(tmp_path: Path) -> None:
    """End with 2 and the option to give where an input of an oscilloscope is all that is known."""
    file = made.rigol(tmp_path / "rigol.csv")
    done = call(file, "--out", tmp_path / "case", "--angle", "CH1:0.05 rad/V", "--position", "CH2")
    assert done.exit_code == 2
    assert "--position 'CH2:0.125 m/Volt+0.01'" in done.stderr
    assert not (tmp_path / "case").exists()


def test_an_ambiguity_is_told_and_the_answer_works(tmp_path: Path) -> None:
    """End with 2 and options that, given as they are printed, make the case."""
    file = made.free_text(tmp_path / "free.txt")
    done = call(file, "--out", tmp_path / "case")
    assert done.exit_code == 2
    assert "Give --angle 'theta' (it is the beam's angle)" in done.stderr
    assert "--linkage" in done.stderr
    assert not (tmp_path / "case").exists()
    assert call(file, "--out", tmp_path / "case", "--angle", "theta").exit_code == 0


def test_the_angle_of_a_servo_is_asked_for_with_both_ways_to_the_beams(tmp_path: Path) -> None:
    """Name --linkage and the gain of a column; the gain, given as it is printed, makes the beam's angle."""
    time, angle, position = made.truth()
    rows = np.column_stack((time, np.degrees(angle) / 0.0625, position))
    file = tmp_path / "servo.csv"
    np.savetxt(file, rows, delimiter=",", header="time_s,servo (deg),x_m", comments="", fmt="%.9f")
    done = call(file, "--out", tmp_path / "case")
    assert done.exit_code == 2
    assert "--linkage r=RADIUS,L=LEVER" in done.stderr
    assert "COLUMN:GAIN UNIT/READING" in done.stderr
    (given,) = re.findall(r"such as --angle '([^']+)'", done.stderr.replace("\n", " "))
    assert given == "servo (deg):0.0625 deg/deg"
    assert call(file, "--out", tmp_path / "case", "--angle", given).exit_code == 0
    (one,) = load_case(tmp_path / "case").recordings.values()
    np.testing.assert_allclose(one.angle, angle, atol=1e-8)


def test_a_reversed_sign_is_asked_for_and_can_be_put_right(tmp_path: Path) -> None:
    """Refuse data whose ball runs against the angle; take either flip, or keep the signs if told so."""
    import pandas as pd

    time, angle, position = made.truth()
    file = tmp_path / "reversed.parquet"
    pd.DataFrame({"time_s": time, "angle_rad": -angle, "x_m": position}).to_parquet(file)
    done = call(file, "--out", tmp_path / "none")
    assert done.exit_code == 2
    assert "--flip-angle" in done.stderr
    assert "--flip-position" in done.stderr
    assert call(file, "--out", tmp_path / "a", "--flip-angle").exit_code == 0
    assert call(file, "--out", tmp_path / "b", "--flip-position").exit_code == 0
    kept = call(file, "--out", tmp_path / "c", "--keep-signs")
    assert kept.exit_code == 0
    assert "[angle-sign]" in kept.stdout
    loaded = {name: load_case(tmp_path / name).recordings["rec_01.csv"] for name in "abc"}
    np.testing.assert_allclose(loaded["a"].angle, angle, atol=1e-9)
    np.testing.assert_allclose(loaded["b"].position, -position, atol=1e-9)
    np.testing.assert_allclose(loaded["c"].angle, -angle, atol=1e-9)


def test_a_flip_too_many_is_told(tmp_path: Path) -> None:
    """Ask back where the user negates an angle whose sign was right."""
    done = import_of("log.lvm", tmp_path, "--flip-angle")
    assert done.exit_code == 2
    assert "no --flip-angle" in done.stderr


def test_recordings_are_added_and_what_the_user_wrote_stays(tmp_path: Path) -> None:
    """Append to a case whose rig.toml was edited, and leave its values and comments."""
    assert import_of("log.lvm", tmp_path).exit_code == 0
    rig = tmp_path / "case" / "rig.toml"
    rig.write_text(rig.read_text().replace("# mass_kg =", "mass_kg = 0.071  # weighed\n#"))
    done = call(made.vectors(tmp_path / "vectors.mat"), "--into", tmp_path / "case")
    assert done.exit_code == 0, done.stderr
    case = load_case(tmp_path / "case")
    assert case.identify == ("rec_01.csv", "rec_02.csv")
    assert case.rig.mass == 0.071
    assert "# weighed" in rig.read_text()
    assert "vectors.mat, MAT-file, version 5" in rig.read_text()
    record = json.loads((tmp_path / "case" / "import.json").read_text())
    assert [one["sources"][0]["name"] for one in record["recordings"]] == ["log.lvm", "vectors.mat"]


@pytest.mark.parametrize("name", ["tek.csv", "scope.mat", "free.txt"])
def test_what_was_told_of_one_recording_holds_for_the_next(tmp_path: Path, name: str) -> None:
    """Answer what a file leaves open as for the last recording of the case, say so, and write the options down."""
    assert import_of(name, tmp_path).exit_code == 0
    plain = call(tmp_path / name, "--into", tmp_path / "case", "--json")
    assert plain.exit_code == 0, plain.stderr
    done = call(tmp_path / name, "--into", tmp_path / "case")
    assert done.exit_code == 0, done.stderr
    options = made.FILES[name][1]
    (said,) = (one for one in done.stdout.splitlines() if "as the last recording of the case" in one)
    assert all(shlex.quote(one) in said for one in options)
    assert "without questions" not in done.stdout
    kept = json.loads((tmp_path / "case" / "import.json").read_text())["recordings"]
    assert json.loads(plain.stdout)["recordings"] == kept[1:2]
    told = dict(zip(options[::2], options[1::2], strict=True))
    assert [one["options"] for one in kept] == 3 * [{name[2:]: value for name, value in told.items()}]
    first, *others = (one.angle for one in load_case(tmp_path / "case").recordings.values())
    for other in others:
        np.testing.assert_array_equal(first, other)


def test_a_file_that_says_more_is_not_read_as_the_last_one(tmp_path: Path) -> None:
    """Take an angle by its own name where the last recording had to be told one."""
    assert import_of("tek.csv", tmp_path).exit_code == 0
    done = call(made.labview(tmp_path / "log.lvm"), "--into", tmp_path / "case")
    assert done.exit_code == 0, done.stderr
    assert "as the last recording" not in done.stdout


@pytest.mark.parametrize("table", [True, False])
def test_a_recording_is_added_to_be_held_out(tmp_path: Path, table: bool) -> None:
    """List it to predict and say so, also where rig.toml had no lists and all recordings were identified from."""
    assert import_of("log.lvm", tmp_path).exit_code == 0
    rig = tmp_path / "case" / "rig.toml"
    if not table:
        rig.write_text(rig.read_text().split("[recordings]")[0])
    done = call(made.vectors(tmp_path / "vectors.mat"), "--into", tmp_path / "case", "--as", "predict")
    assert done.exit_code == 0, done.stderr
    assert "rec_02.csv: to predict, held out from every fit" in done.stdout
    case = load_case(tmp_path / "case")
    assert (case.identify, case.predict) == (("rec_01.csv",), ("rec_02.csv",))


def test_a_new_case_has_a_recording_to_identify_from(tmp_path: Path) -> None:
    """Refuse to hold out all that a new case would have, and name --into."""
    done = import_of("log.lvm", tmp_path, "--as", "predict")
    assert done.exit_code == 2
    assert "add others to it with --into" in done.stderr
    assert not (tmp_path / "case").exists()


def test_several_files_become_several_recordings(tmp_path: Path) -> None:
    """Take each file for a recording of the same rig."""
    done = call(made.labview(tmp_path / "1.lvm"), made.vectors(tmp_path / "2.mat"), "--out", tmp_path / "case")
    assert done.exit_code == 0, done.stderr
    assert load_case(tmp_path / "case").identify == ("rec_01.csv", "rec_02.csv")


def test_the_rig_says_what_is_known_and_from_where(tmp_path: Path) -> None:
    """Write what was given, what was estimated, the file's hash and the linkage into rig.toml."""
    done = import_of("scope.mat", tmp_path, "--rig", "ball.mass_kg=0.064", "--origin", "simulated by Simulink")
    assert done.exit_code == 0, done.stderr
    case = load_case(tmp_path / "case")
    assert case.simulated
    assert case.rig.mass == 0.064
    assert case.rig.radius is None
    text = (tmp_path / "case" / "rig.toml").read_text()
    assert "# radius_m =" in text
    assert "position_resolution_m = 0.0001  # step of the position [m]; estimated from the data" in text
    assert "asin(0.05 sin θ / 0.4)" in text
    record = json.loads((tmp_path / "case" / "import.json").read_text())
    assert record["recordings"][0]["linkage"] == {"radius": 0.05, "length": 0.4, "offset": 0.0}
    assert record["recordings"][0]["sources"][0]["sha256"] in text


def test_nothing_foreign_is_replaced(tmp_path: Path) -> None:
    """Replace an earlier import, but not a rig.toml that was edited since, unless forced."""
    assert import_of("log.lvm", tmp_path).exit_code == 0
    assert import_of("log.lvm", tmp_path).exit_code == 0
    rig = tmp_path / "case" / "rig.toml"
    edited = rig.read_text() + "\n# mine\n"
    rig.write_text(edited)
    done = import_of("log.lvm", tmp_path)
    assert done.exit_code == 2
    assert rig.read_text() == edited
    assert import_of("log.lvm", tmp_path, "--force").exit_code == 0


def test_a_quiet_import_prints_where_the_case_is(tmp_path: Path) -> None:
    """Print a line, and write the evidence into import.json as ever."""
    done = import_of(next(iter(made.FILES)), tmp_path, "--quiet")
    assert done.exit_code == 0, done.stderr
    assert (done.stdout, done.stderr) == (f"case: {tmp_path / 'case'} (rec_01.csv)\n", "")
    assert (tmp_path / "case" / "import.json").is_file()


def test_json_for_machines(tmp_path: Path) -> None:
    """Print columns, units and evidence as JSON."""
    done = import_of("log.lvm", tmp_path, "--json")
    content = json.loads(done.stdout)
    assert [one["unit"] for one in content["recordings"][0]["columns"]] == ["s", "deg", "mm"]
    assert content["recordings"][0]["sign_checked"] is True


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--position", "Nothing"), "there is no column 'Nothing'"),
        (("--position", "Ball Position:furlong"), "'furlong' is no unit of the position"),
        (("--position", "Ball Position:3 m/"), "neither a unit nor a calibration"),
        (("--position", "Ball Position:3 m/V+2 cm"), "Write both in one unit"),
        (("--position", "Beam Angle:m"), "is given as angle and as position"),
        (("--linkage", "r=0.4,L=0.3"), "0 < r < L"),
        (("--linkage", "r=0.4"), "needs r and L"),
        (("--linkage", "r=0.4,K=3"), "'K=3' cannot be read"),
        (("--rig", "ball.mass=0.1"), "ball.mass_kg"),
        (("--rig", "ball"), "TABLE.KEY=VALUE"),
        (("--into", "nowhere"), "--out makes a new case"),
        (("--rate", "0"), "Invalid value for '--rate'"),
    ],
)
def test_bad_options_are_told(tmp_path: Path, options: tuple[str, ...], told: str) -> None:
    """End with 2 and one message that names the option, and write nothing."""
    done = import_of("log.lvm", tmp_path, *options)
    assert done.exit_code == 2
    assert told in " ".join(done.stderr.split())
    assert not (tmp_path / "case").exists()


def test_only_the_rows_of_a_state(tmp_path: Path) -> None:
    """Take the rows in which the controller ran, and say how many, in the case as well."""
    rows = (
        f"{t:.2f},{'RUN' if at >= 200 else 'WAIT'},{a:.6f},{s:.5f}"
        for at, (t, a, s) in enumerate(zip(*made.truth(), strict=True))
    )
    log = tmp_path / "log.csv"
    log.write_text("\n".join(("t_s,state,alpha_rad,x_m", *rows, "")))
    done = call(log, "--where", "state=RUN", "--out", tmp_path / "case")
    assert done.exit_code == 0, done.stderr
    assert f"{len(made.truth()[0]) - 200} of {len(made.truth()[0])} rows have state = RUN" in done.stdout
    assert load_case(tmp_path / "case").recordings["rec_01.csv"].time[0] == pytest.approx(2.0)
    assert "rows have state = RUN" in (tmp_path / "case" / "rig.toml").read_text(encoding="utf-8")
