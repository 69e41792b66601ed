"""Released checkpoints of the papers as methods."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from motion import InputError
from webdemo.inference.method import Input, Method, Pipeline, Task, load_pipeline

from .cost import Cost, Outline, cost_of, outline_of, total_memory
from .entries import Entry


@dataclass(frozen=True, kw_only=True)
class Release:
    """A network whose authors released a checkpoint.

    Attributes:
        network: its name.
        mark: part of its tensors' names, as in :data:`models.released.MARKS`.
        pipeline: module and class in :mod:`webdemo.inference.pipelines`.
        summary: one sentence on what it does.
        loss: one sentence on what its representation loses here.
        tasks, takes, seconds, samplers, defaults, fixed, shares_passes: as in :class:`Method`.
        needed: roles of the files that it cannot do without.
        kept: beginnings of the names of tensors that are loaded; all by default.
        moving: part of the names of the matrices that multiply every frame.
        passes: people and halves of the guidance that a step computes.
        modes: outline → the method's modes, mode → ending of its label.
    """

    network: str
    mark: str
    pipeline: str
    summary: str
    loss: str
    tasks: tuple[Task, ...]
    takes: frozenset[Input]
    samplers: tuple[str, ...] = ("ddim", "dpm++")
    defaults: Mapping[str, Any] = field(default_factory=dict)
    fixed: Mapping[str, Any] = field(default_factory=dict)
    shares_passes: bool = False
    needed: tuple[str, ...] = ("checkpoint",)
    kept: tuple[str, ...] = ("",)
    moving: str
    passes: int
    modes: Callable[[Outline], dict[str, str]] = lambda outline: {"offline": ""}


def _regennet_modes(outline: Outline) -> dict[str, str]:
    online = any("seqTransDecoder." in name for name in outline)
    return {"offline": ", whole motion", "online": ", frame by frame"} if online else {"offline": ""}


RELEASES: dict[str, Release] = {
    "intergen": Release(
        network="InterGen",
        mark="decoder.net.blocks.",
        pipeline="intergen.ReleasedInterGenPipeline",
        summary="The authors' InterGen: two people from a sentence, or a partner for a given person.",
        loss="Of its 262 numbers a person and frame the positions are kept.",
        tasks=("generate", "react"),
        takes=frozenset({"words", "actor", "either role"}),
        defaults={"guidance": 3.5, "steps": 50},
        fixed={"damping": 0.0},
        shares_passes=True,
        needed=("checkpoint", "mean", "std"),
        kept=("model.",),
        moving="decoder.net.blocks.",
        passes=4,
    ),
    "regennet": Release(
        network="ReGenNet",
        mark="cmo_process.poseEmbedding.",
        pipeline="regennet.ReleasedReGenNetPipeline",
        summary="The authors' ReGenNet: the person who reacts to a given one.",
        loss="Of SMPL-X's 55 joints the 22 of the body are kept.",
        tasks=("react",),
        takes=frozenset({"actor"}),
        samplers=("ddim",),
        defaults={"steps": 5, "guidance": 1.0},
        fixed={"damping": 0.0},
        moving=".layers.",
        passes=1,
        modes=_regennet_modes,
    ),
    "interformer": Release(
        network="InterFormer",
        mark="decoder.layers.0.attn_space_1.",
        pipeline="interformer.ReleasedInterFormerPipeline",
        summary="The authors' InterFormer: the person who reacts, pose after pose.",
        loss="It sees 15 of the 22 joints, at 15 frames a second.",
        tasks=("react",),
        takes=frozenset({"actor", "first pose"}),
        samplers=("ddim",),
        defaults={"steps": 1},
        fixed={"steps": 1, "guidance": 1.0, "damping": 0.0, "sampler": "ddim"},
        moving=".layers.",
        passes=1,
    ),
    "bigraphdiff": Release(
        network="BiGraphDiff",
        mark="temporal_decoder_blocks.0.ca_block_1.",
        pipeline="bigraphdiff.ReleasedBiGraphDiffPipeline",
        summary="The authors' BiGraphDiff: two people from a sentence; 1000 steps sample as in the paper.",
        loss="A Kinect's 25 joints become 22 on constant bones.",
        tasks=("generate",),
        takes=frozenset({"words"}),
        defaults={"guidance": 1.0, "steps": 50},
        fixed={"damping": 0.0, "guidance": 1.0},
        moving="temporal_decoder_blocks.",
        passes=1,
    ),
}
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
    outline = outline_of(entry.file("checkpoint"), release.network)
    _check_network(entry, release, outline)
    cost = _cost(release, outline)
    cost.check(entry.name, total_memory())
    return Method(
        name=entry.name,
        label=entry.label,
        summary=f"{release.summary} {release.loss} {cost.sentence()}",
        tasks=release.tasks,
        takes=release.takes | ({"words"} if entry.labels else set()),
        modes={mode: f"{entry.label}{ending}" for mode, ending in release.modes(outline).items()},
        defaults=release.defaults,
        fixed=release.fixed,
        samplers=release.samplers,
        shares_passes=release.shares_passes,
        load=partial(_load, entry, release, cost),
    )


def _check_network(entry: Entry, release: Release, outline: Outline) -> None:
    if any(release.mark in name for name in outline):
        return
    name = entry.files["checkpoint"].name
    other = next((o for o in RELEASES.values() if any(o.mark in name for name in outline)), None)
    known = f"it is {other.network}'s" if other else f"it has no {release.mark}* tensors"
    raise InputError(
        f"{name} is not a checkpoint of {release.network}: {known}. Correct `method` or `files` of "
        f"[models.{entry.name}]."
    )


def _cost(release: Release, outline: Outline) -> Cost:
    loaded = {name: shape for name, shape in outline.items() if name.startswith(release.kept)}
    steps = int(release.defaults.get("steps", 1))
    return cost_of(loaded, release.moving, passes=release.passes, steps=steps)


def _load(entry: Entry, release: Release, cost: Cost, folder: Path) -> Pipeline:
    """The pipeline; ``folder`` is that of shipped weights, which it does not need."""
    cost.check(entry.name)
    return load_pipeline(release.pipeline, entry)
