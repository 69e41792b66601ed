"""InterFormer: one person's reactor, pose after pose from a first one."""

from __future__ import annotations

from functools import partial

from webdemo.inference.method import Method, load_pipeline

METHOD = Method(
    name="interformer",
    label="InterFormer",
    summary="Generates the person who reacts, pose after pose, like people in front of a Kinect; it takes no words.",
    tasks=("react",),
    takes=frozenset({"actor", "first pose"}),
    fixed={"steps": 1, "guidance": 1.0, "damping": 0.0, "sampler": "ddim"},
    defaults={"steps": 1},
    seconds=(1.0, 60.0),
    weights="interformer",
    load=partial(load_pipeline, "interformer.InterFormerPipeline"),
)
