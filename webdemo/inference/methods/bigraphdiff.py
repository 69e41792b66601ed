"""BiGraphDiff: two people from a class."""

from __future__ import annotations

from functools import partial

from webdemo.inference.method import Method, load_pipeline

METHOD = Method(
    name="bigraphdiff",
    label="BiGraphDiff",
    summary="Generates two people from a class; a class cannot name a hand, a manner or an order.",
    tasks=("generate",),
    takes=frozenset({"class"}),
    defaults={"guidance": 1.8, "steps": 50},
    weights="bigraphdiff",
    load=partial(load_pipeline, "bigraphdiff.BiGraphDiffPipeline"),
)
