"""The files of a user's own scene: found, kept within the case's folder, checked to be plain XML, and hashed.

Engines read these files by themselves. What they would read is therefore followed here first: a file that includes
another, or a mesh, is refused unless that lies in the folder of the case, so that the hashes in a record cover all of
it. A document type, with which XML can name entities outside, is refused too.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path
from xml.etree.ElementTree import Element, ParseError, TreeBuilder, XMLParser

from analytic.naming import did_you_mean
from harness.errors import InputError
from harness.recording.scene_sizes import check_sizes
from harness.scene import Scene

# Attributes that name a file, in MJCF and in URDF; a cube's texture has six.
_DOORS = ("file", "filename", *(f"file{side}" for side in ("right", "left", "up", "down", "front", "back")))
_MESH_FOLDERS = {"mesh": "meshdir", "skin": "meshdir", "texture": "texturedir", "hfield": "meshdir"}
_MOST_FILES, _LARGEST = 1000, 512_000_000  # files of a scene; bytes of one


class _NoDocumentType(TreeBuilder):
    """Refuses a document type."""

    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:
        """Called by the parser for `<!DOCTYPE`."""
        raise _DocumentTypeError(name)


class _DocumentTypeError(Exception):
    pass


def scene_of(
    rig_file: Path,
    *,
    mjcf: str | None,
    urdf: str | None,
    ball_urdf: str | None,
    beam_joint: str,
    ball: str,
    direction: int,
    level_joint_angle: float,
    driven_joint: str | None,
) -> Scene:
    """The scene that a table `[scene]` describes; arguments as the attributes of `Scene`, files relative to the case.

    Raises:
        InputError: no file is named, one is missing or lies outside the folder of the case, or is no plain XML.
    """
    place, folder = f"{rig_file}: [scene]", rig_file.parent
    if mjcf is None and urdf is None:
        raise InputError(f'{place} names no scene. Write mjcf = "my_beam.xml" for MuJoCo, urdf = … for PyBullet.')
    if ball_urdf is not None and urdf is None:
        raise InputError(f"{place} has ball_urdf without urdf. Name the beam's file with urdf, or drop ball_urdf.")
    if driven_joint is not None and mjcf is None:
        raise InputError(
            f"{place} has driven_joint without mjcf. URDF has no closed loops, so that no crank can turn the beam in "
            "PyBullet; drop driven_joint, and the beam's joint is driven."
        )
    found: dict[str, Path] = {
        key: _inside(folder, folder, name, f"{place} {key}")
        for key, name in (("mjcf", mjcf), ("urdf", urdf), ("ball_urdf", ball_urdf))
        if name is not None
    }
    hashes: dict[str, str] = {}
    for file in found.values():
        _gather(folder, file, hashes)
    return Scene(
        folder=folder,
        mjcf=found.get("mjcf"),
        urdf=found.get("urdf"),
        ball_urdf=found.get("ball_urdf"),
        beam_joint=beam_joint,
        ball=ball,
        direction=direction,
        level_joint_angle=level_joint_angle,
        driven_joint=driven_joint,
        sha256=hashes,
    )


def _gather(folder: Path, main: Path, hashes: dict[str, str], above: frozenset[Path] = frozenset()) -> None:
    """Add the hashes of an XML file and of all that it names; `above` are the files whose part it is."""
    waiting, home = [main], main.parent
    above |= {main.resolve()}
    settings: dict[str, str] = {}
    named: list[tuple[Path, Element, str]] = []
    while waiting:
        file = waiting.pop()
        if _add(folder, file, hashes):
            for element, text in _references(file):
                if element.tag == "compiler":
                    settings |= element.attrib
                elif element.tag == "include":
                    waiting.append(_inside(folder, home, text, f"{file}: <include>"))
                elif element.tag == "model":  # a model of its own, with its own settings
                    model = _inside(folder, home, text, f"{file}: <model>")
                    if model.resolve() in above:
                        raise InputError(f"{file}: <model> names '{text}', which this file is part of. Delete it.")
                    _gather(folder, model, hashes, above)
                else:
                    named.append((file, element, text))
    for file, element, text in named:
        below = settings.get(_MESH_FOLDERS.get(element.tag, ""), settings.get("assetdir", ""))
        text = Path(text).name if settings.get("strippath") == "true" else text
        name = text if "://" in text else str(Path(below, text))
        _add(folder, _inside(folder, home, name, f"{file}: <{element.tag}>"), hashes)


def _references(file: Path) -> Iterator[tuple[Element, str]]:
    """Elements that name a file, with its name, and MJCF's settings of where files are."""
    parser = XMLParser(target=_NoDocumentType())
    try:
        parser.feed(file.read_bytes())
        root = parser.close()
    except _DocumentTypeError:
        raise InputError(
            f"{file}: has a document type (<!DOCTYPE …>), which can name files outside. Delete it."
        ) from None
    except ParseError as error:
        raise InputError(f"{file}: not valid XML: {error}. Correct the file.") from None
    except (LookupError, ValueError) as error:  # of an encoding in its first line
        raise InputError(f"{file}: cannot be read as XML ({error}). Save it as UTF-8.") from None
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror}). Check its permissions.") from None
    for element in root.iter():
        check_sizes(file, element)
        if element.tag == "compiler":
            yield element, ""
        for door in _DOORS:
            if element.get(door):
                yield element, element.attrib[door]


def _add(folder: Path, file: Path, hashes: dict[str, str]) -> bool:
    """Hash a file; whether it is new."""
    name = file.relative_to(folder).as_posix()
    if name in hashes:
        return False
    if len(hashes) >= _MOST_FILES or file.stat().st_size > _LARGEST:
        raise InputError(f"{file}: too large a scene ({_MOST_FILES} files, {_LARGEST // 1_000_000} MB each at most).")
    try:
        hashes[name] = hashlib.sha256(file.read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror}). Check its permissions.") from None
    return True


def _inside(folder: Path, home: Path, name: str, place: str) -> Path:
    """The file that `name` means beside `home`, which has to lie in the folder of the case."""
    if "://" in name and not name.startswith("file://"):
        raise InputError(f"{place} names {name!r}. Name the file by its path relative to {home}; it is not looked for.")
    path = home / name.removeprefix("file://")
    try:
        missing, outside = not path.is_file(), not path.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError):  # a name that no file can have
        missing, outside = True, False
    if outside:
        raise InputError(f"{place} names {name!r}, outside {folder}. Put the file into the folder of the case.")
    if missing:
        near = path.parent.iterdir() if path.parent.is_dir() else ()
        hint = did_you_mean(path.name, [one.name for one in near])
        raise InputError(f"{place} names {name!r}, and there is no file {path}.{hint} Correct the name.")
    return Path(folder, path.resolve().relative_to(folder.resolve()))
