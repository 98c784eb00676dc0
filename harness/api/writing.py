"""Writing results: all files of a folder or none, and nothing replaced but what the same command wrote earlier.

What a command wrote is told by its *record*, one of its own files: JSON with the SHA-256 of every file (`files`) and of
itself (`sealed`). A file that is not in the record, or has been changed since, belongs to the user.

Files are written into `.unfinished-…` inside the folder, which stays locked as long as its process lives. Its name
becomes `.finished-…` in one step, and from then on the result counts: what is left to be moved into place after a kill
is moved by the next command that comes to the folder.
"""

from __future__ import annotations

import filecmp
import hashlib
import json
import os
import re
import shutil
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from harness.errors import InputError
from harness.provenance import seal_of

try:
    import fcntl
except ImportError:  # Windows: nothing is locked there, and what a killed command leaves stays
    fcntl = None  # type: ignore[assignment]

_PATIENCE = 10.0  # for another command that moves its files into place, which takes milliseconds [s]
_SCRATCH = re.compile(r"\.unfinished-([0-9a-f]{8}-)?[a-z0-9_]{8}")
_FINISHED = ".finished-"
# In a scratch folder: files to be moved into place, copies of those that they replace, and of those that are to go.
_NEW, _OLD, _GONE = "new", "old", "gone"


@contextmanager
def all_or_nothing(
    folder: Path,
    *,
    record: str = "",
    names: Iterable[str] = (),
    inputs: Iterable[Path] = (),
    force: bool = False,
    supersede: bool = False,
) -> Iterator[Path]:
    """A scratch folder whose files are moved into `folder` when the block ends well, and deleted when it does not.

    Files of other names that are already in `folder` stay. Folders that were made for nothing are removed again.

    Args:
        record: name of the command's record, one of the files to be written; none if it keeps none.
        names: files that will or may be written, so that what cannot be is refused before anything is computed.
        inputs: files that the command reads, which are never replaced.
        force: replace files that the command did not write, too.
        supersede: remove what the earlier result had and the new one has not, so that the folder never mixes two.

    Raises:
        InputError: the folder cannot be made or written, another command is writing the same files, or a file is in the
            way that the command did not write.
    """
    place = _Place(folder, record, tuple(inputs), force, supersede)
    made = [path for path in (folder, *folder.parents) if not _exists(path)]
    done = False
    scratch: Path | None = None
    held: int | None = None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with _locked(folder):
            _settle(folder)
            _remove_dead(folder, place.mark)
            scratch = Path(tempfile.mkdtemp(prefix=f".unfinished-{place.mark}-", dir=folder))
            held = _hold(scratch)
        for part in (_NEW, _OLD, _GONE):
            (scratch / part).mkdir()
        for name in names:
            place.check(name)
            (scratch / name).touch()  # a name may be too long
            (scratch / name).unlink()
        yield scratch / _NEW
        with _locked(folder):
            place.commit(scratch)
        done = True
    except OSError as error:
        where = error.filename or folder
        raise InputError(f"{where}: cannot be written ({error.strerror}); choose another folder with --out") from error
    finally:
        if scratch is not None:
            shutil.rmtree(scratch, ignore_errors=True)
        if held is not None:
            os.close(held)
        if not done:
            for path in made:
                with suppress(OSError):  # not made after all, or by now somebody else's
                    path.rmdir()


@dataclass(frozen=True)
class _Place:
    """A folder to write into; attributes as the arguments of `all_or_nothing`."""

    folder: Path
    record: str
    inputs: tuple[Path, ...]
    force: bool
    supersede: bool

    @property
    def mark(self) -> str:
        """Tells scratch folders of one record from those of others."""
        return hashlib.sha256(self.record.encode()).hexdigest()[:8]

    def check(self, name: str, new: Path | None = None) -> None:
        """Refuse to replace what is not the command's own.

        Args:
            new: what is to be written; replacing a file by the same content changes nothing.
        """
        target = self.folder / name
        if not os.path.lexists(target):
            return
        if target.is_dir():
            raise InputError(f"{target}: is a folder, and a file of this name is to be written; move it")
        if any(one.exists() and target.exists() and target.samefile(one) for one in self.inputs):
            raise InputError(f"{target}: is an input of this command and is never overwritten; choose another --out")
        if target.exists() and not target.is_file():
            raise InputError(f"{target}: is no regular file; choose another --out")
        if self.force or (new is not None and target.exists() and filecmp.cmp(target, new, shallow=False)):
            return
        if not target.exists() or written(self.folder / self.record).get(name) != sha256_of(target):
            raise InputError(
                f"{target}: exists, and this command did not write it, or it has been changed since; choose another "
                "--out, or replace it with --force"
            )

    def commit(self, scratch: Path) -> None:
        """Move all files into place; the folder is locked.

        Raises:
            InputError: one of them may not replace what is there.
            OSError: one of them cannot be moved; what was there is there again.
        """
        files = sorted((scratch / _NEW).iterdir())
        for file in files:
            self.check(file.name, file)
        for file in files:
            if os.path.lexists(target := self.folder / file.name):
                shutil.copy2(target, scratch / _OLD / file.name, follow_symlinks=False)
        for name in self._outdated([file.name for file in files]):
            shutil.copy2(self.folder / name, scratch / _GONE / name)
        finished = scratch.with_name(_FINISHED + scratch.name.rsplit("-", 1)[-1])
        scratch.rename(finished)  # from here on the result counts
        try:
            _move(finished, self.folder)
        except OSError:
            _take_back(finished, self.folder, [file.name for file in files])
            raise

    def _outdated(self, names: Sequence[str]) -> list[str]:
        """Files of the earlier result that nobody has changed and the new one, with these names, has not."""
        earlier = written(self.folder / self.record) if self.supersede else {}
        files = [(name, self.folder / name, digest) for name, digest in earlier.items() if name not in names]
        return [
            name
            for name, file, digest in files
            if file.is_file() and not file.is_symlink() and sha256_of(file) == digest
            if not any(one.exists() and file.samefile(one) for one in self.inputs)
        ]


def settle(folder: Path) -> None:
    """Finish what a killed command had begun to move into `folder`, if anything.

    Raises:
        InputError: it cannot be finished.
    """
    try:
        if any(folder.glob(f"{_FINISHED}*")):
            with _locked(folder):
                _settle(folder)
    except OSError as error:
        raise InputError(
            f"{folder}: a command was killed while it wrote here, and its files cannot be moved into place "
            f"({error.strerror}); repeat that command"
        ) from error


def written(record: Path) -> Mapping[str, str]:
    """SHA-256 by name of what a command wrote into a folder, its record included; nothing if that is not intact."""
    try:
        raw = record.read_bytes()
        content = json.loads(raw)
    except (OSError, ValueError, RecursionError):
        return {}
    if not isinstance(content, dict) or content.get("sealed") != seal_of(content):
        return {}
    files = content.get("files")
    return {**(files if isinstance(files, dict) else {}), record.name: hashlib.sha256(raw).hexdigest()}


def sha256_of(file: Path) -> str:
    """SHA-256 of a file's bytes (hexadecimal)."""
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def hashes_of(folder: Path) -> dict[str, str]:
    """SHA-256 of every file in a scratch folder, by name: `files` of a record."""
    return {file.name: sha256_of(file) for file in sorted(folder.iterdir())}


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:  # such as a name that is too long, which making it will tell
        return False


def _settle(folder: Path) -> None:
    """Move the rest of every finished result into place; the folder is locked, so that their commands are dead."""
    for finished in sorted(folder.glob(f"{_FINISHED}*")):
        for file in _waiting(finished):
            target, old = folder / file.name, finished / _OLD / file.name
            if target.exists() and not (old.exists() and filecmp.cmp(target, old, shallow=False)):
                raise InputError(
                    f"{target}: was changed after a command was killed that was to replace it by {file}; move one of "
                    "them away"
                )
        _move(finished, folder)


def _waiting(finished: Path) -> list[Path]:
    """Files of a finished result that are still to be moved into place."""
    return _files(finished / _NEW)


def _files(part: Path) -> list[Path]:
    """Files of a part of a scratch folder; none of one that another has removed, or that never had it."""
    return sorted(part.iterdir()) if part.is_dir() else []


def _move(finished: Path, folder: Path) -> None:
    """Move new files into place. An interrupt is put off: moving takes a millisecond."""
    interrupt: BaseException | None = None
    while True:
        try:
            for file in _waiting(finished):
                file.replace(folder / file.name)
            for copy in _files(finished / _GONE):
                target = folder / copy.name
                if target.is_file() and filecmp.cmp(target, copy, shallow=False):
                    target.unlink()
            shutil.rmtree(finished, ignore_errors=True)
            break
        except OSError:
            raise
        except BaseException as signal:
            if interrupt is not None:
                raise
            interrupt = signal
    if interrupt is not None:
        raise interrupt


def _take_back(finished: Path, folder: Path, names: Iterable[str]) -> None:
    """Undo `_move` as far as it went: what was there is there again."""
    for name in names:
        if (finished / _NEW / name).exists():
            continue
        if os.path.lexists(old := finished / _OLD / name):
            old.replace(folder / name)
        else:
            (folder / name).unlink()
    for copy in _files(finished / _GONE):
        if not os.path.lexists(folder / copy.name):
            copy.replace(folder / copy.name)
    shutil.rmtree(finished, ignore_errors=True)


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """`folder` to oneself, for the moments in which files are moved."""
    if fcntl is None:
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    begin = time.monotonic()
    try:
        while _lock(handle) is False:
            if time.monotonic() - begin > _PATIENCE:
                raise InputError(
                    f"{folder}: another command is writing into it; wait, or choose another place with --out"
                )
            time.sleep(0.02)
        yield
    finally:
        os.close(handle)


def _lock(handle: int) -> bool | None:
    """Whether the folder could be locked; `None` on a file system without locks.

    The system unlocks it when the handle is closed or its process ends.
    """
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True


def _hold(scratch: Path) -> int | None:
    """A handle that says that the process of this scratch folder lives."""
    if fcntl is None:
        return None
    handle = os.open(scratch, os.O_RDONLY)
    _lock(handle)
    return handle


def _remove_dead(folder: Path, mark: str) -> None:
    """Remove scratch folders whose process has ended.

    Raises:
        InputError: a living one is for the same files.
    """
    if fcntl is None:
        return
    for one in folder.glob(".unfinished-*"):
        if not _SCRATCH.fullmatch(one.name) or not one.is_dir():
            continue
        handle = os.open(one, os.O_RDONLY)
        try:
            dead = _lock(handle)
            if dead:
                shutil.rmtree(one, ignore_errors=True)
            elif dead is False and one.name.startswith(f".unfinished-{mark}-"):
                raise InputError(
                    f"{folder}: the same command is writing into it; wait until it has ended, or choose another place "
                    "with --out"
                )
        finally:
            os.close(handle)
