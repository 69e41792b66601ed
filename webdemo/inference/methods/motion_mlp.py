"""Motion MLP: what comes next, for one person or two."""

from __future__ import annotations

from functools import partial

from webdemo.inference.method import Method, load_pipeline

METHOD = Method(
    name="motion-mlp",
    label="Motion MLP",
    summary="Predicts with a residual network over cosine coefficients, one second at a time.",
    tasks=("predict",),
    takes=frozenset({"past"}),
    seconds=(0.5, 4.0),
    weights="motion-mlp",
    load=partial(load_pipeline, "predictor.PredictorPipeline"),
)
