"""Motion files: :func:`read` and :func:`write` pick the format by a path's suffix (:mod:`.registry`)."""

from __future__ import annotations

from pathlib import Path

from motion import Clip, Duet, InputError
from motion.retarget import to_smpl

from .choices import Animation, ImportChoices
from .crowd import Crowd, Motion, gathered
from .glb_motion import animations_in
from .importing import import_motion, import_pair
from .one_person import write_clip
from .registry import FORMATS, GLBS, RIGS, Format, can_read, can_write, read_rigs, suffix_of, unknown, with_stem

__all__ = [
    "FORMATS",
    "GLBS",
    "RIGS",
    "Animation",
    "Format",
    "ImportChoices",
    "animation_note",
    "can_read",
    "can_write",
    "read",
    "read_everyone",
    "read_pair",
    "read_rigs",
    "suffix_of",
    "with_stem",
    "write",
]


def read(
    path: str | Path | bytes,
    *,
    name: str | None = None,
    choices: ImportChoices | None = None,
    keep_skeleton: bool = False,
    longest: float | None = None,
) -> Clip | Duet:
    """Reads one motion file.

    Args:
        path: the file, or a folder with a file of each of two people; or a file's bytes, and then ``name`` must end in
            its suffix.
        name: the file's name in messages, if not its own.
        choices: what is known of the file.
        keep_skeleton: keep the joints of arrays in other layouts (Kinect's, CMU's).
        longest: seconds; a longer motion is refused before its joints are fitted, which takes about 5 ms a
            frame and person.

    Returns:
        a clip, or a duet where the file holds two people, in metres and Y up, on SMPL22. Other rigs and
        layouts are brought onto it with the feet on the floor at 0.

    Raises:
        InputError: one sentence saying what is wrong with the file and what to do.
    """
    label = name or ("" if isinstance(path, bytes) else str(path))
    found = import_motion(path, name=name, choices=choices)
    motion = gathered(found.people, Path(label).name, everyone=False, beside=found.beside)
    assert not isinstance(motion, Crowd)  # not everyone was asked for
    if longest is not None and motion.seconds > longest:
        raise InputError(f"{label} lasts {motion.seconds:.0f} s: cut it to {longest:g} s or less.")
    return motion if keep_skeleton else to_smpl(motion)


def read_everyone(path: str | Path | bytes, *, name: str | None = None, choices: ImportChoices | None = None) -> Motion:
    """Like :func:`read`, but returns all people, even more than two, with the file's own joints."""
    found = import_motion(path, name=name, choices=choices)
    return gathered(found.people, name or "", everyone=True, beside=found.beside)


def animation_note(path: str | Path, animation: Animation | None = None) -> str:
    """A sentence on which animation of a file :func:`read` takes and which not; empty where there is no choice."""
    return animations_in(path, animation=animation).note if Path(path).suffix.lower() in GLBS else ""


def read_pair(
    a: str | Path, b: str | Path, *, choices: ImportChoices | None = None, roles: tuple[str, str] = ("a", "b")
) -> Duet:
    """Reads two files of one person each that share one world, such as ``NAME_a.bvh`` and ``NAME_b.bvh``.

    The longer one is cut to the length of the other.

    Raises:
        InputError: if a file cannot be read, holds two people, or the rates differ.
    """
    first, second = import_pair(a, b, choices=choices).people
    return to_smpl(Duet(first, second, roles))


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
        raise InputError(unknown(suffix, "written", [f.suffix for f in FORMATS.values() if f.writer]))
    return write_clip(duet, path) if isinstance(duet, Clip) else known.writer(duet, path)
