"""InterGen: two people from a sentence, or one person's partner."""

from __future__ import annotations

from functools import partial

from webdemo.inference.method import Method, load_pipeline

METHOD = Method(
    name="intergen",
    label="InterGen",
    summary="Makes two people from a sentence, or a partner for one person whose whole motion it sees first.",
    tasks=("generate", "react", "scene"),
    takes=frozenset({"words", "actor", "either role"}),
    modes={"offline": "InterGen, person to person"},
    weights="intergen",
    load=partial(load_pipeline, "intergen.InterGenPipeline"),
)
