"""The methods that ship. Importing this module imports no torch."""

from __future__ import annotations

import os
from functools import partial

from webdemo.inference.method import Method, load_pipeline

REACTIONS_VARIABLE = "PASDEDEUX_REACTIONS"
"""Environment variable that names a folder of recorded pairs, used in place of those of the nearest reaction."""
PREDICTOR_VARIABLE = "PASDEDEUX_AGENT_PREDICTOR"
"""Environment variable that names the method that looks two seconds ahead for the virtual agent: motion-mlp, the
default, or mawgan."""

BUILT_IN = (
    Method(
        name="intergen",
        label="InterGen",
        summary="Makes two people from a sentence, or a partner for one person whose whole motion it sees first.",
        tasks=("generate", "react", "scene"),
        takes=frozenset({"words", "actor", "either role"}),
        modes={"offline": "InterGen, person to person"},
        weights="intergen",
        load=partial(load_pipeline, "intergen.InterGenPipeline"),
    ),
    Method(
        name="bigraphdiff",
        label="BiGraphDiff",
        summary="Generates two people from a class; a class cannot name a hand, a manner or an order.",
        tasks=("generate",),
        takes=frozenset({"class"}),
        defaults={"guidance": 1.8, "steps": 50},
        weights="bigraphdiff",
        load=partial(load_pipeline, "bigraphdiff.BiGraphDiffPipeline"),
    ),
    Method(
        name="regennet",
        label="ReGenNet",
        summary="Generates the person who reacts in 5 denoising steps. Offline it sees the whole motion; online it "
        "works frame by frame.",
        tasks=("react",),
        takes=frozenset({"words", "actor", "first pose"}),
        modes={"offline": "ReGenNet, offline", "online": "ReGenNet, online"},
        defaults={"steps": 5},
        samplers=("ddim",),
        weights="regennet",
        load=partial(load_pipeline, "regennet.ReGenNetPipeline"),
    ),
    Method(
        name="interformer",
        label="InterFormer",
        summary="Generates the person who reacts, pose after pose, like people in front of a Kinect; it takes no "
        "words.",
        tasks=("react",),
        takes=frozenset({"actor", "first pose"}),
        fixed={"steps": 1, "guidance": 1.0, "damping": 0.0, "sampler": "ddim"},
        defaults={"steps": 1},
        seconds=(1.0, 60.0),
        weights="interformer",
        load=partial(load_pipeline, "interformer.InterFormerPipeline"),
    ),
    Method(
        name="nearest",
        label="Nearest recorded reaction",
        summary="Takes the recorded answer to the recording that is most like the given motion, in its tempo, and has "
        "InterGen finish it. Here it knows twelve stretches of salsa and one handshake, so it suits dances.",
        tasks=("react",),
        takes=frozenset({"actor", "first pose"}),
        fixed={"guidance": 1.0},
        seconds=(1.0, 60.0),
        weights="nearest",
        needs=("intergen",),
        load=partial(load_pipeline, "nearest.NearestPipeline"),
    ),
    Method(
        name="agent",
        label="Virtual agent",
        summary="Recognises the gesture from what it sees and predicts, and has InterGen answer; it takes no words.",
        tasks=("react",),
        takes=frozenset({"actor"}),
        weights="agent",
        needs=(os.environ.get(PREDICTOR_VARIABLE) or "motion-mlp", "intergen"),
        load=partial(load_pipeline, "agent.AgentPipeline"),
    ),
    Method(
        name="motion-mlp",
        label="Motion MLP",
        summary="A residual network over cosine coefficients, one second at a time. On 200 test windows of people it "
        "knows, it is 8.7 cm off after a second and 17 cm after two; the last pose, held, is 18 and 30 cm "
        "off. Where people stop moving, the held pose is closer.",
        tasks=("predict",),
        takes=frozenset({"past"}),
        seconds=(0.5, 4.0),
        weights="motion-mlp",
        load=partial(load_pipeline, "predictor.PredictorPipeline"),
    ),
    Method(
        name="mawgan",
        label="PredictiveMA-WGAN",
        summary="Predicts with PredictiveMA-WGAN from Chopin's thesis, one second at a time.",
        tasks=("predict",),
        takes=frozenset({"past"}),
        seconds=(0.5, 4.0),
        weights="mawgan",
        load=partial(load_pipeline, "predictor.PredictorPipeline"),
    ),
    Method(
        name="intergen-together",
        label="InterGen, both together",
        summary="Draws several futures of two people who see each other; it needs both, and draws others with "
        "another seed.",
        tasks=("predict",),
        takes=frozenset({"past", "two people"}),
        seconds=(0.5, 4.0),
        weights="intergen",
        needs=("intergen", "motion-mlp"),
        load=partial(load_pipeline, "intergen.TogetherPipeline"),
    ),
    Method(
        name="still",
        label="Zero velocity (the last pose, held)",
        summary="Holds the last pose: the baseline that a prediction has to beat.",
        tasks=("predict",),
        takes=frozenset({"past"}),
        seconds=(0.5, 4.0),
        load=lambda _: load_pipeline("predictor.PredictorPipeline", None),
    ),
)
"""In the order in which the page offers them; the first one for a task is that task's default."""
