"""PredictiveMA-WGAN: what comes next, for one person or two."""

from __future__ import annotations

from pathlib import Path

from webdemo.inference.method import Method, Pipeline


def load(folder: Path) -> Pipeline:
    """The pipeline of a weights folder; imports torch."""

    from webdemo.inference.pipelines.predictor import PredictorPipeline

    return PredictorPipeline(folder)


METHOD = Method(
    name="mawgan",
    label="PredictiveMA-WGAN",
    summary="Predicts with PredictiveMA-WGAN from Chopin's thesis, one second at a time.",
    tasks=("predict",),
    takes=frozenset({"past"}),
    seconds=(0.5, 4.0),
    weights="mawgan",
    load=load,
)
