"""ReGenNet: one person's reactor, in sight of the whole motion or frame by frame."""

from __future__ import annotations

from functools import partial

from webdemo.inference.method import Method, load_pipeline

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
    load=partial(load_pipeline, "regennet.ReGenNetPipeline"),
)
