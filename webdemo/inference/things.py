"""The things of a result: people look as their words say, and the acts of the plan get their things.

This comes after the network. Only people who are described as children move, to their own size.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np

from acts import Plan
from acts.things.furnishing import PlanFrames, furnish
from motion import SMPL22, Clip, Duet, InputError
from motion.formats.thing_files import read_thing
from motion.looks import SIZES, UNSAID, grown_up, looks_of, size_of
from motion.metrics import compare
from motion.sizes import at_sizes
from motion.things import Mesh

from .requests.acting import plans_of
from .run import Result

_ALIKE = 0.02
"""Share of an adult's thigh by which a child's bones may differ from those of a child's body."""


def furnished(result: Result, plans: Sequence[PlanFrames], mesh: Mesh | None = None, *, given: bool = False) -> Result:
    """A result whose people look as their plans say, with the things of the acts, and hands that take shapes.

    Args:
        result: of two people on SMPL22; another is returned as it is.
        plans: of the request's words.
        mesh: the surface that the first thing has, in place of that of its kind.
        given: a part of the motion was given, with adults: nobody is a child.

    Returns:
        the result, with ``things`` in the manifests where there are some, and with shapes of hands.
    """
    looks = looks_in(plan for plan, *_ in plans)
    result = _at_their_sizes(result, grown_up(looks) if given else looks)
    lengths = lengths_of(result.manifest)
    duets = tuple(furnish(each, plans, lengths, mesh) if _is_on_bodies(each) else each for each in result.duets)
    rows = [(each.manifest or {}).get("things") if isinstance(each, Duet) else None for each in duets]
    manifest = {**result.manifest, "things": rows[0] or []} if any(rows) else result.manifest
    return replace(result, duets=duets, manifest=manifest)


def with_own_thing(result: Result, request: Any, file: Path) -> Result:
    """A result in which the first thing of its words, or one beside the people, looks like that of a file.

    Args:
        result: of two people.
        request: that it was made from.
        file: .glb, .obj, .stl or .ply.

    Raises:
        InputError: if the file cannot be read, or the result has no two people on SMPL22.
    """
    given = getattr(request, "motion", None) is not None
    shaped = furnished(result, list(plans_of(request)), read_thing(file), given=given)
    if "things" not in shaped.manifest:
        raise InputError("There are no two people here for whom a thing could be: leave the file out.")
    named = {"file": file.name[:100], "sha256": hashlib.sha256(file.read_bytes()).hexdigest()}
    return replace(shaped, manifest={**shaped.manifest, "own_thing": named})


def looks_in(plans: Iterable[Plan]) -> tuple[str, str]:
    """The looks of the two people, each as the first plan that says something about them has it."""
    people = [("", ""), ("", "")]
    for plan in plans:
        people = [(sex or p.sex, age or p.age) for (sex, age), p in zip(people, plan.people, strict=True)]
    return looks_of(people)


def lengths_of(manifest: Mapping[str, Any]) -> list[float]:
    """Seconds of the beats into which a sentence was split, from a result's manifest; [] where it was not."""
    plan = manifest.get("plan")
    beats: Iterable[Any] = plan.get("beats", ()) if isinstance(plan, Mapping) else ()
    seconds = [beat.get("seconds") for beat in beats if isinstance(beat, Mapping)]
    return [float(each) for each in seconds if isinstance(each, int | float)]


def _at_their_sizes(result: Result, looks: tuple[str, str]) -> Result:
    """A result whose people look as their plans say, at the sizes of these looks; who looks somehow already, stays so.

    Of people who are smaller than they were made only what is shown is measured.
    """
    if looks == UNSAID:
        return replace(result, duets=tuple(map(_by_their_bones, result.duets)))
    duets, readouts = list(result.duets), list(result.readouts)
    a, b = (size_of(look) for look in looks)
    for i, duet in enumerate(duets):
        if not _is_undressed(duet):
            continue
        if (a, b) != (1.0, 1.0):
            duet = duet.with_positions(at_sizes(duet.positions, (a, b)))
            readouts[i : i + 1] = [{**each, **compare(None, duet)} for each in readouts[i : i + 1]]
        duets[i] = replace(duet, looks=looks)
    manifest = {**result.manifest, "looks": list(looks)}
    return replace(result, duets=tuple(duets), readouts=tuple(readouts), manifest=manifest)


def _by_their_bones(duet: Duet | Clip) -> Duet | Clip:
    """Two people who are not described; one with a child's bones, such as the given person of a reaction, is one."""
    if not _is_undressed(duet):
        return duet
    hip, knee = (SMPL22.index(f"left_{part}") for part in ("hip", "knee"))
    thighs = np.linalg.norm(duet.positions[:, :, knee] - duet.positions[:, :, hip], axis=-1).mean(axis=1)
    a, b = np.abs(thighs / SMPL22.bone_lengths[knee] - SIZES["boy"]) < _ALIKE
    return replace(duet, looks=("boy" if a else UNSAID[0], "girl" if b else UNSAID[1]))


def _is_on_bodies(duet: Duet | Clip) -> TypeGuard[Duet]:
    """True for two people on SMPL22."""
    return isinstance(duet, Duet) and duet.skeleton.joint_names == SMPL22.joint_names


def _is_undressed(duet: Duet | Clip) -> TypeGuard[Duet]:
    """True for two people on SMPL22 to whom nobody has given looks yet."""
    return _is_on_bodies(duet) and duet.looks == UNSAID
