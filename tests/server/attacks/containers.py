"""Files that are changed inside their container, so that its checksums and lengths are right again."""

from __future__ import annotations

import io
import random
import zipfile
from typing import Any

import numpy as np

from tests.motion.formats.arrays import npy
from tests.motion.formats.characters import packed, unpacked

NUMBERS = (-1, 0, 1, 2**31, 2**63, -(2**31), 0.5, 1e308, float("nan"), float("inf"))
OTHERS: tuple[Any, ...] = (10**400, None, True, "", "x" * 5000, [], {}, [[]], {"0": 0}, [0] * 1000, "data:,x")
OTHERS += ("../canary.txt",)
SHAPES = ((0,), (1,), (2, 0, 22, 3), (2, 4, 22, 2), (1, 1, 1, 1, 1), (3, 30, 22, 3), (22, 3))
KINDS = (np.float64, np.int8, np.uint64, np.complex64, bool, "S3", "U2", "datetime64[s]")


def changed_archive(data: bytes, dice: random.Random) -> bytes:
    """An .npz in which an array, or the bytes of one, is another; or is left out, twice there or renamed."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = [(name, archive.read(name)) for name in archive.namelist()]
    place = dice.randrange(len(members))
    name, content = members[place]
    match dice.randrange(6):
        case 0:
            members.pop(place)
        case 1:
            members[place] = dice.choice(("../x.npy", "x" * 300, "positions", name.upper())), content
        case 2:
            start = dice.randrange(len(content))
            members[place] = (name, content[:start] + dice.randbytes(4) + content[start + dice.choice((0, 4, 400)) :])
        case _:
            members[place] = name, npy(_changed_array(np.load(io.BytesIO(content)), dice))
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", dice.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED))) as archive:
        for name, content in members:
            archive.writestr(name, content)
    return out.getvalue()


def _changed_array(array: np.ndarray, dice: random.Random) -> np.ndarray:
    match dice.randrange(3):
        case 0:
            return np.zeros(dice.choice(SHAPES), array.dtype)
        case 1:
            return np.zeros(array.shape, dice.choice(KINDS))
    changed = np.array(array, dtype=np.float32)
    with np.errstate(over="ignore"):
        changed.flat[dice.randrange(changed.size)] = np.float32(dice.choice(NUMBERS))
    return changed


def changed_glb(data: bytes, dice: random.Random) -> bytes:
    """A GLB of whose JSON one to three values are others, left out or repeated."""
    document, blob = unpacked(data)
    for _ in range(dice.randint(1, 3)):
        _change(document, dice)
    return packed(document, blob)


def changed_story(data: bytes, dice: random.Random) -> bytes:
    """A story of which lines are left out, repeated or moved, or one value is another."""
    lines = data.decode().split("\n")
    for _ in range(dice.randint(1, 3)):
        place = dice.randrange(len(lines))
        key, _, _ = lines[place].partition("=")
        match dice.randrange(4):
            case 0:
                lines[place : place + 1] = []
            case 1:
                lines[place : place + 1] = [lines[place]] * dice.choice((2, 70, 500))
            case 2:
                lines.insert(dice.randrange(len(lines)), lines[place])
            case _:
                value = dice.choice(
                    (*NUMBERS, 10**400, '""', "[]", "{}", "[[0]]", "true", '"' + "x" * 5000 + '"', "[" * 400)
                )
                lines[place] = f"{key} = {value}"
        lines = lines or [""]
    return "\n".join(lines).encode()


def _change(value: Any, dice: random.Random) -> None:
    """Changes one thing somewhere in a tree of lists and dictionaries."""
    while True:
        keys = list(value) if isinstance(value, dict) else list(range(len(value)))
        key = dice.choice(keys)
        below = value[key]
        if isinstance(below, dict | list) and below and dice.random() < 0.9:
            value = below
            continue
        if dice.random() < 0.2:
            del value[key]
        elif isinstance(value, list) and dice.random() < 0.3:
            value += [below] * dice.choice((1, 50, 3000))
        else:
            value[key] = dice.choice(NUMBERS if dice.random() < 0.6 else OTHERS)
        return
