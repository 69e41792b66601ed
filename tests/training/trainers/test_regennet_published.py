"""ReGenNet over SMPL-X' rotations: Inter-X' files become its rows, eq. 3–4 are what is minimised, and runs resume."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation

from models.regennet.released import decode, load_released
from motion import InputError
from motion.kinematics import forward_kinematics
from motion.transforms import canonicalize
from tests.motion.bodies import marching
from tests.motion.formats.test_smpl import interx
from tests.training.trainers.runs import take
from training.corpus import interx as corpus
from training.trainers import regennet_published as published
from training.trainers.regennet_published import Settings, Trainer, interaction_loss, rotations_of

POSITIONS, _ = marching(64)
OTHER = POSITIONS[::-1] * [-1, 1, -1] + np.array([0.2, 0.0, 1.5])
SMALL = Settings(
    latent_dim=128, ff_size=16, num_layers=1, num_heads=1, window=12, batch=2, steps=10, warmup=2
)


def at_120(person: np.ndarray) -> dict[str, np.ndarray]:
    """Inter-X' arrays at its 120 frames a second, every frame four times, with hands that close."""
    arrays = interx(np.repeat(person, 4, axis=0))
    closing = np.linspace(0, 1, 4 * len(person))[:, None] * np.ones(45)
    return arrays | {"pose_lhand": closing, "pose_rhand": -closing}


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("InterX")
    for name, people in (("G1", (POSITIONS, OTHER)), ("G2", (OTHER, POSITIONS))):
        (folder / "motions" / name).mkdir(parents=True)
        for person, positions in zip(("P1", "P2"), people, strict=True):
            np.savez(folder / "motions" / name / f"{person}.npz", **at_120(positions))
    return folder


@pytest.fixture(scope="module")
def motions(data: Path) -> Path:
    out = data / "motions.safetensors"
    assert corpus.main(["--data", str(data), "--out", str(out)]) == 0
    return out


def test_both_people_stand_where_the_actor_s_frame_has_them(motions: Path) -> None:
    pairs = corpus.load_pairs(motions)
    assert [len(pairs[number]) for number in range(len(pairs))] == [64, 64]
    found = decode(pairs[0].float().permute(1, 2, 3, 0))
    wanted = canonicalize(np.stack([POSITIONS, OTHER]))
    np.testing.assert_allclose(found, wanted, atol=0.01)  # half precision, and fitted rotations


def test_fingers_are_kept(motions: Path) -> None:
    rows = corpus.load_pairs(motions)[0].float()
    closed = Rotation.from_rotvec(np.ones(3) * 4 * 63 / 255)
    for joint, turned in ((25, closed), (54, closed.inv())):
        np.testing.assert_allclose(rows[63, 1, joint], turned.as_matrix()[:2].reshape(6), atol=2e-3)
    assert torch.equal(rows[:, :, 22:25], torch.tensor([1.0, 0, 0, 0, 1, 0]).expand(64, 2, 3, 6))


def test_where_the_second_acts_they_come_first(data: Path, motions: Path) -> None:
    first, swapped = corpus.read_interx(data, second_acts={"G2"})
    np.testing.assert_allclose(first, swapped, atol=1e-6)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"pose_lhand": np.zeros((256, 44))}, "pose_lhand must be"),
        ({"pose_rhand": np.zeros((9, 45))}, "pose_rhand must be"),
        ({"pose_rhand": np.full((256, 45), np.nan)}, "NaN"),
        ({"pose_body": np.zeros((256, 60))}, "pose_body must be"),
    ],
)
def test_a_motion_that_cannot_be_read_is_left_out(
    changes: dict[str, np.ndarray], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "motions" / "G3").mkdir(parents=True)
    for person in ("P1", "P2"):
        np.savez(tmp_path / "motions" / "G3" / f"{person}.npz", **at_120(POSITIONS) | changes)
    assert corpus.main(["--data", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    shown = capsys.readouterr().err
    assert "left out: G3" in shown and said in shown


def test_a_folder_or_file_of_something_else_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="Inter-X"):
        list(corpus.read_interx(tmp_path))
    (tmp_path / "other").write_text("words")
    with pytest.raises(InputError, match="is not a file of"):
        corpus.load_pairs(tmp_path / "other")


def test_the_interaction_loss_is_that_of_the_paper() -> None:
    """Eq. 3–4 as written, with the actor, by NumPy."""
    rng = np.random.default_rng(0)

    def person() -> tuple[np.ndarray, np.ndarray, torch.Tensor]:
        turns = Rotation.random(5 * 22, rng=rng).as_matrix().reshape(5, 22, 3, 3)
        root = rng.normal(size=(5, 3))
        return turns, root, torch.from_numpy(corpus.rows_of(turns, root))

    def relative(other: tuple[np.ndarray, np.ndarray, torch.Tensor]) -> list[np.ndarray]:
        joints = [forward_kinematics(turns, np.zeros(3)) for turns in (actor[0], other[0])]
        orientation = actor[0][:, 0].swapaxes(-1, -2) @ other[0][:, 0]
        return [joints[0] - joints[1], orientation, actor[1] - other[1]]

    actor, reactor, made = person(), person(), person()
    parts = zip(relative(reactor), relative(made), strict=True)
    wanted = sum(np.square(true - found).reshape(5, -1).sum(-1) for true, found in parts)
    np.testing.assert_allclose(interaction_loss(made[2], reactor[2]), wanted, rtol=1e-9)


def test_numbers_that_are_no_rotation_become_the_nearest_frame() -> None:
    turns = rotations_of(torch.tensor([[2.0, 0, 0, 5.0, 3.0, 0], [0, 1.0, 0, 0, 0, 1.0]]))
    torch.testing.assert_close(turns[0], torch.eye(3))
    torch.testing.assert_close(turns @ turns.mT, torch.eye(3).expand(2, 3, 3))
    assert torch.all(torch.linalg.det(turns) > 0)


@pytest.mark.parametrize("online", [True, False])
def test_ten_steps_on_two_files_and_on_from_where_it_stopped(
    motions: Path, tmp_path: Path, online: bool
) -> None:
    pairs, settings = corpus.load_pairs(motions), replace(SMALL, online=online)
    whole = take(Trainer(pairs, settings, tmp_path / "whole"), 10)
    take(Trainer(pairs, settings, tmp_path / "halves"), 5)
    again = take(Trainer(pairs, settings, tmp_path / "halves"), 5)
    assert again.step == 10
    for one, other in zip(whole.ema.parameters(), again.ema.parameters(), strict=True):
        assert torch.equal(one, other)


def test_the_weight_of_the_interaction_loss_counts(motions: Path, tmp_path: Path) -> None:
    pairs = corpus.load_pairs(motions)
    runs = [
        Trainer(pairs, replace(SMALL, interaction=weight), tmp_path / str(weight)) for weight in (0.0, 1.0)
    ]
    without, whole = (run.train_step() for run in runs)
    assert without["interaction"] == 0 < whole["interaction"]
    assert without["diffusion"] == whole["diffusion"]
    last = [run.model.output_process.poseFinal.weight for run in runs]
    assert not torch.equal(*last)


def test_the_command_writes_weights_under_the_released_names(motions: Path, tmp_path: Path) -> None:
    sizes = [f"--{name.replace('_', '-')}={getattr(SMALL, name)}" for name in ("latent_dim", "ff_size", "num_layers",
             "num_heads", "window", "batch")]  # fmt: skip
    out = tmp_path / "weights.safetensors"
    given = ["--motions", str(motions), "--out", str(tmp_path / "run"), "--steps", "2", "--export", str(out)]
    assert published.main([*given, "--device", "cpu", *sizes]) == 0
    network = load_released(out)
    assert network.config.online and network.config.rows == 56
    made = network(torch.zeros(1, 56, 6, 4), torch.tensor([3]), torch.zeros(1, 56, 6, 4))
    assert decode(made).shape == (1, 4, 22, 3)
