"""The bank of captions that is shipped with a network."""

from __future__ import annotations

from typing import Any

import torch

from models.intergen.compact import CompactConfig, CompactInterGen
from models.motion_tokens import TokenLayout
from training.export import BANK_PER_ACTS, BANK_PER_FAMILY, average, caption_bank
from training.prepare import Scenes


def scene(split: str, family: str, captions: list[str], *beats: tuple[str, str]) -> dict[str, Any]:
    acts = [{"acts": act.split("/"), "captions": [words, "never this one"]} for act, words in beats]
    return {"split": split, "family": family, "captions": captions, "beats": acts}


def test_the_bank_holds_every_kind_of_beat_beside_the_families() -> None:
    rows = [scene("train", "beats", [f"Story {i}."], ("jump/clap", f"Jump {i}.")) for i in range(40)]
    rows += [scene("train", "beats", ["Story 0."], ("kneel/stand", "One kneels."))]
    rows += [scene("train", "hug", ["They hug."]), scene("test", "hug", ["The two hug each other."])]
    bank = caption_bank(Scenes(torch.empty(0), rows, TokenLayout()))
    kinds = [sum(c.startswith(word) for c in bank.captions) for word in ("Story", "Jump", "One", "They")]
    assert kinds == [BANK_PER_FAMILY, BANK_PER_ACTS, 1, 1]
    assert len(bank.captions) == len(bank.vectors) == sum(kinds)
    assert bank.nearest(bank.vectors[bank.captions.index("One kneels.")])[1] == "One kneels."


def test_weights_are_averaged_with_those_that_a_run_began_with() -> None:
    sizes = {"latent_dim": 32, "ff_size": 48, "num_layers": 1, "num_heads": 4, "cond_dim": 64}
    touches = ((("left_wrist", "right_wrist"),),)
    began, made = CompactInterGen(CompactConfig(**sizes)), CompactInterGen(CompactConfig(**sizes, touches=touches))
    before = {name: value.clone() for name, value in made.state_dict().items()}
    average(made, began, 0.75)
    for name, value in made.state_dict().items():
        old = began.state_dict().get(name)
        wanted = before[name] if old is None else 0.75 * before[name] + 0.25 * old
        torch.testing.assert_close(value, wanted)
    assert any(name.startswith("touch_reader") for name in before)
