"""ReGenNet: one person's reactor, in sight of the whole motion or frame by frame."""

from __future__ import annotations

from pathlib import Path

from webdemo.inference.method import Method, Pipeline


def load(folder: Path) -> Pipeline:
    """The pipeline of a weights folder; imports torch."""

    from webdemo.inference.pipelines.regennet import ReGenNetPipeline

    return ReGenNetPipeline(folder)


METHOD = Method(
    name="regennet",
    label="ReGenNet",
    summary="Generates the person who reacts in 5 denoising steps. Offline it sees the whole motion; online it works "
    "frame by frame.",
    tasks=("react",),
    takes=frozenset({"words", "actor", "first pose"}),
    modes={"offline": "ReGenNet, offline", "online": "ReGenNet, online"},
    defaults={"steps": 5},
    samplers=("ddim",),
    weights="regennet",
    load=load,
)
