"""The nearest recorded reaction: no network at all, and what a network has to beat."""

from __future__ import annotations

from functools import partial

from webdemo.inference.method import Method, load_pipeline

FOLDER_VARIABLE = "PASDEDEUX_REACTIONS"
"""Environment variable that names a folder of recorded pairs, used in place of the shipped ones."""

METHOD = Method(
    name="nearest",
    label="Nearest recorded reaction",
    summary="Plays the recorded answer to the recording that is most like the given motion. Here it knows twelve "
    "stretches of salsa and one handshake, so it suits dances; it is as good as its recordings.",
    tasks=("react",),
    takes=frozenset({"actor", "first pose"}),
    fixed={"steps": 1, "guidance": 1.0, "damping": 0.0, "sampler": "ddim"},
    defaults={"steps": 1},
    seconds=(1.0, 60.0),
    weights="nearest",
    load=partial(load_pipeline, "nearest.NearestPipeline"),
)
