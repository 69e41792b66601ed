"""The command ``score``: the judge's figures of any model on sentences."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from webdemo.inference.methods import methods
from webdemo.inference.requests import SamplingRequest


def add_score(commands: Any) -> None:
    """Adds ``score`` to the shell's commands."""
    names = dict.fromkeys(found.name for task in ("generate", "react") for found in methods(task))
    parser = commands.add_parser("score", help="judge a model on sentences that no training has seen")
    parser.add_argument("--model", default=SamplingRequest.model, help=" or ".join(names))
    parser.add_argument(
        "--sentences", type=Path, help="JSON, or text with a sentence a line; the eighty shipped ones by default"
    )
    parser.add_argument("--seeds", type=int, default=4, help="motions of each sentence (4)")
    parser.add_argument("--steps", type=int, help="denoising steps; the model's own default if not given")
    parser.add_argument("--guidance", type=float, help="guidance scale s; the model's own default if not given")
    parser.add_argument("--damping", type=float, default=SamplingRequest.damping)
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="only these sentences or tags")
    parser.add_argument(
        "--plain", action="store_true", help="give the sentences to the network as they are: no beats, no plan"
    )
    parser.add_argument(
        "--zeros",
        action="store_true",
        help="put zeros in the place of all that the network makes: what is left is done by the plan alone",
    )
    parser.add_argument("--motions", type=Path, help="folder that keeps the motions, so that a run can go on")
    parser.add_argument("--out", type=Path, help="JSON file for all verdicts")
    parser.set_defaults(job=score)


def score(options: argparse.Namespace) -> dict[str, Any]:
    """Runs :func:`webdemo.cli.judging.score_model`, which loads what the other commands do without."""
    from .judging import score_model

    return score_model(options)
