"""Limbs of two bones that bend to a side that is given, however they bent before."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]

_STRAIGHT = 0.97
"""Share of an arm's length that is used at most."""


def across(bone: Array, line: Array) -> Array:
    """(T, 3) the unit direction of a bone across a line (T, 3); 0 where the bone lies along it."""
    out = bone - line * np.sum(bone * line, axis=-1, keepdims=True) / np.maximum(
        np.sum(line * line, axis=-1, keepdims=True), 1e-9
    )
    return np.asarray(out / np.maximum(np.linalg.norm(out, axis=-1, keepdims=True), 1e-3))


def bent_towards(root: Array, middle: Array, end: Array, goal: Array, pole: Array) -> tuple[Array, Array]:
    """The elbow and the wrist (T, 3) of an arm that reaches for a goal and bends towards a pole, however it bent."""
    upper, lower = (np.linalg.norm(tip - base, axis=-1, keepdims=True) for base, tip in ((root, middle), (middle, end)))
    reach = np.linalg.norm(goal - root, axis=-1, keepdims=True)
    axis = (goal - root) / np.maximum(reach, 1e-9)
    reach = np.clip(reach, np.abs(upper - lower) + 1e-3, _STRAIGHT * (upper + lower))
    along = (reach**2 + upper**2 - lower**2) / (2 * reach)
    out = pole - np.sum(pole * axis, axis=-1, keepdims=True) * axis
    aside = np.sqrt(np.maximum(upper**2 - along**2, 0.0))
    return on_bone(root + along * axis, root + along * axis + out, aside), root + reach * axis


def on_bone(base: Array, towards: Array, length: Array) -> Array:
    """(T, 3) the point ``length`` (T, 1) metres from a base on the way to another point."""
    bone = towards - base
    return np.asarray(base + bone * length / np.maximum(np.linalg.norm(bone, axis=-1, keepdims=True), 1e-9))
