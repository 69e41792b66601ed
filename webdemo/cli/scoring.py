"""The command ``score``: makes the motions of sentences with any model and judges them."""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from motion import Duet, InputError
from motion.formats.files import write_text
from webdemo.inference.ablations import leave_places, silence
from webdemo.inference.method import Method
from webdemo.inference.methods import method, methods
from webdemo.inference.requests import GenerateRequest, ReactRequest, SamplingRequest
from webdemo.inference.run import Result

if TYPE_CHECKING:
    from motion.metrics.sentences import Sentence
    from motion.metrics.sentences.catalogue import Motions

SEEDS = (1, 16)
_VERSION = 3
"""Of how a sentence becomes a motion: motions that were kept are not those of another version."""


@dataclass(frozen=True)
class Scoring:
    """The settings of the requests to a model.

    Attributes:
        model: its name.
        steps, guidance, damping: as in :class:`SamplingRequest`.
        planned: the plan lays out places and poses; else the network has each beat of a sentence to itself.
        plain: sentences are given to the network as they are, neither split nor planned.
        zeros: the network's predictions are zeros, see :func:`silence`.
        places: of the plan the network gets the places alone, see :func:`leave_places`.
        strictness: as in :class:`GenerateRequest`.
    """

    model: str
    steps: int
    guidance: float
    damping: float
    planned: bool = True
    plain: bool = False
    zeros: bool = False
    places: bool = False
    strictness: float = GenerateRequest.strictness

    def request(self, sentence: Sentence, seed: int, actor: Duet | None) -> GenerateRequest | ReactRequest:
        """The request for both people, or for the partner of an actor."""
        chosen = method(self.model)
        fields: dict[str, Any] = asdict(self) | {"seed": seed}
        planned, plain, strictness = (fields.pop(name) for name in ("planned", "plain", "strictness"))
        del fields["zeros"], fields["places"]
        if actor is None:
            shortest, longest = chosen.seconds
            seconds = min(max(sentence.seconds, shortest), longest)
            fields |= {"split": not plain, "planned": planned and not plain, "strictness": strictness}
            return GenerateRequest(prompt=sentence.words, seconds=seconds, **fields)
        sampler = SamplingRequest.sampler if "ddim" in chosen.samplers else chosen.samplers[0]
        heard = sentence.words if "words" in chosen.takes else ""
        return ReactRequest(actor=actor.a, prompt=heard, sampler=sampler, **fields)


def add_score(commands: Any) -> None:
    """Adds ``score`` to the shell's commands."""
    names = dict.fromkeys(each.name for task in ("generate", "react") for each in methods(task))
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
    parser.add_argument("--alone", action="store_true", help="leave each beat to the network: no plan")
    parser.add_argument("--places", action="store_true", help="of the plan, give the network the places alone")
    parser.add_argument(
        "--plain", action="store_true", help="give the sentences to the network as they are: no beats, no plan"
    )
    parser.add_argument(
        "--zeros",
        action="store_true",
        help="put zeros in the place of all that the network makes: what is left is done by the plan alone",
    )
    parser.add_argument("--strictness", type=float, default=GenerateRequest.strictness, help="as of generate")
    parser.add_argument("--motions", type=Path, help="folder that keeps the motions, so that a run can go on")
    parser.add_argument("--out", type=Path, help="JSON file for all verdicts")
    parser.set_defaults(job=score_model)


def score_model(options: argparse.Namespace) -> dict[str, Any]:
    """Makes the motions that are missing, judges all of them and prints a table."""
    scored = method(options.model)
    scoring = Scoring(
        scored.name,
        scored.steps if options.steps is None else options.steps,
        scored.defaults.get("guidance", SamplingRequest.guidance) if options.guidance is None else options.guidance,
        options.damping,
        not options.alone,
        options.plain,
        options.zeros,
        options.places,
        options.strictness,
    )
    sentences = _chosen(options)
    if not SEEDS[0] <= options.seeds <= SEEDS[1]:
        raise InputError(f"--seeds must be from {SEEDS[0]} to {SEEDS[1]}, not {options.seeds}.")
    _check(scored)
    from motion.metrics.sentences.catalogue import ALL, score, table
    from webdemo.inference.engine import Engine

    engine = Engine()
    digest = engine.pipeline(scored.name).digest
    if options.zeros:
        silence(engine.pipeline(scored.name))
    if options.places:
        leave_places(engine.pipeline(scored.name))
    if options.motions and not digest:
        raise InputError(
            f"{scored.label} says nothing of its weights, so its motions cannot be kept: leave --motions out."
        )
    if "generate" not in scored.tasks:  # its actors are the default model's
        digest += engine.pipeline(SamplingRequest.model).digest
    kept = _folder(options.motions, scoring, digest)
    duets = [[_motion(engine, scoring, s, seed, kept) for seed in range(options.seeds)] for s in sentences]
    print(file=sys.stderr)
    ruled = [i for i, sentence in enumerate(sentences) if sentence.rule]
    scores = score([sentences[i] for i in ruled], [duets[i] for i in ruled])
    if len(ruled) < len(sentences):  # the others are measured, not judged
        from motion.metrics.quality import physical

        scores["physical"] = physical([duet for drawn in duets for duet in drawn])
    weights = digest[:12] or "none"
    scores["about"] = (
        f"{scored.label}: {len(sentences)} sentences, {len(ruled)} of them with a rule, seeds 0 to "
        f"{options.seeds - 1}; {scoring.steps} steps, guidance {scoring.guidance:g}, "
        f"damping {scoring.damping:g}, weights {weights}"
        f"{'; sentences neither split nor planned' if scoring.plain else '' if scoring.planned else '; no plan'}"
        f"{'; zeros in place of the network' if scoring.zeros else ''}"
        f"{'; of the plan the places alone' if scoring.places else ''}"
        f"{f'; strictness {scoring.strictness:g}' if scoring.strictness else ''}."
    )
    print(table(scores))
    if options.out is not None:
        write_text(options.out, json.dumps(scores, indent=1, ensure_ascii=False) + "\n")
    passed, count = scores["tags"][ALL]
    return {
        "model": scored.name,
        "sentences": len(sentences),
        "motions": sum(map(len, duets)),
        "passed": passed,
        "judged": count,
        "tags": scores["tags"],
        "any": scores["any"],
        "conditions": scores["conditions"],
        "physical": scores["physical"],
        "files": [] if options.out is None else [str(options.out)],
    }


def _chosen(options: argparse.Namespace) -> Sequence[Sentence]:
    from motion.metrics.sentences import load_sentences, read_sentences

    sentences = load_sentences() if options.sentences is None else read_sentences(options.sentences)
    wanted = set(options.only)
    kept = [s for s in sentences if not wanted or {s.id, *s.tags} & wanted]
    if not kept:
        raise InputError(f"No sentence has the name or tag {', '.join(options.only)}: leave --only out.")
    if len({s.id for s in kept}) < len(kept):
        raise InputError("Two sentences have the same id: give each one of its own.")
    return kept


def _check(chosen: Method) -> None:
    """Raises InputError for a method that sentences cannot be asked of."""
    if "class" in chosen.takes:
        raise InputError(f"{chosen.label} takes the name of a class, not a sentence: choose another model.")
    if not {"generate", "react"} & set(chosen.tasks):
        raise InputError(f"{chosen.label} predicts and takes no sentence: choose a model that generates or reacts.")


def _folder(folder: Path | None, scoring: Scoring, digest: str) -> Motions | None:
    if folder is None:
        return None
    state = json.dumps(asdict(scoring) | {"weights": digest, "version": _VERSION}, sort_keys=True)
    from motion.metrics.sentences.catalogue import Motions

    return Motions(folder / f"{scoring.model}-{hashlib.sha256(state.encode()).hexdigest()[:12]}")


def _motion(engine: Any, scoring: Scoring, sentence: Sentence, seed: int, kept: Motions | None) -> Duet:
    """The motion of a sentence and a seed, made unless it was kept."""
    if kept is not None and kept.path(sentence, seed).is_file():
        return kept.read(sentence, seed)
    began = time.perf_counter()
    chosen, actor = method(scoring.model), None
    if "generate" not in chosen.tasks:  # the actor is person a of the default model's motion of the sentence
        default = Scoring(
            SamplingRequest.model, method(SamplingRequest.model).steps, SamplingRequest.guidance, scoring.damping
        )
        actor = _made(engine, default.request(sentence, seed, None))
    duet = _made(engine, scoring.request(sentence, seed, actor))
    if kept is not None:
        kept.write(sentence, seed, duet)
    took = time.perf_counter() - began
    print(f"\r\033[K{sentence.id}, seed {seed}: {took:.1f} s", end="", file=sys.stderr, flush=True)
    return duet


def _made(engine: Any, request: GenerateRequest | ReactRequest) -> Duet:
    *_, result = engine.run(request)
    assert isinstance(result, Result) and isinstance(result.duets[0], Duet)
    if not np.isfinite(result.duets[0].positions).all():
        raise InputError(f"{request.model} gave positions that are not finite: it cannot be judged.")
    return result.duets[0]
