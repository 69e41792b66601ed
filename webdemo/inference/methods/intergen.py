"""InterGen: two people from a sentence, or one person's partner."""

from __future__ import annotations

from pathlib import Path

from webdemo.inference.method import Method, Pipeline


def load(folder: Path) -> Pipeline:
    """The pipeline of a weights folder; imports torch."""

    from webdemo.inference.pipelines.intergen import InterGenPipeline

    return InterGenPipeline(folder)


METHOD = Method(
    name="intergen",
    label="InterGen",
    summary="Generates two people from a sentence, or a partner for one person from the whole motion.",
    tasks=("generate", "react", "scene"),
    takes=frozenset({"words", "actor", "either role"}),
    modes={"offline": "InterGen, person to person"},
    shares_passes=True,
    weights="intergen",
    load=load,
)
