"""The trainer of the fast mode: its target is the way of the trained network, and its folder can be drawn from."""

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import pytest
import torch
from safetensors.torch import load_file

from models.diffusion import denoise, make_scheduler
from models.intergen.compact import load_folder
from models.intergen.fast import PASSES
from motion import InputError
from tests.training.trainers.runs import SETTINGS, begin, take, write_corpus
from training import export, prepare
from training.evaluate.judge.draw import Sampling, draw
from training.evaluate.judge.rules import Task
from training.trainers import intergen_fast
from training.trainers.intergen import condition
from training.trainers.intergen_fast import FastSettings, FastTrainer
from webdemo.inference.pipelines.intergen import InterGenPipeline

FAST = FastSettings(rank=4, substeps=2, batch=4, steps=6, warmup=2)


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.set_num_threads(1)
    folder = tmp_path_factory.mktemp("made")
    out = folder / "scenes.safetensors"
    assert prepare.main(["--corpus", str(write_corpus(folder / "corpus")), "--out", str(out)]) == 0
    return out


@pytest.fixture(scope="module")
def run(scenes: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run of the network."""
    out = tmp_path_factory.mktemp("run")
    trainer = begin(scenes, out)
    with torch.no_grad():  # an untrained output layer is zero: nothing would be distilled
        for module in (trainer.model, trainer.ema):
            module.denoiser.out.linear.weight.normal_(std=0.2)
    take(trainer, 1)
    return out


def fast(scenes: Path, run: Path, out: Path, settings: FastSettings = FAST) -> FastTrainer:
    return FastTrainer(prepare.load(scenes), settings, run / "last.safetensors", out, cache=run)


def test_the_target_leads_where_the_trained_network_goes(
    scenes: Path, run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All passes with targets for predictions are the whole sampling with PASSES · substeps DDIM steps."""
    trainer = fast(scenes, run, tmp_path)
    monkeypatch.setattr(intergen_fast, "mixed_precision", lambda _: nullcontext())  # in float32
    batch = trainer.data.batch(0)
    cond = condition(trainer.model, batch)[0].detach()
    noise = torch.randn(batch.x0.shape, generator=torch.Generator().manual_seed(3))
    scale = torch.full((len(noise),), 2.5)

    def predict(x: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
        place = torch.full((len(x),), round(PASSES * (1 - (int(t[0]) / 999)) ** 0.5))
        return trainer.target(x, place, cond, scale, batch.mask, None)

    found = denoise(predict, noise, make_scheduler("ddim", PASSES, spacing="top"))
    many = make_scheduler("ddim", PASSES * FAST.substeps, spacing="top")
    expected = denoise(
        lambda x, t: trainer.model.denoiser.guided(x, t, cond, batch.mask, scale=2.5), noise, many
    )
    real = batch.mask.repeat_interleave(noise.shape[-1] // 2, -1) > 0
    assert torch.allclose(found[real], expected[real], atol=0.02), (found - expected)[real].abs().max()
    assert (expected - noise)[real].abs().max() > 0.5


def test_a_run_that_stops_goes_on_and_only_the_change_is_trained(
    scenes: Path, run: Path, tmp_path: Path
) -> None:
    straight = fast(scenes, run, tmp_path / "a")
    before = {k: v.clone() for k, v in straight.model.state_dict().items()}
    losses = [terms["total"] for terms in straight.run(minutes=10)]
    assert len(losses) == 6 and all(loss > 0 for loss in losses)
    take(fast(scenes, run, tmp_path / "b"), 3)
    resumed = fast(scenes, run, tmp_path / "b")
    assert resumed.step == 3
    assert len(list(resumed.run(minutes=10))) == 3
    one, other = (load_file(tmp_path / name / "last.safetensors") for name in "ab")
    assert one.keys() == other.keys()
    assert [key for key in one if not torch.equal(one[key], other[key])] == []
    assert all(torch.equal(v, before[k]) for k, v in straight.model.state_dict().items())
    assert any(value.abs().max() > 0 for key, value in one.items() if key.startswith("change/up"))


def test_the_change_learns_one_pass(scenes: Path, run: Path, tmp_path: Path) -> None:
    """On the same batch, noise and scale the loss falls to well below where it began."""
    trainer = fast(scenes, run, tmp_path)
    batch, place = trainer.data.batch(0), torch.tensor([1, 3, 5, 7])
    noise = torch.randn(batch.x0.shape, generator=torch.Generator().manual_seed(3))
    scale, losses = torch.full((4,), 3.0), []
    for _ in range(60):
        loss = torch.stack(list(trainer.distilled(batch, place, scale, noise, None).values())).sum()
        losses.append(loss.item())
        trainer.optimizer.zero_grad()
        loss.backward()
        trainer.optimizer.step()
    assert losses[-1] < 0.6 * losses[0], losses[:: len(losses) - 1]


def test_export_ships_a_fast_mode_that_can_be_drawn_from(scenes: Path, run: Path, tmp_path: Path) -> None:
    words = ["--run", str(run), "--scenes", str(scenes), "--out", str(tmp_path / "fast"), "--rank", "4"]
    assert (
        intergen_fast.main([*words, "--substeps", "2", "--batch", "4", "--steps", "2", "--warmup", "1"]) == 0
    )
    out = tmp_path / "weights"
    words = ["--run", str(run), "--scenes", str(scenes), "--out", str(out)]
    assert export.main([*words, "--fast", str(tmp_path / "fast")]) == 0
    shipped, _ = load_folder(out)
    trained = load_file(tmp_path / "fast" / "last.safetensors")
    key = "up.0-ffn-linear1-weight"
    assert torch.allclose(shipped.fast.state_dict()[key], trained[f"ema/{key}"], atol=1e-3)
    expected = shipped.fast_denoiser(*shipped.fast_denoiser.example())
    generator = InterGenPipeline(out)
    found = generator.model.fast_denoiser(*shipped.fast_denoiser.example())
    assert torch.allclose(found, expected, atol=1e-3)
    passes: list[int] = []
    generator.model.fast_denoiser.register_forward_hook(
        lambda module, args, made: passes.append(len(args[0]))
    )
    task = Task("They shake hands.", "sway", {}, 30)
    ((_, duet),) = draw(generator, [task], Sampling(fast=True, damping=0.0))
    assert duet.num_frames == 30 and passes == [1] * PASSES


def test_weights_without_a_fast_mode_are_not_drawn_from_in_it(
    scenes: Path, run: Path, tmp_path: Path
) -> None:
    out = tmp_path / "weights"
    assert export.main(["--run", str(run), "--scenes", str(scenes), "--out", str(out)]) == 0
    with pytest.raises(InputError, match="no fast mode"):
        next(draw(InterGenPipeline(out), [Task("They shake hands.", "sway", {}, 30)], Sampling(fast=True)))


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--rank", "0"], "rank is 0"),
        (["--lowest", "3", "--highest", "2"], "give 1 or more, in order"),
        (["--run", "none"], "missing or damaged"),
    ],
)
def test_bad_settings_are_refused_in_one_line(
    scenes: Path, run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], says: str
) -> None:
    given = ["--run", str(run), "--scenes", str(scenes), "--out", str(tmp_path)]
    assert intergen_fast.main([*given, *words]) == 2
    said = capsys.readouterr().err
    assert says in said and said.count("\n") == 1


def test_a_network_that_reads_no_words_is_refused(scenes: Path, tmp_path: Path) -> None:
    take(begin(scenes, tmp_path, replace(SETTINGS, words=False)), 1)
    with pytest.raises(InputError, match="reads no words"):
        fast(scenes, tmp_path, tmp_path / "fast")
