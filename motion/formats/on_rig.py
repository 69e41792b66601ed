"""A person's motion on the rig of another file, whichever kind that is."""

from __future__ import annotations

from pathlib import Path

from motion.clip import Clip
from motion.errors import InputError

from .bvh_rig import bvh_on_rig
from .choices import Animation
from .glb_rig import glb_on_rig
from .registry import GLBS, RIGS, read_rigs


def on_rig(clip: Clip, reference: Path, *, animation: Animation | None = None) -> bytes:
    """One person's motion as a file of the reference's kind, on its rig and in its world.

    Args:
        clip: on SMPL22, metres.
        reference: a .bvh or .glb of one person.
        animation: the one that the person was read from, of a .glb with several.

    Raises:
        InputError: as :func:`check_rig`, and where the rig cannot be moved.
    """
    _check_kind(reference)
    if reference.suffix.lower() in GLBS:
        return glb_on_rig(clip, reference, animation=animation)
    return bvh_on_rig(clip, reference)


def check_rig(reference: Path) -> None:
    """Raises InputError for a file that is no .bvh or .glb of one person, before a partner is made."""
    _check_kind(reference)
    if (count := len(read_rigs(reference))) > 1:
        raise InputError(f"A partner is taken on the rig of one person, and {reference.name} holds {count}.")


def _check_kind(reference: Path) -> None:
    if reference.suffix.lower() not in RIGS:
        raise InputError(f"A partner is taken on the rig of a BVH or .glb file, and {reference.name} is none.")
