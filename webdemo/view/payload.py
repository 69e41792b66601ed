"""The data sent to the player in the browser: motion as compact, plain JSON.

Positions are quantised to 16 bits an axis and sent as base64, so a clip of ten seconds for two people
takes about 105 kB. The browser's side of this format is ``static/player/decode.js``.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from motion.body import in_base64
from motion.clip import Clip, Duet, stacked_positions
from motion.errors import InputError
from motion.hands import to_lists
from motion.looks import UNSAID
from motion.metrics import Contact, contact_events, hand_distance, pelvis_distance
from motion.vectors import Array

from .things import thing_payload

Payload = dict[str, Any]

_LEVELS = 2**16 - 1


def pack_positions(positions: Array) -> dict[str, Any]:
    """Quantises positions to 16 bits along each axis.

    Args:
        positions: (people, T, J, 3) metres.

    Returns:
        ``data`` (base64 of little-endian uint16 in C order), ``min`` and ``scale`` (3 numbers each;
        metres = min + scale · level) and ``shape``. The error is at most half a level: 0.08 mm where
        the scene is 10 m wide.

    Raises:
        InputError: on another shape, no frames, or positions that are not finite.
    """
    positions = np.asarray(positions, dtype=np.float64)
    if positions.ndim != 4 or positions.shape[-1] != 3 or 0 in positions.shape:
        raise InputError(f"The player shows positions (people, frames, joints, 3), not {positions.shape}.")
    if not np.isfinite(positions).all():
        raise InputError("The motion holds NaN or infinite positions: remove or repair those frames.")
    low = positions.min(axis=(0, 1, 2))
    extent = positions.max(axis=(0, 1, 2)) - low
    scale = np.where(extent > 0, extent, 1.0) / _LEVELS
    levels = np.rint((positions - low) / scale).astype("<u2")
    return {"data": in_base64(levels, "<u2"), "min": low.tolist(), "scale": scale.tolist(), "shape": list(levels.shape)}


def sample_payload(
    motion: Duet | Clip,
    *,
    label: str = "",
    curves: Sequence[Curve] | None = None,
    contacts: Sequence[Contact] | None = None,
    ghost: Duet | Clip | None = None,
    past_until: int | None = None,
) -> dict[str, Any]:
    """One motion as the player takes it.

    Args:
        motion: two people, or one.
        label: names the sample in the player's tabs.
        curves: read-outs under the scene; by default those of :func:`distance_curves`.
        contacts: marks on the timeline; by default those of :func:`~motion.metrics.contact_events`.
        ghost: a second motion drawn pale beside the first, such as what really happened beside a prediction.
        past_until: the first frame that was predicted; the player marks what came before as given.
    """
    roles = motion.roles if isinstance(motion, Duet) else (motion.name or "a",)
    if curves is None:
        curves = distance_curves(motion) if isinstance(motion, Duet) else ()
    if contacts is None:
        contacts = contact_events(motion) if isinstance(motion, Duet) else ()
    return {
        "label": label,
        "roles": list(roles),
        "fps": float(motion.fps),
        "frames": motion.num_frames,
        "positions": pack_positions(stacked_positions(motion)),
        "curves": [{"label": c.label, "unit": c.unit, "values": np.round(c.values, 4).tolist()} for c in curves],
        "contacts": [contact.to_dict() for contact in contacts],
        "ghost": None if ghost is None else pack_positions(stacked_positions(ghost)),
        "past_until": past_until,
    } | _things(motion)


def _things(motion: Duet | Clip) -> dict[str, Any]:
    """The things beside two people, their grips and looks, and what happens in words; nothing for what is not said."""
    if not isinstance(motion, Duet):
        return {}
    columns: dict[str, Any] = {}
    if told := str((motion.manifest or {}).get("told") or ""):
        columns["told"] = told
    if motion.things:
        columns["things"] = [thing_payload(thing) for thing in motion.things]
    if motion.grips:
        columns["grips"] = to_lists(motion.grips)
    if motion.looks != UNSAID:
        columns["looks"] = list(motion.looks)
    return columns


def build_payload(samples: Sequence[dict[str, Any]], *, skeleton: Any, title: str = "") -> Payload:
    """Wraps samples of :func:`sample_payload` that share a skeleton.

    Args:
        samples: at least one.
        skeleton: the :class:`~motion.skeleton.Skeleton` they share.
        title: shown above the scene, such as the prompt; the browser takes it as text only.

    Returns:
        A JSON-ready dictionary; its ``id`` is a digest of the content, so a change of motion always
        changes it.
    """
    payload: Payload = {
        "title": title,
        "joint_names": list(skeleton.joint_names),
        "parents": list(skeleton.parents),
        "samples": list(samples),
    }
    digest = hashlib.blake2b(json.dumps(payload, sort_keys=True).encode(), digest_size=8)
    return {"id": digest.hexdigest(), **payload}


def grid_sample(cells: Sequence[dict[str, Any]], columns: Sequence[str], rows: Sequence[str]) -> dict[str, Any]:
    """Samples of :func:`sample_payload` as the cells of a grid: one clock, as long as the longest, and one camera.

    Args:
        cells: row after row; ``caption`` names each.
        columns: names over the columns.
        rows: names beside the rows; one "" for a single row.
    """
    longest = max(cells, key=lambda cell: float(cell["frames"]) / float(cell["fps"]))
    return {
        **longest,
        "label": "1",
        "curves": [],
        "contacts": [],
        "ghost": None,
        "past_until": None,
        "caption": "",
        "cells": list(cells),
        "columns": list(columns),
        "rows": list(rows),
    }


def player_payload(motion: Duet | Clip, *, title: str = "") -> Payload:
    """One motion as the value of a :class:`~webdemo.ui.components.player.MotionPlayer`; ``title`` stands above it."""
    return build_payload([sample_payload(motion, label="1")], skeleton=motion.skeleton, title=title)


# ---- curves --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Curve:
    """One value a frame.

    Attributes:
        label: what the page calls it.
        unit: behind the value, such as ``"m"``.
        values: (T,).
    """

    label: str
    unit: str
    values: Array


def distance_curves(duet: Duet) -> list[Curve]:
    """Distance in metres between the two roots over the floor plan, and between the nearest two hands."""
    return [Curve("Apart", "m", pelvis_distance(duet)), Curve("Hands", "m", hand_distance(duet))]
