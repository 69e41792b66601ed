"""The virtual agent: recognises one person's gesture and has InterGen answer it."""

from __future__ import annotations

import os
from pathlib import Path

from webdemo.inference.method import Method, Pipeline

PREDICTOR_VARIABLE = "PASDEDEUX_AGENT_PREDICTOR"
"""Environment variable that names the method that looks two seconds ahead: motion-mlp, the default, or mawgan."""


def load(folder: Path, predictor: Pipeline, partner: Pipeline) -> Pipeline:
    """The pipeline of a weights folder; imports torch."""

    from webdemo.inference.pipelines.agent import AgentPipeline

    return AgentPipeline(folder, predictor, partner)  # type: ignore[arg-type]


METHOD = Method(
    name="agent",
    label="Virtual agent",
    summary="Recognises the gesture from what it sees and predicts, and has InterGen answer; it takes no words.",
    tasks=("react",),
    takes=frozenset({"actor"}),
    weights="agent",
    needs=(os.environ.get(PREDICTOR_VARIABLE) or "motion-mlp", "intergen"),
    load=load,
)
