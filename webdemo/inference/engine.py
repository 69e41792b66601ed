"""The shared inference layer: a request in, progress events and one result out.

::

    from webdemo.inference import Engine, GenerateRequest

    for event in Engine().run(GenerateRequest(prompt="Two people shake hands.")):
        ...  # Progress, Progress, …, Result
"""

from __future__ import annotations

import platform
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any, cast

from acts.accounting import account
from acts.checking import NO_RULE, checked
from acts.plan import PlanFrames
from acts.things.furnishing import judge_things
from motion import SMPL22, Clip, Duet
from motion.metrics.sentences.joints import Motion
from webdemo.inference import methods
from webdemo.inference.finish.cleanup import standing_clear
from webdemo.inference.finish.looks import as_given, enlarged, furnished, lengths_of
from webdemo.inference.method import Pipeline
from webdemo.inference.methods import WEIGHTS
from webdemo.inference.requests import GenerateRequest, ReactRequest, SamplingRequest
from webdemo.inference.requests.live import LivePartner, LiveTake, check_partner
from webdemo.inference.requests.predict import PredictRequest
from webdemo.inference.requests.sampling import MAX_SEED
from webdemo.inference.run import CancelToken, Progress, Result, StageTimer
from webdemo.inference.story.request import SceneRequest

Request = GenerateRequest | ReactRequest | PredictRequest | SceneRequest | LiveTake


class Engine:
    """Runs requests on networks that are loaded once, on first use.

    Safe to share between threads: loading happens once, and a run keeps its state to itself.

    Args:
        weights: folder that holds a folder a model; the shipped one by default.
    """

    def __init__(self, weights: Path = WEIGHTS) -> None:
        self.weights = weights
        self._lock = threading.Lock()
        self._loading: dict[str, threading.RLock] = {}
        self._pipelines: dict[str, Pipeline] = {}
        self._warm: set[str] = set()
        self._warming = threading.Lock()

    @property
    def ready(self) -> bool:
        """True if the default network is in memory."""
        return SamplingRequest.model in self._pipelines

    def warm_up(self) -> None:
        """Loads the default network and runs one step, which makes the first request fast; once."""
        with self._warming:
            if SamplingRequest.model not in self._warm:
                for _ in self.run(GenerateRequest(prompt="Two people wave.", seconds=2.0, steps=1, damping=0.0)):
                    pass
                self._warm.add(SamplingRequest.model)

    def info(self) -> dict[str, Any]:
        """Name, summary and figures of the default model, read from its folder; loads no network."""
        from models.weights_io import WeightsFolder

        name = SamplingRequest.model
        meta = WeightsFolder(self.weights / name).meta
        return {"name": name, "ready": self.ready, **meta.get("card", {})}

    def run(self, request: Request, cancel: CancelToken | None = None) -> Iterator[Progress | Result]:
        """Yields :class:`Progress` events, then exactly one :class:`Result`.

        The same request on the same machine gives the same bytes.

        Args:
            request: what is asked for.
            cancel: stops the run.

        Raises:
            InputError: one sentence on what is wrong and what to do.
            Cancelled: within one sampling step of ``cancel.cancel()``.
        """
        cancel = cancel or CancelToken()
        timer = StageTimer.start()
        yield timer.progress("load")
        pipeline = self.pipeline(request.model)
        _take_threads(pipeline)
        if isinstance(request, SamplingRequest):
            request = request.with_plan()
        timer.lap("load")
        cancel.raise_if_cancelled()

        def run(one: Request) -> Iterator[Progress | Result]:
            if isinstance(one, LiveTake):  # its motion is there
                return one.results(timer)
            return pipeline.run(enlarged(one), cancel, timer)

        for event in run_tries(request, run, cancel):
            if isinstance(event, Result):
                timer.lap("finish")
                manifest = _manifest(request, pipeline) | event.manifest
                duets = tuple(
                    replace(duet, manifest=manifest | kept_rows(duet) | {"sample": i})
                    if isinstance(duet, Duet)
                    else duet
                    for i, duet in enumerate(event.duets)
                )
                event = replace(event, duets=duets, manifest=manifest, timings=event.timings or timer.timings)
            yield event

    def partner(self, name: str, *, seed: int = 0) -> LivePartner:
        """A partner who answers a stream of poses, one of :data:`webdemo.inference.requests.live.PARTNERS`.

        Raises:
            InputError: if there is no such partner, or its weights are missing or altered.
        """
        check_partner(name)
        from webdemo.inference.live.agent import LiveAgent
        from webdemo.inference.live.partner_pipeline import ReactingPartner, warm_up

        reacting: Any = self.pipeline("regennet")
        eye = None if name == "regennet" else cast(Any, self.pipeline("agent")).eye

        def made() -> LivePartner:
            partner = ReactingPartner(reacting, seed=seed)
            return partner if eye is None else LiveAgent(eye, partner)

        if name not in self._warm:  # PyTorch's first passes take a second
            warm_up(made())
            self._warm.add(name)
        return made()

    def pipeline(self, name: str) -> Pipeline:
        """The pipeline that runs the requests of a method; loads it first if necessary.

        Raises:
            InputError: if there is no such method, or its weights are missing or altered.
        """
        described = methods.method(name)
        with self._lock:
            loading = self._loading.setdefault(name, threading.RLock())
        with loading:  # of this method alone: no model waits for another one's loading
            if name not in self._pipelines:
                parts = [self.pipeline(needed) for needed in described.needs]
                _take_threads()
                self._pipelines[name] = described.load(self.weights / (described.weights or name), *parts)
            return self._pipelines[name]


def _take_threads(pipeline: Pipeline | None = None) -> None:
    """Sets PyTorch's threads for a run that begins in this thread, or for loading."""
    from models.compiled import take_threads  # needs PyTorch, which the engine itself does not

    take_threads(plain_denoiser=not getattr(pipeline, "compiled", True))


def _manifest(request: Any, pipeline: Pipeline) -> dict[str, Any]:
    """Everything that reproduces a result."""
    plan = getattr(request, "plan", None)
    return ({} if plan is None else {"plan": plan.to_dict()}) | {
        "product": "Pas de Deux",
        "request": request.to_dict(),
        "model": pipeline.name,
        "weights_sha256": pipeline.digest,
        "versions": {name: version(name) for name in ("torch", "diffusers", "numpy")}
        | {"python": platform.python_version()},
    }


# ---- tries: further seeds until a motion shows all that its words say, or the best of them --------------------
def run_tries(
    request: Any, run: Callable[[Any], Iterator[Progress | Result]], cancel: CancelToken
) -> Iterator[Progress | Result]:
    """The progress of up to ``request.tries`` runs and the result of the first that does all that was said.

    Where none does all, it is the one with the largest share of acts done, of equals the first. The tries have the
    seeds that follow the request's. One with the plan of a result has one try: the plan belongs to its seed. So has
    one of whose words nothing can be judged.

    Args:
        request: what is asked for; every try is this request with ``tries=1`` and its own seed.
        run: makes one try.
        cancel: ends the tries, also between two.
    """
    plan = getattr(request, "plan", None)
    asked = 1 if plan is not None and plan.of_result else getattr(request, "tries", 1)
    best: Judged | None = None
    made, won = 0, 1
    while made < asked and (best is None or best.share < 1.0):
        cancel.raise_if_cancelled()
        one = request if asked == 1 else replace(request, seed=_seed(request.seed, made), tries=1)
        made += 1
        for event in run(one):
            if not isinstance(event, Result):
                yield event if asked == 1 else replace(event, attempt=made, attempts=asked)
                continue
            attempt = judged(one, _finished(one, event))
            if best is None or attempt.share > best.share:
                best, won = attempt, made
    assert best is not None
    yield _told(best, request, None if asked == 1 else {"asked": asked, "made": made, "won": won})


def _seed(first: int, number: int) -> int:
    return (first + number) % (MAX_SEED + 1)


def _finished(request: Any, result: Result) -> Result:
    """A result whose people have their own sizes and looks, and the things of the request's words."""
    if isinstance(request, ReactRequest):
        result = standing_clear(result, request)
    given = getattr(request, "motion", None) is not None
    return furnished(as_given(result, request), _plans(request), given=given)


def _plans(request: Any) -> list[PlanFrames]:
    return list(request.spans()) if isinstance(request, SamplingRequest) else []


def _told(best: Judged, request: Any, tries: dict[str, Any] | None) -> Result:
    """A result with the note on what it shows."""
    result = best.result
    if tries is not None:
        tries["seed"] = _seed(request.seed, tries["won"] - 1)
        result = replace(result, manifest={**result.manifest, "tries": tries})
    said = note(best.rows, tries, best.unread)
    return replace(result, notes=(said, *result.notes)) if said else result


MOST_NAMED = 6
"""Acts that a note names of each kind, at most."""
MOST_CHARACTERS = 350
"""Characters of a note, at most, where fewer acts of each kind make it so short."""
_ORDINALS = ("1st", "2nd", "3rd", "4th")

Rows = list[dict[str, Any]]
"""Verdicts as a manifest holds them: ``act``, ``words``, ``done``, ``measure``, and ``beat`` where it has several."""


@dataclass(frozen=True)
class Judged:
    """A result with what its samples show of the words.

    Attributes:
        result: with ``checked`` and ``told`` in the manifests, of the first sample in that of all.
        rows: of each sample; () where the request has no words that can be read.
        unread: stretches of the words that are in no act.
    """

    result: Result
    rows: tuple[Rows, ...] = ()
    unread: tuple[str, ...] = ()

    @property
    def counts(self) -> tuple[int, int]:
        """Acts that are done and that can be judged, over all samples."""
        verdicts = [row["done"] for rows in self.rows for row in rows if row["done"] is not None]
        return sum(verdicts), len(verdicts)

    @property
    def share(self) -> float:
        """Acts that are done among those that can be judged; 1 where there are none."""
        done, told = self.counts
        return done / told if told else 1.0


def judged(request: Any, result: Result) -> Judged:
    """A result with the verdicts on the acts of its request's words; unchanged where there are none to judge."""
    plans = _plans(request)
    lengths = lengths_of(result.manifest)
    unread = tuple(dict.fromkeys(words for plan, *_ in plans for words in account(plan).unread))
    judgements = [_judged_sample(plans, duet, lengths) for duet in result.duets] if plans else []
    rows = tuple(own["checked"] for own in judgements)
    if not any(rows):
        return Judged(result, (), unread)
    judgements = [own | ({"unread": list(unread)} if unread else {}) for own in judgements]
    duets = tuple(_with(duet, own) for duet, own in zip(result.duets, judgements, strict=True))
    return Judged(replace(result, manifest=result.manifest | judgements[0], duets=duets), rows, unread)


def _with(duet: Duet | Clip, own: Mapping[str, Any]) -> Duet | Clip:
    return replace(duet, manifest={**(duet.manifest or {}), **own}) if isinstance(duet, Duet) else duet


def kept_rows(duet: Duet) -> dict[str, Any]:
    """The part of a sample's manifest that is its own: its verdicts, what happens in words, and its things."""
    manifest = duet.manifest or {}
    return {key: manifest[key] for key in ("checked", "told", "unread", "things") if key in manifest}


def _judged_sample(plans: Sequence[PlanFrames], duet: Duet | Clip, lengths: Sequence[float]) -> dict[str, Any]:
    """The verdicts on a sample, ``checked``, and what happens in it in words, ``told``."""
    if not isinstance(duet, Duet) or duet.skeleton.joint_names != SMPL22.joint_names:
        return {"checked": []}
    rows: Rows = []
    for plan, start, stop, beat in plans:
        verdicts = checked(plan, Motion(duet.positions[:, start:stop], duet.fps))
        split = () if beat is not None else lengths
        end = duet.num_frames if stop is None else stop
        verdicts = judge_things(verdicts, plan, duet, start, end, split)
        rows += [each.to_dict() | ({} if beat is None else {"beat": beat}) for each in verdicts]
    return {"checked": rows, "told": note([rows])}


# ---- the note --------------------------------------------------------------------------------------------
def note(rows: Sequence[Rows], tries: Mapping[str, Any] | None = None, unread: Sequence[str] = ()) -> str:
    """The verdict under a result; "" for nothing.

    What of its words is not understood, what nothing measures, what is not seen, and then what is done. "Done" stands
    alone where all of the words are acts, with all that is said of them, and all are measured and seen.

    Args:
        rows: of each sample; with several, an act counts how often it is done.
        tries: as the manifest holds them.
        unread: stretches of the words that are in no act.
    """
    acts = [list(column) for column in zip(*rows, strict=True)]
    judged = [column for column in acts if any(row["done"] is not None for row in column)]
    made = [column for column in judged if all(row["done"] for row in column)]
    done = [column[0]["words"] for column in made if not column[0].get("wrote")]
    missed = [_missed(column) for column in judged if column not in made]
    open_ = [each for each in map(_unchecked, acts) if each]
    quoted = [f"“{words}”" for words in unread]
    heads = {"Not understood": quoted, "Not measured": open_, "Not seen": missed, "Done": done}
    for most in range(MOST_NAMED, 0, -1):
        parts = [f"{head}: {_listed(words, most)}." for head, words in heads.items() if words]
        if len(" ".join(parts)) <= MOST_CHARACTERS:
            break
    if tries is None or not judged:
        return " ".join(parts)
    if missed:
        met = sum(bool(row["done"]) for column in judged for row in column)
        return f"Best of {tries['made']} tries, {met} of {sum(map(len, judged))} acts. {' '.join(parts)}"
    won = _ORDINALS[tries["won"] - 1]
    if len(parts) > 1:
        return f"This is the {won} of {tries['asked']} tries. {' '.join(parts)}"
    return f"Done on the {won} of {tries['asked']} tries: {_listed(done)}."


def _unchecked(column: Sequence[Mapping[str, Any]]) -> str:
    """Parts left out of an act that is done, an act that nothing measures, words that no other part says; or ""."""
    row = column[0]
    words, left = str(row["words"]), list(row.get("unchecked", ()))
    missed = any(each["done"] is False for each in column)
    if row.get("wrote"):
        return _with_why(f"“{row['wrote']}”, read as: {words}", " and ".join(left)) * (not missed)
    if row["done"] is None:
        why = [] if row["measure"] == NO_RULE else [row["measure"]]
        return _with_why(words, " and ".join(why + left))
    left = [each for each in left if each.startswith("“") or not missed]
    return _with_why(" and ".join(left), " ".join(words.split()[:2])) * bool(left)


def _with_why(words: str, why: str) -> str:
    return f"{words} ({why})" if why else words


def _missed(column: Sequence[Mapping[str, Any]]) -> str:
    """An act that is not done, with what was measured; of several samples with the number of those that show it."""
    words = str(column[0]["words"])
    words = f"“{column[0]['wrote']}”, read as: {words}" if column[0].get("wrote") else words
    if len(column) > 1:
        met = sum(bool(row["done"]) for row in column)
        return f"{words} (in {met} of {len(column)} samples)"
    return _with_why(words, column[0]["measure"])


def _listed(words: Sequence[str], most: int = MOST_NAMED) -> str:
    words = list(dict.fromkeys(words))
    more = f"; and {len(words) - most} more" if len(words) > most else ""
    return "; ".join(words[:most]) + more
