"""Features computed in each step are those that are kept beside the scenes."""

from __future__ import annotations

from pathlib import Path

import torch

from training.core.text_features import CaptionFeatures, CaptionTokens

CAPTIONS = ["They bow.", "One person waves while the other, who has just come in, walks up to them."]


def test_tokens_give_the_features_that_are_kept(tmp_path: Path) -> None:
    kept, tokens = CaptionFeatures(sorted(CAPTIONS), tmp_path), CaptionTokens("cpu")
    text, mask = kept.batch(CAPTIONS)
    ids, same = tokens.batch(CAPTIONS)
    assert torch.equal(mask, same) and ids.shape == mask.shape and ids.shape[1] % 8 == 0
    features = tokens.features_of(ids, same)
    assert (features - kept.features_of(text, mask)).abs().max() < 0.03 * text.abs().max()
    assert not features[~mask].any() and features[mask].abs().max() > 0.5
