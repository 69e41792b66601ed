"""Motion files: :func:`read` and :func:`write` pick the format by a path's suffix (:mod:`.registry`)."""

from __future__ import annotations

from pathlib import Path

from motion import Clip, Duet, InputError
from motion.retarget import to_smpl

from .files import write_files
from .importing import import_motion, import_pair
from .recording import ImportChoices
from .registry import ALONE, FORMATS, READABLE, RIGS, can_write, suffix_of, unknown, with_stem

__all__ = [
    "ALONE",
    "FORMATS",
    "READABLE",
    "RIGS",
    "ImportChoices",
    "can_write",
    "read",
    "read_pair",
    "suffix_of",
    "with_stem",
    "write",
]


def read(
    path: str | Path | bytes,
    *,
    name: str | None = None,
    choices: ImportChoices | None = None,
    longest: float | None = None,
) -> Clip | Duet:
    """Reads one motion file.

    Args:
        path: the file, or its bytes, and then ``name`` must end in its suffix.
        name: the file's name in messages, if not its own.
        choices: what is known of the file.
        longest: seconds; a longer motion is refused before its joints are fitted, which takes about 5 ms a
            frame and person.

    Returns:
        a clip, or a duet where the file holds two people, in metres and Y up, on SMPL22. Other rigs and
        layouts are brought onto it with the feet on the floor at 0.

    Raises:
        InputError: one sentence saying what is wrong with the file and what to do.
    """
    label = Path(name or ("" if isinstance(path, bytes) else path)).name
    imported = import_motion(path, name=name, choices=choices)
    if (count := len(imported.people)) > 2:
        raise InputError(f"{label} holds {count} people: choose one on the React tab, or save one or two of them.")
    if longest is not None and (seconds := imported.people[0].seconds) > longest:
        raise InputError(f"{label} lasts {seconds:.0f} s: cut it to {longest:g} s or less.")
    return imported.motion


def read_pair(a: str | Path, b: str | Path, *, choices: ImportChoices | None = None) -> Duet:
    """Reads two files of one person each that share one world, such as ``NAME_a.bvh`` and ``NAME_b.bvh``.

    The longer one is cut to the length of the other.

    Raises:
        InputError: if a file cannot be read, holds two people, or the rates differ.
    """
    first, second = import_pair(a, b, choices=choices).people
    return to_smpl(Duet(first, second))


def write(motion: Duet | Clip, path: str | Path) -> list[Path]:
    """Writes two people, or one, in the format of the path's suffix, as :func:`read` reads them.

    A .npz of one person holds positions (T, J, 3) float32, fps, joint_names and parents; a .npy the positions alone.

    Returns:
        the files written; two people's BVH gives two, ``NAME_a.bvh`` and ``NAME_b.bvh``.

    Raises:
        InputError: for an unknown suffix, or one that holds two people only, a full disk or a folder that cannot be
            written; nothing is left.
    """
    path = Path(path)
    suffix = suffix_of(path)
    known = FORMATS.get(suffix)
    if known is None or known.writer is None:
        raise InputError(unknown(suffix, "written", [f.suffix for f in FORMATS.values() if f.writer]))
    if isinstance(motion, Clip) and not known.alone:
        raise InputError(f"{path.name}: one person is written as {', '.join(ALONE[:-1])} or {ALONE[-1]}: choose one.")
    if isinstance(motion, Clip) or known.apart is None:
        return write_files({path: known.writer(motion)})
    people = zip("ab", known.apart(motion), strict=True)
    return write_files({with_stem(path, f"_{letter}"): known.writer(clip) for letter, clip in people})
