"""One file a format, one registry: the suffix or the first bytes of a file say how it is read and written."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any

from motion.clip import Clip, Duet
from motion.errors import InputError

from .bvh import bvh_bytes, read_bvh
from .c3d_points import read_c3d
from .files import MAX_BYTES, ZIP_ERRORS, read_bytes
from .glb_motion import read_glb
from .glb_writer import glb_bytes
from .kinect import read_kinect
from .markers import read_trc
from .npz import npy_bytes, npz_bytes, read_npy, read_npz
from .recording import ImportChoices, Recording
from .smpl import as_adults, smpl_bytes
from .usd import usd_bytes

RIG_FPS = 30.0
"""Frames a second onto which rigs are brought."""
GLBS = (".glb", ".vrm", ".vrma")
"""Suffixes of glTF binary files: VRM's characters and animations are such."""
RIGS = (".bvh", *GLBS)
"""Suffixes of files that hold rigs of any kind."""


@dataclass(frozen=True)
class Format:
    """One kind of file.

    Attributes:
        suffix: with its dot, lower case.
        reader: gives what a file's bytes hold, by its name in messages and what is known of it; ``None`` where it is
            only written.
        writer: gives the bytes of a file of two people, or of one; ``None`` where it is only read.
        alone: it also writes one person.
        apart: gives the people of two files, NAME_a and NAME_b, that share one world; ``None`` where both are in one.
    """

    suffix: str
    reader: Callable[[bytes, str, ImportChoices], Recording] | None = None
    writer: Callable[[Any], bytes] | None = None
    alone: bool = False
    apart: Callable[[Duet], tuple[Clip, Clip]] | None = None


def _rigs(data: bytes, label: str, choices: ImportChoices) -> Recording:
    if data[:4] == b"glTF" or Path(label).suffix.lower() in GLBS:
        people, animations = read_glb(data, name=label, animation=choices.animation)
        if choices.fps:
            people = tuple(replace(rig, fps=choices.fps / rig.every) for rig in people)
        if animations.note:
            people = tuple(replace(rig, notes=(animations.note,)) for rig in people)
        return Recording(people, animations=animations)
    return Recording(read_bvh(data, name=label, fps=RIG_FPS, file_fps=choices.fps))


FORMATS: dict[str, Format] = {
    f.suffix: f
    for f in (
        Format(".npz", read_npz, npz_bytes, alone=True),
        Format(".bvh", _rigs, bvh_bytes, alone=True, apart=lambda duet: duet.people),
        Format(".npy", read_npy, npy_bytes, alone=True),
        Format(".skeleton", read_kinect),
        Format(".txt", read_kinect),
        Format(".glb", _rigs, glb_bytes),
        Format(".vrm", _rigs),
        Format(".vrma", _rigs),
        Format(".usda", None, usd_bytes),
        Format(".smpl.npz", None, smpl_bytes, alone=True, apart=as_adults),
        Format(".trc", read_trc),
        Format(".c3d", read_c3d),
        Format(".zip", lambda *_: Recording(())),
    )
}
READABLE = [f.suffix for f in FORMATS.values() if f.reader]
ALONE = tuple(f.suffix for f in FORMATS.values() if f.alone)
"""Suffixes of files that hold one person, without a second."""


def recordings(source: str | Path | bytes, name: str | None, choices: ImportChoices) -> tuple[list[Recording], str]:
    """Reads a file, or the two files of an archive; also gives what to call it.

    Raises:
        InputError: one sentence saying what is wrong with the file.
    """
    label = Path(name or str(source)).name if name or not isinstance(source, bytes) else ""
    sources: Sequence[tuple[str | Path | bytes, str | None]] = [(source, name)]
    if Path(label).suffix.lower() == ".zip":
        sources = _in_zip(source, name)
    return [_recording(*each, choices) for each in sources], label


def _recording(source: str | Path | bytes, name: str | None, choices: ImportChoices) -> Recording:
    label = name or ("" if isinstance(source, bytes) else Path(source).name)
    suffix = Path(label).suffix.lower()
    known = FORMATS.get(suffix)
    if known is None or known.reader is None:
        raise InputError(unknown(suffix, "read", READABLE))
    if choices.animation is not None and suffix not in GLBS:
        raise InputError(
            f"{Path(label).name} is not a .glb file and has no animations to choose from: leave the choice out."
        )
    remedy = "reduce its mesh or leave out its pictures" if suffix in GLBS else "cut the motion or lower its frame rate"
    data, label = read_bytes(source, name and Path(name).name, remedy=remedy)
    try:
        return known.reader(data, label, choices)
    except InputError as error:
        raise error if label in str(error) else InputError(f"{label}: {error}") from None


def suffix_of(path: str | Path) -> str:
    """The suffix by which a path's format is known, lower case: ".smpl.npz" is one, ".tar.gz" is none."""
    name = Path(path).name.lower()
    known = [suffix for suffix in FORMATS if name.endswith(suffix)]
    return max(known, key=len, default=Path(name).suffix)


def with_stem(path: Path, added: str) -> Path:
    """The path with something added to its name before its suffix."""
    suffix = suffix_of(path)
    return path.with_name(f"{path.name[: len(path.name) - len(suffix)]}{added}{path.name[-len(suffix) :]}")


def can_write(suffix: str) -> bool:
    """True if files with this suffix (with its dot) are written."""
    return suffix.lower() in FORMATS and FORMATS[suffix.lower()].writer is not None


def unknown(suffix: str, verb: str, known: list[str]) -> str:
    """The message on a suffix that is not read or written."""
    shown = f"Files ending in {suffix!r}" if suffix else "Files without an ending"
    return f"{shown} cannot be {verb}: use {', '.join(known[:-1])} or {known[-1]}."


# ---- Two people in two files: a .zip that holds one file of each, or a file beside the other -------------------------
# InterHuman keeps ``person1/12.npy`` and ``person2/12.npy``, Inter-X ``P1.npz`` and ``P2.npz``, BVH exporters
# ``NAME_a.bvh`` and ``NAME_b.bvh``. The order of the names says who comes first.
MAX_PARTS = 200
_TEXTS = (".txt",)
"""Beside motions these are captions, although Kinect's text ends so too."""


def _in_zip(source: str | Path | bytes, name: str | None) -> list[tuple[bytes, str]]:
    """The bytes of the one or two motion files of an archive, and what to call each.

    Raises:
        InputError: for a damaged or large archive, or one without motion or with more than two files of it.
    """
    data, label = read_bytes(source, name)
    if data.count(b"PK\x01\x02") > MAX_PARTS:
        raise InputError(f"{label} holds more than {MAX_PARTS} parts: pack the two people's files alone.")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            parts = {info.filename: info for info in archive.infolist() if not info.is_dir()}
            chosen = _chosen(list(parts), label)
            if sum(parts[part].file_size for part in chosen) > MAX_BYTES:
                raise InputError(f"{label} would unpack to more than {MAX_BYTES // 2**20} MB: cut the motion.")
            files: list[tuple[bytes, str]] = []
            for part in chosen:
                with archive.open(parts[part]) as stream:  # gives no more than the size that was checked
                    files.append((stream.read(MAX_BYTES + 1), _shown(part)))
            return files
    except InputError:
        raise
    except ZIP_ERRORS as error:
        raise InputError(f"{label} is not a whole .zip file, or it is damaged: pack it again.") from error


def partner_file(path: Path) -> Path | None:
    """The second person's file beside the first's, by the names that data sets use; None if there is none."""
    if path.stem.endswith("_a"):
        other = path.with_stem(path.stem[:-2] + "_b")
    elif path.name.lower().endswith("_a.smpl.npz"):
        other = path.with_name(path.name[: -len("_a.smpl.npz")] + "_b.smpl.npz")
    elif path.parent.name == "person1":
        other = path.parent.with_name("person2") / path.name
    elif path.stem == "P1":
        other = path.with_stem("P2")
    else:
        return None
    return other if other.is_file() else None


def _chosen(names: Sequence[str], label: str) -> list[str]:
    """The names of the motion files, in order."""
    suffixes = set(READABLE) - {".zip"}
    motions = sorted(
        name
        for name in names
        if PurePosixPath(name).suffix.lower() in suffixes
        and not any(part.startswith((".", "__")) for part in PurePosixPath(name).parts)
    )
    if len(motions) > 2 or any(not name.lower().endswith(_TEXTS) for name in motions):
        motions = [name for name in motions if not name.lower().endswith(_TEXTS)]
    if not 1 <= len(motions) <= 2:
        raise InputError(
            f"{label} holds {len(motions) or 'no'} motion files: put the two people of one take into it, such as "
            "P1.npz and P2.npz."
        )
    return motions


def _shown(part: str) -> str:
    """A part's name in messages: printable, its last two steps."""
    steps = PurePosixPath(part).parts[-2:]
    return "".join(letter if letter.isprintable() else "?" for letter in "/".join(steps))[-80:]
