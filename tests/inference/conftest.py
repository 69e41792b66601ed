"""A tiny untrained model in a folder of its own, so that the engine's mechanics are tested in seconds."""

from pathlib import Path

import pytest
import torch

from models.intergen.compact import CaptionBank, CompactConfig, CompactInterGen, save_folder
from models.motion_tokens import encode
from models.text import MiniLM
from motion import SMPL22
from webdemo.inference.engine import Engine

CAPTIONS = ("Two people shake hands.", "One person waves.", "They walk away from each other.")


def tiny_weights(folder: Path, *, words: bool) -> Path:
    torch.manual_seed(0)
    sizes = {
        "latent_dim": 32,
        "ff_size": 32,
        "num_layers": 2,
        "num_heads": 2,
        "cond_dim": 64,
        "text_layers": 1,
    }
    model = CompactInterGen(CompactConfig(**sizes, words=words))
    for parameter in model.parameters():  # the zero-initialised layers would hide what the input does
        torch.nn.init.normal_(parameter, std=0.05)
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
    return tiny_weights(tmp_path_factory.mktemp("weights"), words=False)


@pytest.fixture(scope="session")
def reading_engine(tmp_path_factory: pytest.TempPathFactory) -> Engine:
    """With a network that reads words and sees what is known."""
    return Engine(tiny_weights(tmp_path_factory.mktemp("reading"), words=True))


@pytest.fixture(params=["engine", "reading_engine"])
def either_engine(request: pytest.FixtureRequest) -> Engine:
    """Each of the two networks."""
    return request.getfixturevalue(request.param)


@pytest.fixture(scope="session")
def engine(weights: Path) -> Engine:
    return Engine(weights)
