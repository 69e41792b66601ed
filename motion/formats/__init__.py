"""One file a format, one registry: :func:`read` and :func:`write` pick the format by a path's suffix."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from motion import SMPL22, Clip, Duet, InputError
from motion.retarget import retarget, retarget_duet, to_smpl
from motion.rigs import RigMotion

from .bvh import read_bvh, read_bvh_people
from .bvh_writer import write_bvh
from .crowd import Crowd, Motion, gathered
from .glb import write_glb
from .glb_animations import Animation
from .glb_motion import animations_in, read_glb_people
from .kinect import read_kinect
from .npz import read_npy, read_npz, write_npy, write_npz
from .one_person import write_clip
from .usd import write_usd

__all__ = [
    "FORMATS", "Animation", "Format", "animation_note", "can_read", "can_write", "read", "read_everyone", "read_pair",
    "write",
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
        needs: a package that must be installed for writing.
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
    if not set(SMPL22.joint_names) <= set(rig.joint_names) or rig.metres_per_unit != 1.0:
        return None
    order = [rig.joint_names.index(name) for name in SMPL22.joint_names]
    rotations = None if rig.rotations is None else rig.rotations[:, order]
    return Clip(rig.positions[:, order], rig.fps, SMPL22, rotations, rig.name)


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
    )
}


_READABLE = [f.suffix for f in FORMATS.values() if f.reader]


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
        path: the file, or its bytes; then ``name`` must end in its suffix.
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
    label = name or (path.name if isinstance(path, Path) else path if isinstance(path, str) else "")
    suffix = Path(label).suffix.lower()
    known = FORMATS.get(suffix)
    if known is None or known.reader is None:
        raise InputError(_unknown(suffix, "read", _READABLE))
    motion = known.reader(path, name=Path(label).name, fps=fps, **_choice(animation, label))
    assert not isinstance(motion, Crowd)  # not everyone was asked for
    if longest is not None and motion.seconds > longest:
        raise InputError(f"{label} lasts {motion.seconds:.0f} s: cut it to {longest:g} s or less.")
    return motion if keep_skeleton else to_smpl(motion)


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


def read_everyone(
    path: str | Path | bytes, *, name: str | None = None, animation: Animation | None = None
) -> Motion:
    """Like :func:`read`, but returns all people, even more than two, with the file's own joints."""
    label = name or str(path)
    known = FORMATS.get(Path(label).suffix.lower())
    if known is None or known.reader is None:
        raise InputError(_unknown(Path(label).suffix.lower(), "read", _READABLE))
    return known.reader(path, name=Path(label).name, everyone=True, **_choice(animation, label))


def read_pair(
    a: str | Path, b: str | Path, *, fps: float | None = None, roles: tuple[str, str] = ("a", "b")
) -> Duet:
    """Reads two files of one person each that share one world, such as ``NAME_a.bvh`` and ``NAME_b.bvh``.

    The longer one is cut to the length of the other.

    Raises:
        InputError: if a file cannot be read, holds two people, or the rates differ.
    """
    paths = (Path(a), Path(b))
    if all(path.suffix.lower() == ".bvh" for path in paths):
        rigs = [read_bvh(path, fps=fps or 30.0) for path in paths]
        own = [own_clip(rig) for rig in rigs]
        if own[0] is None or own[1] is None:
            return retarget_duet(rigs[0], rigs[1], fps=fps or 30.0, roles=roles)
        clips = [clip for clip in own if clip is not None]
    else:
        clips = []
        for path in paths:
            motion = read(path, fps=fps)
            if isinstance(motion, Duet):
                raise InputError(f"{path.name} already holds two people: give it alone.")
            clips.append(motion)
    frames = min(clip.num_frames for clip in clips)
    return Duet(clips[0].cut(0, frames), clips[1].cut(0, frames), roles)


def write(duet: Duet | Clip, path: str | Path) -> list[Path]:
    """Writes two people, or one, in the format of the path's suffix.

    Returns:
        the files written; BVH gives two, ``NAME_a.bvh`` and ``NAME_b.bvh``.

    Raises:
        InputError: for an unknown suffix, a full disk or a folder that cannot be written; nothing is left.
    """
    path = Path(path)
    known = FORMATS.get(path.suffix.lower())
    if known is None or known.writer is None:
        raise InputError(_unknown(path.suffix, "written", [f.suffix for f in FORMATS.values() if f.writer]))
    if not can_write(path.suffix):
        raise InputError(f"{known.label} files need the package {known.needs}: install it with pip.")
    return write_clip(duet, path) if isinstance(duet, Clip) else known.writer(duet, path)


def _unknown(suffix: str, verb: str, known: list[str]) -> str:
    shown = f"Files ending in {suffix!r}" if suffix else "Files without an ending"
    return f"{shown} cannot be {verb}: use {', '.join(known[:-1])} or {known[-1]}."
