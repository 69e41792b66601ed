"""One file a format, one registry: :func:`read` and :func:`write` pick the format by a path's suffix."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from motion import SMPL22, Clip, Duet, InputError
from motion.joint_names import without_beginning
from motion.retarget import retarget, retarget_duet, to_smpl
from motion.rigs import RigMotion

from .bvh import read_bvh, read_bvh_people
from .bvh_writer import write_bvh
from .c3d_points import read_c3d
from .crowd import Crowd, Motion, gathered
from .glb import write_glb
from .glb_animations import Animation
from .glb_motion import animations_in, read_glb_people
from .kinect import read_kinect
from .npz import read_npy, read_npz, write_npy, write_npz
from .one_person import write_clip
from .pairs import Source, in_folder, in_zip
from .smpl import on_floor, write_smpl
from .trc import read_trc
from .usd import write_usd

__all__ = [
    "FORMATS", "Animation", "Format", "animation_note", "can_read", "can_write", "read", "read_everyone", "read_pair",
    "suffix_of", "with_stem", "write",
]  # fmt: skip


@dataclass(frozen=True)
class Format:
    """One kind of file.

    Attributes:
        suffix: with its dot, lower case.
        label: what people call it.
        reader: ``reader(source, name=…, fps=…, everyone=…)`` gives a clip, a duet or, where everyone is
            wanted, a crowd; ``None`` where it is only written.
        writer: ``writer(duet, path)`` gives the paths it wrote; ``None`` where it is only read.
        needs: a package that must be installed for reading or writing.
    """

    suffix: str
    label: str
    reader: Callable[..., Motion] | None = None
    writer: Callable[[Duet, Path], list[Path]] | None = None
    needs: str | None = None


NO_ANIMATIONS = "{} is no .glb file and has no animations to choose from: leave the choice out."
RIGS = (".bvh", ".glb")
"""Suffixes of files that hold rigs of any kind."""


def read_rigs(
    source: str | Path | bytes, *, name: str | None = None, fps: float, file_fps: float | None = None,
    animation: Animation | None = None,
) -> tuple[RigMotion, ...]:  # fmt: skip
    """The people in a file of one of :data:`RIGS`, on their own rigs.

    Args:
        source: a path, or the file's bytes; then ``name`` must end in its suffix.
        name: what to call it in messages.
        fps: the rate that is wanted in the end.
        file_fps: the file's true rate, where it is not what the file says.
        animation: of a .glb with several, the name or the number, from 1, of the one to read; the first by default.

    Raises:
        InputError: one sentence saying what is wrong with the file.
    """
    if Path(name or str(source)).suffix.lower() == ".glb":
        return read_glb_people(source, name=name, animation=animation)
    return read_bvh_people(source, name=name, fps=fps, file_fps=file_fps)


def _read_rig_clips(
    source: str | Path | bytes, *, name: str | None = None, fps: float | None = None, everyone: bool = False,
    animation: Animation | None = None,
) -> Motion:  # fmt: skip
    rigs = read_rigs(source, name=name, fps=fps or 30.0, animation=animation)
    people = tuple(own_clip(rig) or retarget(rig, fps=fps or 30.0) for rig in rigs)
    return gathered(people, people[0].name, everyone=everyone)


def own_clip(rig: RigMotion) -> Clip | None:
    """A file whose joints are SMPL22's needs no retargeting: it keeps its frame rate, bones and place."""
    names = without_beginning(rig.joint_names)
    if not set(SMPL22.joint_names) <= set(names) or rig.metres_per_unit != 1.0:
        return None
    order = [names.index(name) for name in SMPL22.joint_names]
    rotations = None if rig.rotations is None else rig.rotations[:, order]
    return Clip(rig.positions[:, order], rig.fps, SMPL22, rotations, rig.name)


def _read_zip(
    source: str | Path | bytes, *, name: str | None = None, fps: float | None = None, everyone: bool = False
) -> Motion:
    return _together(in_zip(source, _READABLE, name=name), fps=fps, everyone=everyone)


FORMATS: dict[str, Format] = {
    f.suffix: f
    for f in (
        Format(".npz", "NumPy archive", read_npz, write_npz),
        Format(".bvh", "Biovision BVH", _read_rig_clips, write_bvh),
        Format(".npy", "NumPy array", read_npy, write_npy),
        Format(".skeleton", "Kinect v2 text", read_kinect),
        Format(".txt", "Kinect text", read_kinect),
        Format(".glb", "glTF binary", _read_rig_clips, write_glb, needs="pygltflib"),
        Format(".usda", "USD as text", None, write_usd),
        Format(".smpl.npz", "SMPL parameters", None, write_smpl),
        Format(".trc", "Marker trajectories", read_trc),
        Format(".c3d", "C3D points", read_c3d, needs="c3d"),
        Format(".zip", "Two people's files", _read_zip),
    )
}


_READABLE = [f.suffix for f in FORMATS.values() if f.reader]
_NEAR_FLOOR = (-0.05, 0.15)
"""Metres: people of two files whose lowest joint is between these are left at their height."""


def suffix_of(path: str | Path) -> str:
    """The suffix by which a path's format is known, lower case: ".smpl.npz" is one, ".tar.gz" is none."""
    name = Path(path).name.lower()
    known = [suffix for suffix in FORMATS if name.endswith(suffix)]
    return max(known, key=len, default=Path(name).suffix)


def with_stem(path: Path, added: str) -> Path:
    """The path with something added to its name before its suffix."""
    suffix = suffix_of(path)
    return path.with_name(f"{path.name[: len(path.name) - len(suffix)]}{added}{path.name[-len(suffix) :]}")


def can_read(suffix: str) -> bool:
    """True if files with this suffix (with its dot) are understood."""
    return suffix.lower() in FORMATS and FORMATS[suffix.lower()].reader is not None


def can_write(suffix: str) -> bool:
    """True if this installation writes files with this suffix (with its dot)."""
    known = FORMATS.get(suffix.lower())
    return (
        known is not None
        and known.writer is not None
        and (known.needs is None or find_spec(known.needs) is not None)
    )


def read(
    path: str | Path | bytes,
    *,
    name: str | None = None,
    fps: float | None = None,
    keep_skeleton: bool = False,
    longest: float | None = None,
    animation: Animation | None = None,
) -> Clip | Duet:
    """Reads one motion file.

    Args:
        path: the file, or a folder with a file of each of two people; or a file's bytes, and then ``name`` must end in
            its suffix.
        name: the file's name in messages, if not its own.
        fps: the rate to resample other rigs' BVH to, and that of arrays without one; 30 by default.
        keep_skeleton: keep the joints of arrays in other layouts (Kinect's, CMU's).
        longest: seconds; a longer motion is refused before its joints are fitted, which takes about 5 ms a
            frame and person.
        animation: of a .glb with several, the name or the number, from 1, of the one to read; the first by default.

    Returns:
        a clip, or a duet where the file holds two people, in metres and Y up, on SMPL22. Other rigs and
        layouts are brought onto it with the feet on the floor at 0.

    Raises:
        InputError: one sentence saying what is wrong with the file and what to do.
    """
    motion, label = _reading(path, name, animation, fps=fps)
    assert not isinstance(motion, Crowd)  # not everyone was asked for
    if longest is not None and motion.seconds > longest:
        raise InputError(f"{label} lasts {motion.seconds:.0f} s: cut it to {longest:g} s or less.")
    return motion if keep_skeleton else to_smpl(motion)


def read_everyone(
    path: str | Path | bytes, *, name: str | None = None, fps: float | None = None,
    animation: Animation | None = None,
) -> Motion:  # fmt: skip
    """Like :func:`read`, but returns all people, even more than two, with the file's own joints."""
    return _reading(path, name, animation, fps=fps, everyone=True)[0]


def _reading(
    path: str | Path | bytes, name: str | None, animation: Animation | None, **asked: Any
) -> tuple[Motion, str]:
    """The people of a file, or of a folder with a file each, and what to call it."""
    label = name or ("" if isinstance(path, bytes) else str(path))
    if not isinstance(path, bytes) and Path(path).is_dir():
        return _together(in_folder(Path(path), _READABLE), **asked), Path(path).name
    known = FORMATS.get(Path(label).suffix.lower())
    if known is None or known.reader is None:
        raise InputError(_unknown(Path(label).suffix.lower(), "read", _READABLE))
    return known.reader(path, name=Path(label).name, **asked, **_choice(animation, label)), label


def animation_note(path: str | Path, animation: Animation | None = None) -> str:
    """A sentence on which animation of a file :func:`read` takes and which not; empty where there is no choice."""
    return animations_in(path, animation=animation).note if Path(path).suffix.lower() == ".glb" else ""


def _choice(animation: Animation | None, label: str) -> dict[str, Animation]:
    """The choice for a reader; raises InputError for a file of which none can be chosen."""
    if animation is None:
        return {}
    if Path(label).suffix.lower() != ".glb":
        raise InputError(NO_ANIMATIONS.format(Path(label).name))
    return {"animation": animation}


def read_pair(
    a: str | Path, b: str | Path, *, fps: float | None = None, roles: tuple[str, str] = ("a", "b")
) -> Duet:
    """Reads two files of one person each that share one world, such as ``NAME_a.bvh`` and ``NAME_b.bvh``.

    The longer one is cut to the length of the other.

    Raises:
        InputError: if a file cannot be read, holds two people, or the rates differ.
    """
    return _pair((Path(a), None), (Path(b), None), fps=fps, roles=roles)


def _pair(a: Source, b: Source, *, fps: float | None, roles: tuple[str, str] = ("a", "b")) -> Duet:
    sources = (a, b)
    if all(_label(source).lower().endswith(".bvh") for source in sources):
        rigs = [read_bvh(data, name=name, fps=fps or 30.0) for data, name in sources]
        own = [own_clip(rig) for rig in rigs]
        if own[0] is None or own[1] is None:
            return retarget_duet(rigs[0], rigs[1], fps=fps or 30.0, roles=roles)
        clips = [clip for clip in own if clip is not None]
    else:
        clips = [_one_of_two(source, fps) for source in sources]
        if not _NEAR_FLOOR[0] <= min(float(c.positions[..., 1].min()) for c in clips) <= _NEAR_FLOOR[1]:
            clips = on_floor(*clips)
    frames = min(clip.num_frames for clip in clips)
    return Duet(clips[0].cut(0, frames), clips[1].cut(0, frames), roles)


def _one_of_two(source: Source, fps: float | None) -> Clip:
    """The person of a file, at the height at which the file has them."""
    label = _label(source)
    as_they_are = {".npz": read_npz, ".npy": read_npy}.get(Path(label).suffix.lower())
    if as_they_are is not None:
        motion = as_they_are(source[0], name=source[1], fps=fps, floor=False)
    else:
        motion = read(source[0], name=source[1], fps=fps, keep_skeleton=True)
    if not isinstance(motion, Clip):
        raise InputError(f"{label} already holds two people: give it alone.")
    return to_smpl(motion)


def _together(sources: list[Source], *, fps: float | None = None, everyone: bool = False) -> Motion:
    """The people of one file or two files of one folder or archive."""
    if len(sources) == 2:
        return _pair(sources[0], sources[1], fps=fps)
    data, name = sources[0]
    return read_everyone(data, name=name, fps=fps) if everyone else read(data, name=name, fps=fps)


def _label(source: Source) -> str:
    return source[1] or Path(str(source[0])).name


def write(duet: Duet | Clip, path: str | Path) -> list[Path]:
    """Writes two people, or one, in the format of the path's suffix.

    Returns:
        the files written; BVH gives two, ``NAME_a.bvh`` and ``NAME_b.bvh``.

    Raises:
        InputError: for an unknown suffix, a full disk or a folder that cannot be written; nothing is left.
    """
    path = Path(path)
    suffix = suffix_of(path)
    known = FORMATS.get(suffix)
    if known is None or known.writer is None:
        raise InputError(_unknown(suffix, "written", [f.suffix for f in FORMATS.values() if f.writer]))
    if not can_write(suffix):
        raise InputError(f"{known.label} files need the package {known.needs}: install it with pip.")
    return write_clip(duet, path) if isinstance(duet, Clip) else known.writer(duet, path)


def _unknown(suffix: str, verb: str, known: list[str]) -> str:
    shown = f"Files ending in {suffix!r}" if suffix else "Files without an ending"
    return f"{shown} cannot be {verb}: use {', '.join(known[:-1])} or {known[-1]}."
