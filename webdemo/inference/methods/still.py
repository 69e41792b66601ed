"""Zero velocity: the last pose, held. The baseline of every table of prediction."""

from __future__ import annotations

from pathlib import Path

from webdemo.inference.method import Method, Pipeline


def load(folder: Path) -> Pipeline:
    """The pipeline of a weights folder; imports torch."""

    from webdemo.inference.pipelines.predictor import PredictorPipeline

    return PredictorPipeline(None)


METHOD = Method(
    name="still",
    label="Zero velocity (the last pose, held)",
    summary="Holds the last pose: the baseline that a prediction has to beat.",
    tasks=("predict",),
    takes=frozenset({"past"}),
    seconds=(0.5, 4.0),
    load=load,
)
