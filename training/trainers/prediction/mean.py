"""The mean of two predictors' weights: ``python -m training.trainers.prediction.mean FOLDER FOLDER --out FOLDER``.

Of a network and what further training made of it, the mean keeps most of what either is good at (Wortsman et
al., *Robust fine-tuning of zero-shot models*, CVPR 2022).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from models.predictors import load_predictor, save_predictor
from motion import InputError
from training.core.shell import exit_code

_TAKEN = ("bones", "training")


def write_mean(first: Path, second: Path, out: Path, *, share: float = 0.5) -> None:
    """Writes the predictor between two others.

    Args:
        first, second: folders of predictors of one network.
        out: a folder, made where it is missing; its settings are those of ``second``.
        share: of ``second``, from 0 to 1.

    Raises:
        InputError: if the networks differ, or the share is none.
    """
    if not 0 <= share <= 1:
        raise InputError(f"share is {share}: give a number from 0 to 1.")
    one, other = load_predictor(first), load_predictor(second)
    own, network = one.network.state_dict(), other.network
    theirs = network.state_dict()
    if {k: v.shape for k, v in own.items()} != {k: v.shape for k, v in theirs.items()}:
        raise InputError(f"{first.name} and {second.name} are not of one network: give two that are.")
    network.load_state_dict({name: own[name].lerp(theirs[name], share) for name in own})
    meta = json.loads((second / "config.json").read_text())
    kept = {name: meta[name] for name in _TAKEN if name in meta}
    save_predictor(out, network, kind=meta["kind"], fps=other.fps, share=share, **kept)  # type: ignore[arg-type]  # of a known kind


def main(argv: list[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    parser = argparse.ArgumentParser(description="Average the weights of two predictors.")
    parser.add_argument("folders", type=Path, nargs=2, help="folders of two predictors of one network")
    parser.add_argument("--share", type=float, default=0.5, help="of the second")
    parser.add_argument("--out", type=Path, required=True, help="folder that is written")
    options = parser.parse_args(argv)
    return exit_code(lambda: write_mean(*options.folders, options.out, share=options.share))


if __name__ == "__main__":
    raise SystemExit(main())
