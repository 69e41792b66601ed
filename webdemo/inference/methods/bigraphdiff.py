"""BiGraphDiff: two people from a class."""

from __future__ import annotations

from pathlib import Path

from webdemo.inference.method import Method, Pipeline


def load(folder: Path) -> Pipeline:
    """The pipeline of a weights folder; imports torch."""

    from webdemo.inference.pipelines.bigraphdiff import BiGraphDiffPipeline

    return BiGraphDiffPipeline(folder)


METHOD = Method(
    name="bigraphdiff",
    label="BiGraphDiff",
    summary="Generates two people from a class; a class cannot name a hand, a manner or an order.",
    tasks=("generate",),
    takes=frozenset({"class"}),
    defaults={"guidance": 1.8, "steps": 50},
    shares_passes=True,
    weights="bigraphdiff",
    load=load,
)
