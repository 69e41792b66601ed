"""Released checkpoints of the papers as methods."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from motion import InputError
from webdemo.inference.method import Method, Pipeline, load_pipeline

from .entries import Entry

LOADING = 2.1
"""Largest memory while a network is loaded, as a multiple of its float32 weights; measured in docs/own-model.md."""
RESERVE = 0.8e9
"""Bytes of PyTorch, OpenVINO and a motion's own tensors."""
Outline = dict[str, tuple[int, ...]]
"""Tensor name → shape."""


@dataclass(frozen=True, kw_only=True)
class Release:
    """A network whose authors released a checkpoint.

    Attributes:
        method: what it does; its label is the network's name, and its pipeline is loaded from an entry.
        mark: part of its tensors' names.
        loss: one sentence on what its representation loses here.
        needed: roles of the files that it cannot do without.
        kept: beginnings of the names of tensors that are loaded; all by default.
        modes: outline → the method's modes, mode → ending of its label.
    """

    method: Method
    mark: str
    loss: str
    needed: tuple[str, ...] = ("checkpoint",)
    kept: tuple[str, ...] = ("",)
    modes: Callable[[Outline], dict[str, str]] = lambda outline: {"offline": ""}


def _regennet_modes(outline: Outline) -> dict[str, str]:
    online = any("seqTransDecoder." in name for name in outline)
    return {"offline": ", whole motion", "online": ", frame by frame"} if online else {"offline": ""}


_RELEASES = (
    Release(
        method=Method(
            name="intergen",
            label="InterGen",
            summary="The authors' InterGen: two people from a sentence, or a partner for a given person.",
            tasks=("generate", "react"),
            takes=frozenset({"words", "actor", "either role"}),
            defaults={"guidance": 3.5, "steps": 50},
            fixed={"damping": 0.0},
            load=partial(load_pipeline, "intergen.ReleasedInterGenPipeline"),
        ),
        mark="decoder.net.blocks.",
        loss="Of its 262 numbers per person and frame, only the positions are kept.",
        needed=("checkpoint", "mean", "std"),
        kept=("model.",),
    ),
    Release(
        method=Method(
            name="regennet",
            label="ReGenNet",
            summary="The authors' ReGenNet: the person who reacts to a given one.",
            tasks=("react",),
            takes=frozenset({"actor"}),
            samplers=("ddim",),
            defaults={"steps": 5, "guidance": 1.0},
            fixed={"damping": 0.0},
            load=partial(load_pipeline, "regennet.ReleasedReGenNetPipeline"),
        ),
        mark="cmo_process.poseEmbedding.",
        loss="Of SMPL-X's 55 joints, only the 22 of the body are kept.",
        modes=_regennet_modes,
    ),
    Release(
        method=Method(
            name="interformer",
            label="InterFormer",
            summary="The authors' InterFormer: the person who reacts, pose after pose.",
            tasks=("react",),
            takes=frozenset({"actor", "first pose"}),
            samplers=("ddim",),
            defaults={"steps": 1},
            fixed={"steps": 1, "guidance": 1.0, "damping": 0.0, "sampler": "ddim"},
            load=partial(load_pipeline, "interformer.ReleasedInterFormerPipeline"),
        ),
        mark="decoder.layers.0.attn_space_1.",
        loss="It sees 15 of the 22 joints, at 15 frames a second.",
    ),
    Release(
        method=Method(
            name="bigraphdiff",
            label="BiGraphDiff",
            summary="The authors' BiGraphDiff: two people from a sentence; 1000 steps sample as in the paper.",
            tasks=("generate",),
            takes=frozenset({"words"}),
            defaults={"guidance": 1.0, "steps": 50},
            fixed={"damping": 0.0, "guidance": 1.0},
            load=partial(load_pipeline, "bigraphdiff.ReleasedBiGraphDiffPipeline"),
        ),
        mark="temporal_decoder_blocks.0.ca_block_1.",
        loss="A Kinect's 25 joints become 22 on constant bones.",
    ),
)
RELEASES = {release.method.name: release for release in _RELEASES}
"""By the name that a table of the settings gives as its method."""


def released_method(entry: Entry) -> Method:
    """The method of an entry with released files; the checkpoint's names and shapes are looked at.

    Raises:
        InputError: if the method is unknown, a file is missing or damaged, belongs to another network, or the
            network can never fit into this machine's memory.
    """
    release = RELEASES.get(entry.method)
    if release is None:
        raise InputError(f"there is no method {entry.method!r:.40}: choose one of {', '.join(RELEASES)}.")
    for role in release.needed:
        entry.file(role)
    outline = outline_of(entry.file("checkpoint"), release.method.label)
    _check_network(entry, release, outline)
    parameters = sum(math.prod(shape) for name, shape in outline.items() if name.startswith(release.kept))
    loading = 4 * parameters * LOADING + RESERVE
    _check_memory(entry.name, loading, total_memory())
    return replace(
        release.method,
        name=entry.name,
        label=entry.label,
        summary=f"{release.method.summary} {release.loss} {parameters / 1e6:.0f} million parameters, about "
        f"{loading / 1e9:.1f} GB of memory.",
        takes=release.method.takes | ({"words"} if entry.labels else set()),
        modes={mode: f"{entry.label}{ending}" for mode, ending in release.modes(outline).items()},
        load=partial(_load, entry, release, loading),
    )


def _check_network(entry: Entry, release: Release, outline: Outline) -> None:
    if any(release.mark in name for name in outline):
        return
    name = entry.files["checkpoint"].name
    other = next((o for o in RELEASES.values() if any(o.mark in name for name in outline)), None)
    known = f"it is {other.method.label}'s" if other else f"it has no {release.mark}* tensors"
    raise InputError(
        f"{name} is not a checkpoint of {release.method.label}: {known}. Correct `method` or `files` of "
        f"[models.{entry.name}]."
    )


def _load(entry: Entry, release: Release, loading: float, folder: Path) -> Pipeline:
    """The pipeline; ``folder`` is that of shipped weights, which it does not need."""
    _check_memory(entry.name, loading, free_memory())
    return release.method.load(entry)


# ---- what a checkpoint holds and takes --------------------------------------------------------------


def _check_memory(name: str, loading: float, free: float) -> None:
    """Raises InputError if a network whose loading takes so many bytes does not fit into those that are free."""
    if loading > free:
        raise InputError(
            f"The model {name} needs about {loading / 1e9:.1f} GB of memory and {free / 1e9:.1f} GB are free: "
            "end other programs, or choose a smaller model or a larger machine."
        )


def free_memory() -> float:
    """Bytes that programs can still take; all of the machine's where the system does not say what is free."""
    try:
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * int(line.split()[1])
    except (OSError, ValueError, IndexError):
        pass
    return total_memory()


def total_memory() -> float:
    """Bytes of memory of the machine; infinite where the system does not say."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError, AttributeError):
        return math.inf


def outline_of(path: Path, network: str) -> Outline:
    """The outline of a checkpoint; imports torch.

    Raises:
        WeightsError: if the file cannot be read as plain tensors, see :func:`models.released.read_tensors`.
    """
    from models.released import read_tensors

    return {name: tuple(tensor.shape) for name, tensor in read_tensors(path, network=network).items()}
