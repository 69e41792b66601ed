"""The common part of the pipelines of released checkpoints: the check of files, and the loss of the conversion."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from torch import nn

from models.compiled import Precision, compile_network, has_bfloat16
from motion import Duet
from webdemo.inference.finish.cleanup import clean_person
from webdemo.inference.own.entries import Entry
from webdemo.inference.pipelines.given import Finish, Scene

Array = NDArray[np.floating]
SMOOTHING = 1.0
"""Frames: σ of the Gaussian by which InterGen's release smooths its positions."""


def digest(paths: Iterable[Path]) -> str:
    """One SHA-256 for files, by which a manifest names the weights; a folder counts by its files' names."""
    total = hashlib.sha256()
    for path in paths:
        if path.is_dir():
            total.update("\n".join(sorted(file.name for file in path.iterdir())).encode())
            continue
        with path.open("rb") as file:
            while block := file.read(1 << 22):
                total.update(block)
    return total.hexdigest()


def precision_of(entry: Entry) -> Precision:
    """The numbers of the matrix products: bfloat16 where it is asked for, or the processor has it."""
    if entry.precision == "auto":
        return "bf16" if has_bfloat16() else "f32"
    named: dict[str, Precision] = {"float32": "f32", "bfloat16": "bf16", "int8": "int8"}
    return named[entry.precision]


def compiled_near(network: nn.Module, key: str, precision: Precision) -> bool:
    """Lets OpenVINO run a network with coarser numbers if its outputs stay near, in float32 otherwise.

    Returns:
        whether it is compiled, as :func:`models.compiled.compile_network`.
    """
    if precision != "f32" and compile_network(network, f"{key} {precision}", precision=precision):
        return True
    return compile_network(network, f"{key} f32")


class Measured:
    """A scene that measures by how much the joints move on their way onto constant bones.

    Args:
        scene: whose duets are made.
    """

    def __init__(self, scene: Scene) -> None:
        self.frames, self.given, self._scene = scene.frames, scene.given, scene
        self.moved: list[float] = []
        """Mean distance in metres, one of each generated person."""

    def duet(self, pair: Array, finish: Finish) -> Duet:
        """As the scene's own; a clean-up is measured, and comes after the release's smoothing."""
        return self._scene.duet(pair, self._cleaned if finish is clean_person else finish)

    def _cleaned(self, person: Array) -> Array:
        cleaned = clean_person(gaussian_filter1d(person, SMOOTHING, axis=0, mode="nearest"))
        self.moved.append(float(np.linalg.norm(cleaned - person, axis=-1).mean()))
        return cleaned

    def note(self, cleanup: bool) -> str:
        """Says in a sentence what the clean-up changed."""
        if not cleanup:
            return "The positions are as the network gave them."
        return (
            f"Smoothing (σ = {SMOOTHING:g} frame), constant bones and planted feet moved the joints by "
            f"{100 * float(np.mean(self.moved)):.1f} cm on average."
        )
