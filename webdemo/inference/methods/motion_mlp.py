"""Motion MLP: what comes next, for one person or two."""

from __future__ import annotations

from functools import partial

from webdemo.inference.method import Method, load_pipeline

METHOD = Method(
    name="motion-mlp",
    label="Motion MLP",
    summary="A residual network over cosine coefficients, one second at a time. On 200 recordings of people it knows, "
    "it is 8.7 cm off after a second and 17 cm after two; the last pose, held, is 18 and 30 cm off. Where people stop, "
    "holding is nearer.",
    tasks=("predict",),
    takes=frozenset({"past"}),
    seconds=(0.5, 4.0),
    weights="motion-mlp",
    load=partial(load_pipeline, "predictor.PredictorPipeline"),
)
