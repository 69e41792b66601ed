"""PredictiveMA-WGAN: what comes next, for one person or two."""

from __future__ import annotations

from functools import partial

from webdemo.inference.method import Method, load_pipeline

METHOD = Method(
    name="mawgan",
    label="PredictiveMA-WGAN",
    summary="Predicts with PredictiveMA-WGAN from Chopin's thesis, one second at a time.",
    tasks=("predict",),
    takes=frozenset({"past"}),
    seconds=(0.5, 4.0),
    weights="mawgan",
    load=partial(load_pipeline, "predictor.PredictorPipeline"),
)
