"""One file a format, one registry: the suffix or the first bytes of a file say how it is read and written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from motion.clip import Clip, Duet
from motion.errors import InputError

from .bvh import read_bvh
from .bvh_writer import bvh_text, write_bvh
from .c3d_points import read_c3d
from .files import read_bytes, write_files
from .glb_motion import read_glb
from .glb_writer import write_glb
from .kinect import read_kinect
from .markers import read_trc
from .npz import read_npy, read_npz, write_npy, write_npz
from .pairs import Source, in_zip
from .recording import ImportChoices, Recording
from .smpl import smpl_bytes, write_smpl
from .usd import write_usd

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
        writer: ``writer(duet, path)`` gives the paths it wrote; ``None`` where it is only read.
        alone: likewise for one person; ``None`` where a file always holds two.
    """

    suffix: str
    reader: Callable[[bytes, str, ImportChoices], Recording] | None = None
    writer: Callable[[Duet, Path], list[Path]] | None = None
    alone: Callable[[Clip, Path], list[Path]] | None = None


def _rigs(data: bytes, label: str, choices: ImportChoices) -> Recording:
    if data[:4] == b"glTF" or Path(label).suffix.lower() in GLBS:
        people, animations = read_glb(data, name=label, animation=choices.animation)
        if choices.fps:
            people = tuple(replace(rig, fps=choices.fps / rig.every) for rig in people)
        if animations.note:
            people = tuple(replace(rig, notes=(animations.note,)) for rig in people)
        return Recording(people, animations=animations)
    return Recording(read_bvh(data, name=label, fps=RIG_FPS, file_fps=choices.fps))


def _bvh_alone(clip: Clip, path: Path) -> list[Path]:
    return write_files({path: bvh_text(clip).encode()})


def _smpl_alone(clip: Clip, path: Path) -> list[Path]:
    return write_files({path: smpl_bytes(clip)})


FORMATS: dict[str, Format] = {
    f.suffix: f
    for f in (
        Format(".npz", read_npz, write_npz, write_npz),
        Format(".bvh", _rigs, write_bvh, _bvh_alone),
        Format(".npy", read_npy, write_npy, write_npy),
        Format(".skeleton", read_kinect),
        Format(".txt", read_kinect),
        Format(".glb", _rigs, write_glb),
        Format(".vrm", _rigs),
        Format(".vrma", _rigs),
        Format(".usda", None, write_usd),
        Format(".smpl.npz", None, write_smpl, _smpl_alone),
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
    sources: list[Source] = [(source, name)]
    if Path(label).suffix.lower() == ".zip":
        sources = in_zip(source, READABLE, name=name)
    return [_recording(*each, choices) for each in sources], label


def _recording(source: str | Path | bytes, name: str | None, choices: ImportChoices) -> Recording:
    label = name or ("" if isinstance(source, bytes) else Path(source).name)
    suffix = Path(label).suffix.lower()
    known = FORMATS.get(suffix)
    if known is None or known.reader is None:
        raise InputError(unknown(suffix, "read", READABLE))
    if choices.animation is not None and suffix not in GLBS:
        raise InputError(
            f"{Path(label).name} is no .glb file and has no animations to choose from: leave the choice out."
        )
    remedy = "reduce its mesh or leave out its pictures" if suffix in GLBS else "cut the motion or lower its frame rate"
    data, label = read_bytes(source, name and Path(name).name, remedy=remedy)
    return known.reader(data, label, choices)


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
