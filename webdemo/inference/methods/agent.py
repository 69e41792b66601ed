"""The virtual agent: recognises one person's gesture and has InterGen answer it."""

from __future__ import annotations

import os
from functools import partial

from webdemo.inference.method import Method, load_pipeline

PREDICTOR_VARIABLE = "PASDEDEUX_AGENT_PREDICTOR"
"""Environment variable that names the method that looks two seconds ahead: motion-mlp, the default, or mawgan."""


METHOD = Method(
    name="agent",
    label="Virtual agent",
    summary="Recognises the gesture from what it sees and predicts, and has InterGen answer; it takes no words.",
    tasks=("react",),
    takes=frozenset({"actor"}),
    weights="agent",
    needs=(os.environ.get(PREDICTOR_VARIABLE) or "motion-mlp", "intergen"),
    load=partial(load_pipeline, "agent.AgentPipeline"),
)
