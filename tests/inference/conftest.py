"""A tiny untrained model in a folder of its own, so that the engine's mechanics are tested in seconds."""

from pathlib import Path

import pytest
import torch

from models.intergen import InterGenDenoiser
from models.intergen.compact import CaptionBank, CompactConfig, CompactInterGen, save_folder
from models.motion_tokens import encode
from models.text import MiniLM, TextConditioner
from motion import SMPL22
from webdemo.inference.ablations import silence
from webdemo.inference.engine import Engine

CAPTIONS = ("Two people shake hands.", "One person waves.", "They walk away from each other.")


def draw(module: torch.nn.Module) -> None:
    """Random numbers for all parameters: the zero-initialised layers would hide what the input does."""
    for parameter in module.parameters():
        torch.nn.init.normal_(parameter, std=0.05)


def draw_plain(model: CompactInterGen) -> None:
    """The same for InterGen's own parts alone; those that read what each does and what is given say nothing."""
    torch.manual_seed(0)
    own = InterGenDenoiser(model.denoiser.config)
    roles = torch.nn.ParameterList([torch.randn(2, model.config.latent_dim)])
    conditioner = TextConditioner(model.conditioner.config)
    for part in (roles, own, conditioner):
        draw(part)
    for parameter in model.denoiser.parameters():
        torch.nn.init.zeros_(parameter)
    model.denoiser.role_embedding.data.copy_(roles[0])
    model.denoiser.load_state_dict(own.state_dict(), strict=False)
    model.conditioner.load_state_dict(conditioner.state_dict())


def tiny_weights(folder: Path, *, plain: bool) -> Path:
    torch.manual_seed(0)
    sizes = {"latent_dim": 32, "ff_size": 32, "num_layers": 2, "num_heads": 2, "cond_dim": 64, "text_layers": 1}
    model = CompactInterGen(CompactConfig(**sizes))
    (draw_plain if plain else draw)(model)
    rest = torch.tensor(SMPL22.rest_positions()).float() + torch.tensor([0.0, 0.98, 0.0])
    frames = model.layout.num_frames(4)
    control = encode(rest.expand(frames, -1, -1), torch.ones(frames, 4), model.layout)
    model.mean.copy_(control.mean(0))
    model.std.fill_(0.1)
    bank = CaptionBank(CAPTIONS, MiniLM()(CAPTIONS).pooled(), far=0.5)
    save_folder(folder / "intergen", model, bank, card={"summary": "a tiny untrained model"})
    return folder


@pytest.fixture(scope="session")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tiny_weights(tmp_path_factory.mktemp("weights"), plain=True)


@pytest.fixture(scope="session")
def shipped() -> Engine:
    """With the shipped networks."""
    return Engine()


@pytest.fixture(scope="session")
def reading_engine(tmp_path_factory: pytest.TempPathFactory) -> Engine:
    """With an untrained network that sees what is known, and drafts."""
    return Engine(tiny_weights(tmp_path_factory.mktemp("reading"), plain=False))


@pytest.fixture(params=["engine", "reading_engine"])
def either_engine(request: pytest.FixtureRequest) -> Engine:
    """Each of the two networks."""
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="session")
def engine(request: pytest.FixtureRequest, weights: Path) -> Engine:
    """With an untrained network that sees nothing of what it is held to, which is all that is given.

    Where planned motion is tested also with zeros in its place.
    """
    made = Engine(weights)
    pipeline = made.pipeline("intergen")
    pipeline.model.reads_known = False
    if getattr(request, "param", None) == "zeros":
        silence(pipeline)
    return made


OF_THE_NETWORK = {"test_a_hand_waves_on_the_way", "test_an_arm_around_somebody_lies_on_their_far_shoulder_behind_them"}
"""Promises that the plan alone does not keep."""


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """What only the plan does is so without a network as well."""
    planned = metafunc.module.__name__.rpartition(".")[2].startswith("test_planned_")
    if planned and "engine" in metafunc.fixturenames:
        needs = metafunc.function.__name__ in OF_THE_NETWORK
        marks = [pytest.mark.xfail(strict=True, reason="needs a network")] if needs else []
        networks = ["untrained", pytest.param("zeros", marks=marks)]
        metafunc.parametrize("engine", networks, indirect=True, scope="session")
