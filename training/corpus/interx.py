"""Inter-X for ReGenNet as published: ``python -m training.corpus.interx --data DIR --out FILE``.

The data set (Xu et al. 2024) is not part of this project; whoever has it can train on it. Expected are
``motions/NAME/P1.npz`` and ``P2.npz``, SMPL-X parameters: ``root_orient``, ``pose_body`` and ``trans``, and
``pose_lhand`` and ``pose_rhand`` where they are given. The result holds both people of every motion as ReGenNet sees
them (:mod:`models.regennet.released`), at 30 frames a second, the actor first.

``interaction_order.pkl``, which says who acts, is a pickle and is not opened: ``--second-acts`` names a text file with
the names of the motions in which P2 does. Bones are an average adult's, since SMPL-X's body model may not be shipped.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import scipy  # its parts are loaded with their first use
import torch
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import Tensor

from models.regennet.released import JOINTS, rows_of
from motion import Clip, InputError
from motion.formats import read_pair
from motion.formats.arrays import load_members, numbers
from motion.formats.files import replacing
from motion.transforms import canonicalize, heading, heading_matrix
from training.core.shell import exit_code

Array = NDArray[np.floating]

FPS = 30.0
SHORTEST = 30
"""Frames; a shorter motion is left out."""
HANDS = {"pose_lhand": 25, "pose_rhand": 40}
"""First of the fifteen joints of each hand among SMPL-X's 55; jaw and eyes stay at rest."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """Motions of two people as ReGenNet's rows.

    Attributes:
        frames: (ΣT, 2, 56, 6) float16, one motion after the other, the actor first.
        starts: (N + 1,) first frame of each motion, and the end.
    """

    frames: Tensor = field(repr=False)
    starts: Tensor

    def __len__(self) -> int:
        return len(self.starts) - 1

    def __getitem__(self, number: int) -> Tensor:
        """Both people of a motion, (T, 2, 56, 6)."""
        return self.frames[int(self.starts[number]) : int(self.starts[number + 1])]


def read_interx(data: Path, *, second_acts: Collection[str] = ()) -> Iterator[Array]:
    """Both people of every motion, (T, 2, 56, 6); what cannot be read is reported and left out.

    The actor stands at the origin at first and faces +Z.

    Raises:
        InputError: if the folder holds no motions of two people.
    """
    folders = sorted(path.parent for path in (data / "motions").glob("*/P1.npz"))
    if not folders:
        raise InputError(f"{data} holds no motions/*/P1.npz: give Inter-X' folder.")
    for folder in folders:
        files = [folder / "P1.npz", folder / "P2.npz"]
        if folder.name in second_acts:
            files.reverse()
        try:
            rows = _rows_of(files)
        except InputError as error:
            print(f"left out: {folder.name}: {error}", file=sys.stderr)
            continue
        if len(rows) >= SHORTEST:
            yield rows


def _rows_of(files: list[Path]) -> Array:
    """The people of two files, the first of whom acts: (T, 2, 56, 6)."""
    duet = read_pair(*files)
    stride = max(1, round(duet.fps / FPS))
    placed = canonicalize(duet.positions.astype(np.float64))[:, ::stride]
    level = heading_matrix(-heading(duet.positions[0, 0]))
    people = zip(files, duet.people, placed, strict=True)
    return np.stack(
        [
            rows_of(_rotations(file, clip, level)[: duet.num_frames : stride], person[:, 0])
            for file, clip, person in people
        ],
        axis=1,
    )


def _rotations(file: Path, clip: Clip, level: Array) -> Array:
    """(T, 55, 3, 3) rotations against the parents, the root's turned by ``level``; jaw and eyes at rest."""
    if clip.rotations is None:
        raise InputError(f"{file.name} gives no rotations: SMPL-X parameters are needed.")
    found = np.tile(np.eye(3), (clip.num_frames, JOINTS, 1, 1))
    found[:, : clip.skeleton.num_joints] = clip.rotations
    found[:, 0] = level @ found[:, 0]
    for name, values in load_members(file.read_bytes(), file.name, HANDS).items():
        vectors = numbers(values, f"{file.name}, {name}")
        if vectors.size != 45 * len(vectors) or len(vectors) < clip.num_frames:
            raise InputError(f"{file.name}: {name} must be (frames, 45), as many frames as trans.")
        turns = scipy.spatial.transform.Rotation.from_rotvec(vectors[: clip.num_frames].reshape(-1, 3))
        found[:, HANDS[name] : HANDS[name] + 15] = turns.as_matrix().reshape(-1, 15, 3, 3)
    return found


def write_pairs(motions: list[Array], path: Path) -> None:
    """Writes the file of :func:`load_pairs`."""
    starts = np.cumsum([0, *(len(motion) for motion in motions)])
    frames = torch.cat([torch.from_numpy(motion).half() for motion in motions])
    with replacing(path) as temporary:
        save_file({"frames": frames, "starts": torch.from_numpy(starts)}, temporary)


def load_pairs(path: Path) -> Pairs:
    """Motions that :func:`main` wrote; the frames are mapped from the file.

    Raises:
        InputError: if the file is missing or another one.
    """
    try:
        tensors = load_file(path)
        return Pairs(tensors["frames"], tensors["starts"])
    except (OSError, KeyError, SafetensorError) as error:
        raise InputError(f"{path} is not a file of `python -m training.corpus.interx` ({error}).") from error


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(prog="python -m training.corpus.interx", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="Inter-X' folder")
    parser.add_argument("--out", type=Path, required=True, help="file of the motions (.safetensors)")
    parser.add_argument("--second-acts", type=Path, help="text file of the motions in which P2 acts")
    options = parser.parse_args(argv)

    def job() -> None:
        names = options.second_acts.read_text(encoding="utf-8").split() if options.second_acts else ()
        motions = list(read_interx(options.data, second_acts=set(names)))
        if not motions:
            raise InputError(f"No motion of {options.data} could be read, or none lasts a second.")
        write_pairs(motions, options.out)
        print(f"{len(motions)} motions, {sum(map(len, motions)) / FPS / 3600:.2f} hours")

    return exit_code(job)


if __name__ == "__main__":
    raise SystemExit(main())
