"""From the markers of a laboratory, or the key points of a camera, to the joints of bodies.

Names decide: Plug-in Gait's and CMU's markers (``LASI``, ``LKNE``, ``C7`` …), OpenCap's and Pose2Sim's key points
(``LHip``, ``LKnee``, ``LBigToe`` …) and joint centres (``LHJC``, ``LKJC`` …). A prefix such as ``Anna:`` tells people
of one file apart.

Marker files as text are read here (``.trc`` of Motion Analysis, OpenSim, OpenCap and Pose2Sim): five lines of head (a
title, names of settings, their values, ``Frame#  Time`` and the markers' names, one above each three columns, and
``X1 Y1 Z1 …``), then a row a frame. Between cells stand tabs, or else semicolons, commas or spaces; an empty cell is a
marker that was not seen.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from motion.clip import Clip
from motion.errors import InputError
from motion.retarget import UNITS
from motion.skeleton import POINTS17
from motion.smoothing import filled
from motion.vectors import Array, square_to, unit

from .files import MAX_FRAMES, MAX_NUMBERS, MAX_SECONDS, check_duration, check_rate, text_bytes
from .recording import ImportChoices, Recording

Points = Mapping[str, Array]

_FARTHEST = 1000.0  # metres
_OFTEN_UNSEEN = 0.2
"""Share of the frames; a joint that is interpolated for longer is mentioned."""
_SIDED = {
    "hip": "*hjc, *hjcstudy, *hipjc, *hip, %hip, *hipcenter",
    "knee": "*kjc, *kneejc, *kne *knem, *kneestudy *mkneestudy, *knee *mknee, *kne, *knee, %knee",
    "ankle": "*ajc, *anklejc, *ank *ankm, *ank *med, *anklestudy *mankstudy, *anklestudy *manklestudy, "
    "*ankle *mankle, *ank, *ankle, %ankle",
    "foot": "*toe, *bigtoe, *bigtoe *smalltoe, *toestudy, *mt1 *mt5, %toe, %foot",
    "shoulder": "*sjc, *sho, *shoulder, %shoulder, *acr",
    "elbow": "*ejc, *elb *elbm, *elb, *elbow, %elbow",
    "wrist": "*wjc, *wra *wrb, *wri, *wrist, %wrist, *wrb, *wra",
}
"""Markers whose mean is the joint, by preference, between commas; "*" is l or r, "%" left or right."""
_MIDDLE = {"head": "lfhd rfhd lbhd rbhd, lfhd rfhd, head, lear rear, nose", "neck": "c7 clav, neck, c7, t1"}
_PELVIS = (("lasi", "rasi", "lpsi", "rpsi"), ("lasis", "rasis", "lpsis", "rpsis"), ("lfwt", "rfwt", "lbwt", "rbwt"))
"""Four markers around the pelvis: both in front, both behind."""
_NEEDED = ("hip", "knee", "ankle", "shoulder", "elbow", "wrist")
_SACRUM = ("sacr", "vsacr")


def people_of(names: Sequence[str], points: Array, fps: float, length: str, label: str) -> Recording:
    """Everybody whom markers show, in the order in which their prefixes appear.

    Args:
        names: of P markers.
        points: (T, P, 3), NaN or all zeros where a marker was not seen; any axis may be up. They are changed.
        fps: frames a second.
        length: name of their unit.
        label: the file's name in messages.

    Returns:
        clips on :data:`~motion.skeleton.POINTS17`; joints are interpolated while they were not seen.

    Raises:
        InputError: if nobody has the markers of a whole body, or the unit or places are not possible.
    """
    if length not in UNITS:
        raise InputError(f"{label}: the unit {length!r:.20} is not known: use {', '.join(UNITS)}.")
    points *= np.float32(UNITS[length])
    points[(points == 0).all(axis=-1)] = np.nan
    if max(-np.fmin.reduce(points, axis=None), np.fmax.reduce(points, axis=None)) > _FARTHEST:  # NaN is left out
        raise InputError(f"{label} holds points more than {_FARTHEST:g} m away: is its unit right?")
    people, missing = [], ""
    for markers in _by_person(names, points):
        joints, lacks = _joints(markers)
        if lacks:
            missing = missing or lacks
        else:
            people.append(joints)
    if not people:
        shown = ", ".join(re.sub(r"[^\x20-\x7e]", "?", name)[:20] for name in names[:4])
        raise InputError(
            f"{label} has no marker or key point for {missing.replace('_', ' ') or 'a body'} among {shown}, …: use "
            "names such as LKNE, LKnee or LKJC."
        )
    return Recording(tuple(_clip(joints, fps, label) for joints in people), "")


def _by_person(names: Sequence[str], points: Array) -> list[dict[str, Array]]:
    """Markers (T, 3) by plain name, a group a prefix; those that were never seen are left out."""
    people: dict[str, dict[str, Array]] = {}
    for column, name in enumerate(names):
        person, _, marker = name.rpartition(":")
        plain = re.sub(r"[^a-z0-9]", "", marker.lower())
        if np.isfinite(points[:, column]).all(-1).any():
            people.setdefault(person, {}).setdefault(plain, points[:, column])
    return list(people.values())


def _joints(markers: Points) -> tuple[dict[str, Array], str]:
    """(T, 3) of the joints that are found, and the first that is needed and is not."""
    joints: dict[str, Array] = {}
    for side in ("left", "right"):
        for part, choices in _SIDED.items():
            its = choices.replace("*", side[0]).replace("%", side)
            if (place := _mean_of(markers, its)) is not None:
                joints[f"{side}_{part}"] = place
    for part, choices in _MIDDLE.items():
        if (place := _mean_of(markers, choices)) is not None:
            joints[part] = place
    _add_hips(joints, markers)
    lacks = (f"{side}_{part}" for part in _NEEDED for side in ("left", "right"))
    return joints, next((joint for joint in lacks if joint not in joints), "")


def _mean_of(markers: Points, choices: str) -> Array | None:
    """The mean of the first set of markers that are all there."""
    for choice in (names.split() for names in choices.split(", ")):
        if all(name in markers for name in choice):
            return np.mean([markers[name] for name in choice], axis=0)
    return None


def _add_hips(joints: dict[str, Array], markers: Points) -> None:
    """Centres of the hips from four markers of the pelvis (Bell, Pedersen and Brand 1990), where they have no own."""
    for left, right, left_back, right_back in _PELVIS:
        back = [name for name in (left_back, right_back, *_SACRUM) if name in markers]
        if left not in markers or right not in markers or not back:
            continue
        front = (markers[left] + markers[right]) / 2
        wide = markers[left] - markers[right]
        width = np.linalg.norm(wide, axis=-1, keepdims=True)
        across = unit(wide)
        behind = np.mean([markers[name] for name in back], axis=0) - front
        behind = unit(square_to(behind, across))
        down = np.cross(behind, across)
        for side, sign in (("left", 1.0), ("right", -1.0)):
            joints.setdefault(f"{side}_hip", front + width * (0.36 * sign * across + 0.19 * behind + 0.30 * down))
        return


def _clip(joints: Mapping[str, Array], fps: float, label: str) -> Clip:
    """The joints that were found with those that follow from them, without gaps."""
    unseen = {name: float(np.mean(~np.isfinite(place).all(-1))) for name, place in joints.items()}
    places = {name: filled(place[:, None], label)[:, 0] for name, place in joints.items()}
    hips, shoulders = ((places[f"left_{part}"] + places[f"right_{part}"]) / 2 for part in ("hip", "shoulder"))
    trunk = unit(shoulders - hips)
    across = unit(places["left_hip"] - places["right_hip"])
    places["pelvis"] = hips + 0.09 * trunk
    places.setdefault("neck", shoulders + 0.03 * trunk)
    places.setdefault("head", places["neck"] + 0.1 * trunk)
    for side in ("left", "right"):
        shank = unit(places[f"{side}_knee"] - places[f"{side}_ankle"])
        places.setdefault(f"{side}_foot", places[f"{side}_ankle"] + 0.13 * np.cross(across, shank) - 0.06 * shank)
    positions = np.stack([places[name] for name in POINTS17.joint_names], axis=1)
    often = [name.replace("_", " ") for name, share in unseen.items() if share > _OFTEN_UNSEEN]
    note = f"Interpolated, as their markers were often not seen: {', '.join(often)}."
    return Clip(positions, fps, POINTS17, name=label, notes=(note,) if often else ())


# ---- marker trajectories as text, ``.trc`` ---------------------------------------------------------


_MOST_MARKERS = 1000
_HEAD = 200_000
"""Characters: the head of a file with so many markers is shorter."""


def read_trc(data: bytes, label: str, choices: ImportChoices) -> Recording:
    """The people of a .trc file, on the joints of :data:`~motion.skeleton.POINTS17`, in metres.

    Raises:
        InputError: one sentence with the line where the file is wrong.
    """
    text = text_bytes(data, label, "a .trc file").decode("latin-1")
    del data
    head, start = _head(text, label)
    mark = next((mark for mark in "\t;," if mark in head[3]), None)
    settings = dict(zip(_cells(head[1], mark), _cells(head[2], mark), strict=False))
    try:
        rate = choices.fps or float(settings.get("DataRate") or settings.get("CameraRate") or "")
    except ValueError:
        raise InputError(f"{label} does not give its DataRate as a number: give its true rate.") from None
    check_rate(rate, label)
    names = [cell.strip() for cell in _cells(head[3], mark)[2:] if cell.strip()]
    if not 1 <= len(names) <= _MOST_MARKERS:
        raise InputError(f"{label} names {len(names)} markers: give 1 to {_MOST_MARKERS}.")
    values = _rows(text, start, len(names), mark, rate, label)
    return people_of(names, values, rate, settings.get("Units", "mm").strip().lower(), label)


def _cells(line: str, mark: str | None) -> list[str]:
    """The cells of a line; a comma that is not between them is a decimal one."""
    cells = line.split(mark)
    return cells if mark in (",", None) or "," not in line else [cell.replace(",", ".") for cell in cells]


def _head(text: str, label: str) -> tuple[list[str], int]:
    """The five lines of the head, and where the rows begin."""
    start, lines = 0, []
    for _ in range(5):
        stop = text.find("\n", start, start + _HEAD)
        if stop < 0:
            raise InputError(f"{label} has no head of five lines: is it a .trc file?")
        lines.append(text[start:stop].rstrip("\r"))
        start = stop + 1
    if "DataRate" not in lines[1] or not lines[3].lower().startswith("frame"):
        raise InputError(f"{label} does not name DataRate and Frame# in its head: is it a .trc file?")
    return lines, start


def _rows(text: str, start: int, markers: int, mark: str | None, rate: float, label: str) -> Array:
    """(T, markers, 3) float32 as in the file; NaN where a marker was not seen."""
    width = 2 + 3 * markers
    longest = 40 * width
    lines = text.count("\n", start) + 1
    if lines > 4 * MAX_FRAMES:
        raise InputError(f"{label} has {lines:,} lines: cut it, or leave out those that are empty.")
    lines = min(lines, int(MAX_SECONDS * rate) + 1, MAX_FRAMES)
    if lines * width > MAX_NUMBERS:
        raise InputError(
            f"{label} holds {markers} markers in more than {MAX_NUMBERS // width:,} frames: cut it or lower its rate."
        )
    rows, frames, number = np.full((lines, 3 * markers), np.nan, dtype=np.float32), 0, 5
    while start < len(text):
        stop = text.find("\n", start)
        stop = len(text) if stop < 0 else stop
        number += 1
        if stop - start > longest:
            raise InputError(f"{label}, line {number} is longer than {markers} markers need: export it again.")
        line, start = text[start:stop].strip("\r\n"), stop + 1
        if not line.strip("\t ;,"):
            continue
        check_duration(frames + 1, rate, label)
        values = [_value(cell, label, number) for cell in _cells(line, mark)[2:width]]
        rows[frames, : len(values)] = values
        frames += 1
    if not frames:
        raise InputError(f"{label} holds no frames: export it again.")
    return rows[:frames].reshape(frames, markers, 3)


def _value(cell: str, label: str, number: int) -> float:
    try:
        return float(cell) if cell.strip() else np.nan
    except ValueError:
        raise InputError(f"{label}, line {number}: {cell.strip()!r:.20} is not a number.") from None
