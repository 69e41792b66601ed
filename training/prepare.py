"""Corpus → the tensors a trainer carries: ``python -m training.prepare --corpus DIR --out FILE``.

The corpus (``motions.npy`` + ``index.json``, see :mod:`training.corpus`) becomes one ``.safetensors`` file:
spline control points of every scene in float16, and as JSON in its metadata the captions, families, splits
and events. Five hours of two people take under 40 MB.
"""

from __future__ import annotations

import argparse
import json
import random
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from models.motion_tokens import TokenLayout, encode, foot_contacts, mirror_control
from motion import FPS, SMPL22, InputError
from training.core.checkpoint import read_tensors, write_tensors
from training.core.handedness import leading_hand
from training.core.shell import exit_code
from training.corpus.cues import Label

ROOT_SCALE = 0.5  # metres
LONGEST = 10.0
"""Seconds of a scene; of a longer one the beginning is taken."""


def sentence_lists(row: dict[str, Any]) -> tuple[list[str], list[str], list[str]]:
    """A scene's sentences for both people, for a alone and for b alone; there may be none of the last two."""
    a, b = row.get("alone") or ([], [])
    return row["captions"], a, b


@dataclass
class Scenes:
    """Prepared scenes.

    Attributes:
        control: (total knots, 2, 70) float16, the scenes one after the other.
        rows: for each scene {"start", "tokens", "family", "captions", "alone", "split", "events", "sources",
            "beats", "label", "hand"}, see :class:`training.corpus.cues.Scene` and
            :func:`training.core.handedness.leading_hand`. The label is a :class:`training.corpus.cues.Label` whose
            frames are those of the prepared scene.
        layout: frames a knot and knots a token.
    """

    control: Tensor
    rows: list[dict[str, Any]]
    layout: TokenLayout

    def scene(self, row: dict[str, Any]) -> Tensor:
        """(2, knots, 70) float32 control points of one scene."""
        knots = row["tokens"] * self.layout.knots_per_token
        return self.control[row["start"] : row["start"] + knots].float().transpose(0, 1)

    def split(self, name: str) -> list[dict[str, Any]]:
        """The rows of a split: "train" or "test"."""
        return [row for row in self.rows if row["split"] == name]


def load_corpus(folder: Path) -> tuple[np.ndarray, list[dict[str, Any]]]:
    """Motions (frames, 2, 22, 3) as a memory map, and the index; raises InputError if either is damaged."""
    try:
        motions = np.load(folder / "motions.npy", mmap_mode="r", allow_pickle=False)
        index = json.loads((folder / "index.json").read_text())
    except (OSError, ValueError) as error:
        raise InputError(
            f"{folder} holds no readable corpus ({error}): build one with `python -m training.corpus`."
        ) from error
    if motions.shape[1:] != (2, 22, 3) or not isinstance(index, list):
        raise InputError(f"{folder} holds another kind of data: build it with `python -m training.corpus`.")
    if any(scene["start"] + scene["frames"] > len(motions) for scene in index):
        raise InputError(f"The index in {folder} names more frames than there are: build the corpus again.")
    return motions, index


def prepare(folder: Path, layout: TokenLayout, captions: int | None = None) -> Scenes:
    """Fits control points to every scene of a corpus; scenes are cut to whole tokens.

    ``captions`` keeps that many of a training scene's sentences, drawn at random.
    """
    rng = random.Random(0)
    motions, index = load_corpus(folder)
    parts, rows, start = [], [], 0
    for entry in index:
        tokens = layout.filled_tokens(min(entry["frames"], round(LONGEST * FPS) + 1))
        frames = layout.num_frames(tokens)
        if frames < FPS:
            continue
        motion = np.array(motions[entry["start"] : entry["start"] + frames], dtype=np.float32)
        positions = torch.from_numpy(motion).transpose(0, 1)
        control = encode(positions, foot_contacts(positions), layout)
        parts.append(control.transpose(0, 1).half())
        kept = ("family", "captions", "alone", "split", "events", "sources", "beats", "label")
        hand = leading_hand(motion.swapaxes(0, 1), entry.get("events"))
        row = {"start": start, "tokens": tokens, "hand": hand} | {key: entry.get(key) for key in kept}
        if captions and row["split"] == "train":
            lists = [row["captions"], *(row["alone"] or ())]
            row["captions"], *row["alone"] = [rng.sample(s, min(captions, len(s))) for s in lists]
        row["label"] = Label.model_validate(row["label"]).cut(frames).row() if row["label"] else None
        row["beats"] = [b | {"end": min(b["end"], frames)} for b in row["beats"] or () if b["start"] < frames]
        if captions and row["split"] == "train":
            for beat in row["beats"]:
                beat["captions"] = rng.sample(beat["captions"], min(captions, len(beat["captions"])))
        rows.append(row)
        start += tokens * layout.knots_per_token
    if not rows:
        raise InputError(f"The corpus in {folder} has no scene of a second or more.")
    return Scenes(torch.cat(parts), rows, layout)


def joined(parts: Sequence[Scenes]) -> Scenes:
    """Several corpora as one; they must have one layout."""
    rows, start = [], 0
    for part in parts:
        rows += [row | {"start": row["start"] + start} for row in part.rows]
        start += len(part.control)
    return Scenes(torch.cat([part.control for part in parts]), rows, parts[0].layout)


def save(scenes: Scenes, path: Path) -> None:
    """Writes prepared scenes; an interrupted write leaves no file of that name."""
    write_tensors(path, {"control": scenes.control}, rows=scenes.rows, layout=asdict(scenes.layout))


def load(path: Path) -> Scenes:
    """Reads what :func:`save` wrote; raises InputError if it is missing or damaged."""
    tensors, known = read_tensors(path, "run `python -m training.prepare`.")
    try:
        return Scenes(tensors["control"], json.loads(known["rows"]), TokenLayout(**json.loads(known["layout"])))
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path} holds no prepared scenes ({error}): run `python -m training.prepare`.") from error


def normalizer(scenes: Scenes) -> tuple[Tensor, Tensor]:
    """Mean and scale (70,) of the training control points and their mirror images.

    The scale is the standard deviation, but for the pelvis' place on the floor, which is held to
    ``ROOT_SCALE``: people who run metres would otherwise make the half metre between two who shake hands a
    trifle, in the loss and under the noise.
    """
    knots = scenes.layout.knots_per_token
    rows = [scenes.control[r["start"] : r["start"] + r["tokens"] * knots] for r in scenes.split("train")]
    control = torch.cat(rows).float().flatten(0, 1)
    control = torch.cat([control, mirror_control(control, SMPL22.mirror)])
    scale = control.std(0).clamp_min(0.01)
    scale[[0, 2]] = scale[[0, 2]].clamp_max(ROOT_SCALE)
    return control.mean(0), scale


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Turn a corpus into the tensors that training reads.")
    parser.add_argument("--corpus", type=Path, required=True, nargs="+", help="folders with motions.npy and index.json")
    parser.add_argument("--out", type=Path, required=True, help="the .safetensors file to write")
    parser.add_argument(
        "--captions", type=int, help="sentences to keep a training scene (all); fewer are sooner encoded"
    )
    options = parser.parse_args(argv)
    return exit_code(lambda: _run(options))


def _run(options: argparse.Namespace) -> None:
    layout = TokenLayout()
    scenes = joined([prepare(folder, layout, captions=options.captions) for folder in options.corpus])
    save(scenes, options.out)
    seconds = len(scenes.control) * layout.frames_per_knot / FPS
    print(f"{len(scenes.rows)} scenes, {seconds / 3600:.2f} hours, {options.out.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    raise SystemExit(main())
