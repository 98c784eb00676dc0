"""Results are written whole or not at all, and replace nothing but what the same command wrote earlier."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest

from harness.api.outputs import sealed_json
from harness.api.writing import all_or_nothing, hashes_of, settle
from harness.errors import InputError

ROOT = Path(__file__).parents[2]
RECORD = "record.json"


def write(folder: Path, *names: str, fail: bool = False) -> None:
    """Write files of these names through `all_or_nothing`, and break off after that if asked to."""
    with all_or_nothing(folder) as scratch:
        for name in names:
            (scratch / name).write_text("new")
        if fail:
            raise RuntimeError


def test_files_appear_together(tmp_path: Path) -> None:
    """Move files into place when all are written, and leave others alone."""
    (tmp_path / "mine.txt").write_text("kept")
    (tmp_path / "a.csv").write_text("old")
    with all_or_nothing(tmp_path, force=True) as scratch:
        (scratch / "a.csv").write_text("new")
        (scratch / "b.csv").write_text("new")
        assert (tmp_path / "a.csv").read_text() == "old"
    assert {file.name: file.read_text() for file in tmp_path.iterdir()} == {
        "mine.txt": "kept",
        "a.csv": "new",
        "b.csv": "new",
    }


def test_a_failure_leaves_nothing(tmp_path: Path) -> None:
    """Leave neither files nor folders that were made on the way when something goes wrong."""
    with pytest.raises(RuntimeError):
        write(tmp_path / "new" / "deep", "a.csv", fail=True)
    assert list(tmp_path.iterdir()) == []


def test_a_failure_keeps_what_was_there(tmp_path: Path) -> None:
    """Keep an earlier result whole when a later run fails."""
    (tmp_path / "a.csv").write_text("old")
    with pytest.raises(RuntimeError):
        write(tmp_path, "a.csv", fail=True)
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("a.csv", "old")]


@pytest.mark.parametrize("below", ["", "deeper"])
def test_a_file_in_the_way_is_named(tmp_path: Path, below: str) -> None:
    """Say so where the folder to write to is a file, or lies in one."""
    file = tmp_path / "taken"
    file.write_text("mine")
    with pytest.raises(InputError, match=r"taken.*choose another folder with --out"):
        write(file / below, "a.csv")
    assert file.read_text() == "mine"


def test_a_folder_in_the_way_of_a_file_is_named(tmp_path: Path) -> None:
    """Replace nothing where one of the files cannot be put."""
    (tmp_path / "b.csv").mkdir()
    with pytest.raises(InputError, match=r"b\.csv: is a folder"):
        write(tmp_path, "a.csv", "b.csv")
    assert [entry.name for entry in tmp_path.iterdir()] == ["b.csv"]


def write_with_record(
    folder: Path, text: str, *names: str, force: bool = False, supersede: bool = False, inputs: Sequence[Path] = ()
) -> None:
    """Write files of these names with a record of them, as a command does."""
    own = (*names, RECORD)
    with all_or_nothing(folder, record=RECORD, names=own, inputs=inputs, force=force, supersede=supersede) as scratch:
        for name in names:
            (scratch / name).write_text(text)
        (scratch / RECORD).write_text(sealed_json({"files": hashes_of(scratch)}))


def contents(folder: Path) -> dict[str, str]:
    """Text of every file but the record, by name."""
    return {file.name: file.read_text() for file in folder.iterdir() if file.name != RECORD}


def test_what_was_written_earlier_is_replaced(tmp_path: Path) -> None:
    """Replace the files of an earlier result, which its record names with their hashes."""
    write_with_record(tmp_path, "first", "a.csv", "b.csv")
    write_with_record(tmp_path, "second", "a.csv", "b.csv")
    assert contents(tmp_path) == {"a.csv": "second", "b.csv": "second"}


def test_what_a_superseded_result_had_besides_is_removed(tmp_path: Path) -> None:
    """Leave no file of an earlier result beside a new one that has none of that name, where that is asked for."""
    write_with_record(tmp_path, "first", "a.csv", "b.csv", "c.csv", "d.csv")
    (tmp_path / "c.csv").write_text("edited")
    (tmp_path / "mine.csv").write_text("mine")
    write_with_record(tmp_path, "second", "a.csv", supersede=True, inputs=[tmp_path / "d.csv"])
    assert contents(tmp_path) == {"a.csv": "second", "c.csv": "edited", "d.csv": "first", "mine.csv": "mine"}
    write_with_record(tmp_path, "third", "b.csv")
    assert contents(tmp_path)["a.csv"] == "second"


def test_a_file_of_the_users_is_not_replaced(tmp_path: Path) -> None:
    """Refuse before anything is computed to replace a file that no record names, unless that is insisted on."""
    (tmp_path / "a.csv").write_text("mine")
    with (
        pytest.raises(InputError, match=r"a\.csv: exists, and this command did not write it.*--force"),
        all_or_nothing(tmp_path, record=RECORD, names=["a.csv"]),
    ):
        pytest.fail("computed")
    assert contents(tmp_path) == {"a.csv": "mine"}
    write_with_record(tmp_path, "forced", "a.csv", force=True)
    assert contents(tmp_path) == {"a.csv": "forced"}


def test_an_edited_result_is_not_replaced(tmp_path: Path) -> None:
    """Refuse to replace a file of an earlier result that has been changed since, and leave all others as they are."""
    write_with_record(tmp_path, "first", "a.csv", "b.csv")
    (tmp_path / "b.csv").write_text("edited")
    with pytest.raises(InputError, match=r"b\.csv: exists.*changed since"):
        write_with_record(tmp_path, "second", "a.csv", "b.csv")
    assert contents(tmp_path) == {"a.csv": "first", "b.csv": "edited"}


def test_an_edited_record_proves_nothing(tmp_path: Path) -> None:
    """Refuse where the record itself has been changed, such as by the hash of a user's file."""
    write_with_record(tmp_path, "first", "a.csv")
    (tmp_path / "a.csv").write_text("mine")
    record = tmp_path / RECORD
    digest = hashes_of(tmp_path)["a.csv"]
    first = record.read_text()
    record.write_text(first.replace(first.split('"a.csv": "')[1][:64], digest))
    with pytest.raises(InputError, match="did not write it"):
        write_with_record(tmp_path, "second", "a.csv")


def test_a_file_that_appears_meanwhile_is_not_replaced(tmp_path: Path) -> None:
    """Refuse at the end what was not there at the beginning."""

    def overtaken() -> None:
        with all_or_nothing(tmp_path, record=RECORD, names=["a.csv"]) as scratch:
            (scratch / "a.csv").write_text("new")
            (tmp_path / "a.csv").write_text("mine")

    with pytest.raises(InputError, match=r"a\.csv: exists"):
        overtaken()
    assert contents(tmp_path) == {"a.csv": "mine"}


def test_an_input_is_never_replaced(tmp_path: Path) -> None:
    """Refuse to replace what the command reads, also by another name and also if that is insisted on."""
    (tmp_path / "input.csv").write_text("mine")
    (tmp_path / "link.csv").symlink_to(tmp_path / "input.csv")
    for name in ("input.csv", "link.csv"):
        with (
            pytest.raises(InputError, match="is an input of this command and is never overwritten"),
            all_or_nothing(tmp_path, names=[name], inputs=[tmp_path / "input.csv"], force=True),
        ):
            pytest.fail("computed")
    assert (tmp_path / "input.csv").read_text() == "mine"


def test_a_name_that_is_too_long_is_refused_first(tmp_path: Path) -> None:
    """Refuse before anything is computed a file that cannot be made."""
    with (
        pytest.raises(InputError, match=r"cannot be written .*too long"),
        all_or_nothing(tmp_path, names=["x" * 300]),
    ):
        pytest.fail("computed")
    with pytest.raises(InputError, match=r"cannot be written .*too long"), all_or_nothing(tmp_path / ("x" * 300)):
        pytest.fail("computed")


def test_a_result_that_cannot_be_moved_is_taken_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Restore what was there where the second of three files cannot be put into place."""
    write_with_record(tmp_path, "first", "a.csv", "b.csv")
    replace = Path.replace

    def refusing(file: Path, target: Path) -> Path:
        if file.name == "c.csv":
            raise PermissionError(1, "Operation not permitted", str(target))
        return replace(file, target)

    monkeypatch.setattr(Path, "replace", refusing)
    with pytest.raises(InputError, match=r"c\.csv: cannot be written"):
        write_with_record(tmp_path, "second", "a.csv", "aa.csv", "c.csv")
    monkeypatch.undo()
    assert contents(tmp_path) == {"a.csv": "first", "b.csv": "first"}
    unlink = Path.unlink

    def staying(file: Path) -> None:
        if file.parent == tmp_path:
            raise PermissionError(1, "Operation not permitted", str(file))
        unlink(file)

    monkeypatch.setattr(Path, "unlink", staying)
    with pytest.raises(InputError, match=r"b\.csv: cannot be written"):
        write_with_record(tmp_path, "second", "a.csv", supersede=True)
    monkeypatch.undo()
    assert contents(tmp_path) == {"a.csv": "first", "b.csv": "first"}
    write_with_record(tmp_path, "third", "a.csv")  # and its record is the first one again


WRITER = """
import os, signal, sys, time
from pathlib import Path
from harness.api.outputs import sealed_json
from harness.api.writing import all_or_nothing, hashes_of
folder, text, at = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
calls = 0
def killed(*_):
    global calls
    calls += 1
    if calls == at:
        os.kill(os.getpid(), signal.SIGKILL)
sys.addaudithook(lambda event, args: killed() if event in ("os.rename", "os.remove", "os.rmdir", "os.mkdir") else None)
with all_or_nothing(folder, record="record.json", supersede=True) as scratch:
    for name in ("a.csv", "b.csv", "c.csv"):
        (scratch / name).write_text(text)
    (scratch / "record.json").write_text(sealed_json({"files": hashes_of(scratch)}))
"""


def run_writer(folder: Path, text: str, at: int) -> int:
    """A process that writes three files and is killed at its change number `at` of the folder; its return code."""
    done = subprocess.run(
        [sys.executable, "-c", WRITER, str(folder), text, str(at)],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        check=False,
        capture_output=True,
    )
    return done.returncode


@pytest.mark.slow
def test_a_kill_at_any_change_leaves_one_result(tmp_path: Path) -> None:
    """Have after a kill at every step, once the folder is used again, all files of one result and nothing else."""
    seen = set()
    for at in range(1, 60):
        folder = tmp_path / str(at)
        write_with_record(folder, "old", "a.csv", "b.csv", "d.csv")
        code = run_writer(folder, "new", at)
        settle(folder)
        found = {file.name: file.read_text() for file in folder.glob("*.csv")}
        old, new = dict.fromkeys(("a.csv", "b.csv", "d.csv"), "old"), dict.fromkeys(("a.csv", "b.csv", "c.csv"), "new")
        assert found in (old, new), at
        seen |= set(found.values())
        # what was killed left nothing in the way
        write_with_record(folder, "newer", "a.csv", "b.csv", "c.csv", supersede=True)
        assert sorted(file.name for file in folder.iterdir()) == ["a.csv", "b.csv", "c.csv", RECORD]
        if code == 0:
            break
    assert code == 0
    assert seen == {"old", "new"}


@contextmanager
def writing(folder: Path, record: str = RECORD) -> Iterator[subprocess.Popen[bytes]]:
    """A process that is at work on a result of this folder."""
    script = (
        "import sys, time\nfrom pathlib import Path\nfrom harness.api.writing import all_or_nothing\n"
        "with all_or_nothing(Path(sys.argv[1]), record=sys.argv[2]):\n    print('.', flush=True)\n    time.sleep(60)\n"
    )
    command = [sys.executable, "-c", script, str(folder), record]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.read(1)
        try:
            yield process
        finally:
            process.kill()


def test_two_at_once_do_not_mix(tmp_path: Path) -> None:
    """Refuse a result that another process is at work on; let others be written beside it."""
    with writing(tmp_path):
        with pytest.raises(InputError, match="the same command is writing into it"):
            write_with_record(tmp_path, "new", "a.csv")
        with all_or_nothing(tmp_path, record="other.json") as scratch:
            (scratch / "b.csv").write_text("new")
        assert len(list(tmp_path.glob(".unfinished-*"))) == 1  # that of the living process


def test_leftovers_of_the_dead_are_removed(tmp_path: Path) -> None:
    """Remove what a killed process left unfinished, whatever it was for, and nothing of another name."""
    (tmp_path / ".unfinished-of my own").mkdir()
    with writing(tmp_path, "other.json") as process:
        process.send_signal(signal.SIGKILL)
        process.wait()
    assert len(list(tmp_path.glob(".unfinished-*"))) == 2
    write_with_record(tmp_path, "new", "a.csv")
    assert sorted(file.name for file in tmp_path.iterdir()) == [".unfinished-of my own", "a.csv", RECORD]


@pytest.mark.slow
def test_what_the_user_changed_after_a_kill_stays(tmp_path: Path) -> None:
    """Move nothing over a file that was changed between a kill and the next command, and name both."""
    for at in range(1, 60):
        folder = tmp_path / str(at)
        write_with_record(folder, "old", "a.csv", "b.csv", "c.csv")
        if run_writer(folder, "new", at) == 0:
            pytest.fail("never killed between two files")
        if len({file.read_text() for file in folder.glob("*.csv")}) == 2:
            break
    (folder / "c.csv").write_text("mine")
    with pytest.raises(InputError, match=r"c\.csv: was changed after a command was killed"):
        settle(folder)
    assert (folder / "c.csv").read_text() == "mine"
    (folder / "c.csv").unlink()
    settle(folder)
    assert {file.read_text() for file in folder.glob("*.csv")} == {"new"}
