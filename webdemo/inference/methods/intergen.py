"""InterGen: two people from a sentence, or one person's partner."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

from webdemo.inference.method import WEIGHTS, Input, Method, load_pipeline


def takes(folder: Path) -> frozenset[Input]:
    """The inputs of a network in a weights folder: "plan" only where it reads plans of acts."""
    try:
        reads_plans = json.loads((folder / "config.json").read_text())["model"]["plan_words"]
    except (OSError, ValueError, LookupError, TypeError):
        reads_plans = ()  # the weights say what is wrong when they are loaded
    found: frozenset[Input] = frozenset({"words", "actor", "either role"})
    return found | {"plan"} if reads_plans else found


METHOD = Method(
    name="intergen",
    label="InterGen",
    summary="Generates two people from a sentence, or a partner for one person from the whole motion.",
    tasks=("generate", "react", "scene"),
    takes=takes(WEIGHTS / "intergen"),
    modes={"offline": "InterGen, person to person"},
    shares_passes=True,
    weights="intergen",
    load=partial(load_pipeline, "intergen.InterGenPipeline"),
)
