"""Zero velocity: the last pose, held. The baseline of every table of prediction."""

from __future__ import annotations

from webdemo.inference.method import Method, load_pipeline

METHOD = Method(
    name="still",
    label="Zero velocity (the last pose, held)",
    summary="Holds the last pose: the baseline that a prediction has to beat.",
    tasks=("predict",),
    takes=frozenset({"past"}),
    seconds=(0.5, 4.0),
    load=lambda _: load_pipeline("predictor.PredictorPipeline", None),
)
