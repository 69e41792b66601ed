"""The compact ReGenNet's trainer, on scenes that take a moment to make."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import torch
from safetensors.torch import load_file

from models.intergen.compact import CaptionBank, CompactConfig, CompactInterGen
from models.intergen.compact import save_folder as save_intergen
from models.motion_tokens import FEATURES, TokenLayout, canonical_control, decode, mirror_control
from models.regennet.compact import CompactReGenNet
from models.weights_io import load_network
from motion import SMPL22, InputError
from tests.training.trainers.runs import flags, prepared, resumed
from training import prepare
from training.prepare import Scenes
from training.trainers import regennet
from training.trainers.regennet import Settings, Trainer, interaction_loss
from training.trainers.regennet_data import knot_positions, seen_rows

SETTINGS = Settings(latent_dim=16, ff_size=16, num_layers=1, num_heads=2, batch=4, steps=6, warmup=2)
SIZES = flags(SETTINGS, "latent_dim", "ff_size", "num_layers", "num_heads", "batch", "warmup")


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Scenes:
    """Two people who sway, eight times."""

    def edit(rows: list[dict[str, Any]]) -> None:
        for row in rows:
            row |= {"split": "train", "captions": ["One person waves the left hand."], "events": {}}

    return prepare.load(prepared(tmp_path_factory.mktemp("made"), scenes=8, edit=edit))


@pytest.fixture(scope="module")
def words(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A shipped InterGen, tiny and untrained, whose conditioner is taken over."""
    folder = tmp_path_factory.mktemp("intergen")
    model = CompactInterGen(
        CompactConfig(latent_dim=16, ff_size=16, num_layers=1, num_heads=2, cond_dim=16, text_layers=1)
    )
    save_intergen(folder, model, CaptionBank(("They wave.",), torch.ones(1, 384), far=0.5))
    return folder


def test_a_run_that_stops_goes_on_as_if_it_never_had(scenes: Scenes, words: Path, tmp_path: Path) -> None:
    _, kept = resumed(lambda out: Trainer(scenes, SETTINGS, out, words=words), tmp_path)
    fresh = Trainer(scenes, SETTINGS, tmp_path / "fresh", words=words).model.state_dict()
    moved = {name for name, value in fresh.items() if not torch.equal(value, kept[f"model/{name}"])}
    assert "network.output_process.poseFinal.weight" in moved
    assert not any(name.startswith("conditioner.") for name in moved)
    with pytest.raises(InputError, match="run of other settings"):
        Trainer(scenes, replace(SETTINGS, learning_rate=1e-3), tmp_path / "whole", words=words)


def test_the_command_trains_and_ships(scenes: Scenes, words: Path, tmp_path: Path) -> None:
    file, folder = tmp_path / "scenes.safetensors", tmp_path / "regennet"
    prepare.save(scenes, file)
    call = ["--scenes", str(file), "--out", str(tmp_path / "run"), "--words", str(words), *SIZES]
    assert regennet.main([*call, "--steps", "2", "--export", str(folder)]) == 0
    model, source = load_network(folder, CompactReGenNet)
    assert source.meta["trained_steps"] == 2
    averaged = load_file(tmp_path / "run" / "last.safetensors")
    for name, value in model.state_dict().items():
        torch.testing.assert_close(value, averaged[f"ema/{name}"].half().float())
    assert regennet.main([*call, "--num-heads", "3"]) == 2


def test_knots_and_what_rows_see_are_those_of_the_decoded_motion(scenes: Scenes, words: Path, tmp_path: Path) -> None:
    trainer = Trainer(scenes, SETTINGS, tmp_path, words=words)
    control = scenes.scene(scenes.rows[1])[:1]
    positions, _ = decode(control, TokenLayout(4, 1))
    torch.testing.assert_close(knot_positions(control), positions[:, ::4], atol=2e-3, rtol=0)
    model = trainer.model
    seen = (seen_rows(control) - model.actor_mean) / model.actor_std
    rows = model.actor_rows(positions)
    assert rows.shape == (1, control.shape[1], 132)
    shown = (rows - seen).abs() * model.actor_std
    assert shown.max() < 5e-3
    assert control.shape[-1] == FEATURES


def test_the_interaction_loss_is_that_of_the_paper() -> None:
    """A shift counts as translation alone, a turn of the whole body as pose and orientation."""
    rest = torch.tensor(SMPL22.rest_positions()).float()
    actor = rest.expand(1, 3, -1, -1)
    reactor = (rest * torch.tensor([-1.0, 1, -1]) + torch.tensor([0.0, 0, 1.0])).expand(1, 3, -1, -1)
    mask = torch.tensor([[1.0, 1.0, 0.0]])
    assert interaction_loss(reactor, reactor, actor, mask) == 0
    shifted = reactor + torch.tensor([0.3, 0.0, 0.4])
    torch.testing.assert_close(interaction_loss(shifted, reactor, actor, mask), torch.tensor([0.25]))
    root = reactor[..., :1, :]
    turned = (reactor - root) * torch.tensor([-1.0, 1.0, -1.0]) + root
    pose = (turned - reactor).square().sum((-1, -2))[0, 0]
    torch.testing.assert_close(interaction_loss(turned, reactor, actor, mask), (pose + 4)[None])
    last = torch.cat([reactor[:, :2], shifted[:, 2:]], dim=1)
    assert interaction_loss(last, reactor, actor, mask) == 0, "the last frame is not real"


def test_batches_hold_the_scenes_as_they_are_mirrored_or_from_a_later_knot_on(
    scenes: Scenes, words: Path, tmp_path: Path
) -> None:
    data = Trainer(scenes, replace(SETTINGS, crop=0.5, cond_drop_prob=0.5), tmp_path, words=words).data
    assert set(data.captions.index) == {f"One person waves the {side} hand." for side in ("left", "right")}
    seen = set()
    for step in range(6):
        batch = data.batch(step)
        actor, reactor, mask = data.people(batch)
        for i in range(4):
            rows = int(mask[i].sum())
            two = torch.stack([actor[i, :rows], reactor[i, :rows]])
            errors = {}
            for mirror in (False, True):
                for row in scenes.rows:
                    whole = scenes.scene(row)
                    whole = mirror_control(whole, SMPL22.mirror) if mirror else whole
                    late = whole[:, max(whole.shape[1] - rows, 0) :]
                    if late.shape[1] == rows:
                        late = canonical_control(late) if batch.past[i] else late
                        error = float((two - late).abs().max())
                        errors[mirror] = min(error, errors.get(mirror, error))
            mirrored = min(errors, key=lambda one: errors[one])
            assert errors[mirrored] < 5e-3
            held = reactor[i, rows - 1 : rows].expand(len(reactor[i]) - rows, -1)
            torch.testing.assert_close(reactor[i, rows:], held)
            seen.add((mirrored, bool(batch.past[i]), bool(batch.read[i, 0])))
    assert len(seen) > 5


def test_the_past_becomes_the_networks_own_from_a_step_on(scenes: Scenes, words: Path, tmp_path: Path) -> None:
    settings = replace(SETTINGS, own=1.0, own_after=2, own_growth=2, offline=0.0)
    straight = Trainer(scenes, settings, tmp_path / "a", words=words)
    assert [share(straight, step) for step in range(5)] == [0, 0, 0.5, 1, 1]
    # A network that predicts the mean is near the still people of these scenes.
    terms, _ = resumed(lambda out: Trainer(scenes, settings, out, words=words), tmp_path, stops=3)
    assert terms[0]["own"] == terms[1]["own"] == 0 < terms[3]["own"]
    offline = Trainer(scenes, replace(settings, offline=1.0, own_after=0), tmp_path / "c", words=words)
    assert offline.train_step()["own"] == 0, "offline every row sees all of the actor"


def share(trainer: Trainer, step: int) -> float:
    trainer.step, kept = step, trainer.step
    found = trainer.own_share()
    trainer.step = kept
    return found
