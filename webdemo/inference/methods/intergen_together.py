"""InterGen as a predictor: what two people do next, together."""

from __future__ import annotations

from functools import partial

from webdemo.inference.method import Method, load_pipeline

METHOD = Method(
    name="intergen-together",
    label="InterGen, both together",
    summary="Draws three futures of two people who know of each other; it needs both, and draws others with "
    "another seed.",
    tasks=("predict",),
    takes=frozenset({"past", "two people"}),
    seconds=(0.5, 4.0),
    weights="intergen",
    needs=("intergen", "motion-mlp"),
    load=partial(load_pipeline, "intergen.TogetherPipeline"),
)
