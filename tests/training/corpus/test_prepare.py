"""Prepared scenes keep the sentences of each person and the beats, and corpora join."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from models.motion_tokens import TokenLayout
from training import prepare
from training.corpus import build
from training.corpus.cues import Beat, Label, Scene, label

BEAT = {"start": 0, "end": 70, "acts": ["wave", "stand"], "captions": ["A wave."]}
LATE = {"start": 69, "end": 70, "acts": ["bow", "stand"], "captions": ["A bow."]}


def scene(seed: int) -> Scene:
    rng = np.random.default_rng(seed)
    positions = np.cumsum(0.001 * rng.normal(size=(2, 70, 22, 3)), axis=1).astype(np.float32)
    captions = [f"Scene {seed}, sentence {k}." for k in range(6)]
    alone = ([f"a {seed} {k}" for k in range(6)], [])
    made = Scene(positions, "wave", ("one",), "train", captions=captions, alone=alone, beats=[BEAT, LATE])
    made.label = label([Beat(("wave", "stand-still"), 0, 70, relation="while")], 70)
    return made


def written(folder: Path, seed: int) -> Path:
    build.save([scene(seed)], folder)
    return folder


def test_sentences_of_each_person_and_beats_are_kept_and_cut(tmp_path: Path) -> None:
    (row,) = prepare.prepare(written(tmp_path, 1), TokenLayout(), captions=2).rows
    assert len(row["captions"]) == 2 and set(row["captions"]) <= set(scene(1).captions)
    assert len(row["alone"][0]) == 2 and row["alone"][1] == []
    assert [beat["acts"] for beat in row["beats"]] == [["wave", "stand"]]
    frames = TokenLayout().num_frames(row["tokens"])
    assert row["beats"][0]["end"] == frames < 70


def test_the_label_has_the_frames_of_the_prepared_scene(tmp_path: Path) -> None:
    made = scene(1)
    beats = [
        Beat(("walk-up", "stand-still"), 0, 30, relation="while", minor=True),
        Beat(("wave", "stand-still"), 30, 70, relation="while"),
        Beat(("bow", "nod"), 69, 70, relation="while"),
    ]
    made.label = label(beats, 70)
    build.save([made], tmp_path)
    scenes = prepare.prepare(tmp_path, TokenLayout())
    out = tmp_path / "scenes.safetensors"
    prepare.save(scenes, out)
    (row,) = prepare.load(out).rows
    frames = TokenLayout().num_frames(row["tokens"])
    known = Label.model_validate(row["label"])
    told = [(act.agents, act.act, *known.spans[act.id]) for act in known.plan.acts]
    assert told == [
        (("a",), "walk-up", 0, 30),
        (("b",), "stand-still", 0, 30),
        (("a",), "wave", 30, frames),
        (("b",), "stand-still", 30, frames),
    ]
    assert known.minor == ("1", "2") and known.beats[-1] == ()
