"""Sentences and plans as beats: what happens one after another becomes a beat each, with its acts and its own words."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from acts import Act, Plan
from acts.captions import sentence
from acts.lexicon import Entry, Lexicon, is_fixture, lexicon
from acts.staging.act_kinds import hits, reaches_low
from acts.staging.score import LOWERED
from acts.staging.stage import score_of
from motion import InputError
from webdemo.inference import methods
from webdemo.inference.requests import GenerateRequest
from webdemo.inference.requests.plans import plan_of_words
from webdemo.inference.requests.sampling import MAX_PROMPT
from webdemo.inference.run import CancelToken

from .beats import MOST_BEATS, SHORTEST, Beat, beat_of, filling, plan_of_beat, seconds_of_acts
from .request import SceneRequest

MOST_WORDS = MOST_BEATS * MAX_PROMPT
"""Characters of a story in sentences: as many as its beats may have."""
LONGEST_READ = 2 * MAX_PROMPT
"""Characters of one sentence of a story, at most."""
READING_SECONDS = 30.0
"""In which a story is read that no run waits for."""
_AT_ONCE = 1200
"""Characters of sentences that are read together, so that "he" stays who he is."""
_MOST_SENTENCES = 30
"""Sentences that are read together, at most: a plan holds sixty acts."""
_THEN = frozenset(("then", "next", "afterwards", "finally"))
_ENDS = re.compile(r"(?<=[.!?;])\s+")


def in_time() -> Callable[[], None]:
    """A ``go_on`` for :func:`split_sentence` that raises InputError after :data:`READING_SECONDS` from now."""
    late = "The story took longer than {limit} to read: shorten it, or try again when the lab is less busy."
    return CancelToken(READING_SECONDS, late).start().raise_if_cancelled


def split_sentence(text: str, go_on: Callable[[], None] = lambda: None) -> tuple[Beat, ...]:
    """The beats of a sentence or a story, by the order of its acts; one beat, in its own words, if it names one thing.

    Args:
        text: what happens; reading takes time linear in its length.
        go_on: called before each stretch of it; what it raises ends the reading.

    Raises:
        InputError: for a text, or a sentence in it, that is longer than any scene's.
    """
    if len(text) > MOST_WORDS:
        raise InputError(f"The story has {len(text):,} characters: shorten it to {MOST_WORDS:,}.")
    text = " ".join(text.split())
    beats: list[Beat] = []
    for stretch in _stretches(text):
        go_on()
        beats += _beats_in(stretch)
        if len(beats) > MOST_BEATS:
            raise InputError(f"The story has more than {MOST_BEATS} beats: keep to {MOST_BEATS} or fewer.")
    if len(beats) > 1:
        return tuple(beats)
    if len(text) > LONGEST_READ:
        raise InputError(f"Nobody does anything in “{text[:40]} …”: say who does what.")
    return (Beat(text),) if text else ()


def _stretches(text: str) -> Iterator[str]:
    """The text in stretches of whole sentences that are read at once."""
    stretch, count = "", 0
    for part in _ENDS.split(text):
        if len(part) > LONGEST_READ:
            raise InputError(
                f"The sentence “{part[:40]} …” has {len(part):,} characters: shorten it to {MAX_PROMPT}, or split it."
            )
        if stretch and (len(stretch) + len(part) > _AT_ONCE or count == _MOST_SENTENCES):
            yield stretch
            stretch, count = "", 0
        stretch, count = f"{stretch} {part}".strip(), count + 1
    if stretch:
        yield stretch


def _beats_in(text: str) -> list[Beat]:
    """The beats of a stretch of text; a sentence of which nothing is known is one in its own words."""
    plan = plan_of_words(text)
    if not (plan.acts or plan.unread):  # no parser is installed
        return [Beat(text)]
    beats, unread = list(beats_of(plan)), list(_unread_sentences(plan))
    first = [min((act.words.start for act in beat.acts if act.words), default=0) for beat in beats]
    for start, beat in reversed(unread):
        at = next((i for i, begins in enumerate(first) if begins > start), len(beats))
        beats.insert(at, beat)
    return beats


def _unread_sentences(plan: Plan) -> Iterator[tuple[int, Beat]]:
    """The sentences of a plan's text of which nothing is known that somebody does, and where they begin."""
    for part, start, stop in _sentences(plan.sentence):
        if not _tells(plan.acts, start, stop) and any(start <= each.words.start < stop for each in plan.unread):
            yield start, Beat(part)


def _sentences(text: str) -> Iterator[tuple[str, int, int]]:
    """The sentences of a text, and where each begins and ends."""
    stop = 0
    for part in _ENDS.split(text):
        start = text.index(part, stop)
        stop = start + len(part)
        yield part, start, stop


def _tells(acts: Sequence[Act], start: int, stop: int) -> bool:
    """True if one of some acts is told between two places of the text."""
    return any(act.words and act.words.start < stop and start < act.words.stop for act in acts)


def beats_of(plan: Plan, *, own_words: bool = True) -> tuple[Beat, ...]:
    """The beats of a plan; an answer, such as a fall after a punch, shares the beat of what it answers.

    Args:
        plan: with or without a text.
        own_words: a beat keeps the sentences of the text that tell it; otherwise its words are its acts' captions.
    """
    known = lexicon()
    beats: list[list[list[Act]]] = []
    for group in plan.beats():
        if beats and (_goes_on(beats[-1], group) or _same_beat(beats[-1][-1], group, known, plan.sentence)):
            beats[-1].append(group)
        else:
            beats.append([group])
    if len(beats) > 1 and not any(act.happens for group in beats[0] for act in group):
        beats[:2] = [beats[0] + beats[1]]
    acts = [[act for group in groups for act in group] for groups in beats]
    own = _own_sentences(plan, acts) if own_words else {}
    return tuple(
        Beat(own.get(i, words), acts=tuple(act for group in groups for act in group))
        for i, groups in enumerate(beats)
        if (words := sentence(groups, known))
    )


def _own_sentences(plan: Plan, groups: Sequence[Sequence[Act]]) -> dict[int, str]:
    """The whole sentences of the text that tell a beat's acts and no other's, by the number of the beat."""
    if any(act.words is None for act in plan.acts):  # of a plan that somebody edited
        return {}
    told = [
        (part, {i for i, acts in enumerate(groups) if _tells(acts, start, stop)})
        for part, start, stop in _sentences(plan.sentence)
    ]
    shared = {i for _, within in told if len(within) > 1 for i in within}
    own: dict[int, str] = {}
    for part, within in told:
        if len(within) == 1 and not within & shared:
            (i,) = within
            part = _without_then(part)
            own[i] = f"{own[i]} {part}" if i in own else part
    done = {i for i, acts in enumerate(groups) if all(act.happens for act in acts)}  # a network hears no "not"
    return {i: words for i, words in own.items() if i in done and len(words) <= MAX_PROMPT}


def _without_then(part: str) -> str:
    """A sentence without a "then" at its beginning, which says nothing in a beat of its own."""
    first, _, rest = part.partition(" ")
    if first.lower().rstrip(",") not in _THEN or not rest:
        return part
    return rest[:1].upper() + rest[1:]


def _goes_on(before: Sequence[Sequence[Act]], group: Sequence[Act]) -> bool:
    """True if before a group only others do something, which goes on while it happens: "A sits until B taps him"."""
    earlier = [act for acts in before for act in acts]
    busy = {who for act in group if act.happens for who in act.agents}
    if any(relation.kind == "until" for act in before[-1] for relation in act.order):
        return all(not busy & set(act.agents) for act in before[-1])  # "covers his eyes until she has run off"
    return all((act.already and not busy & set(act.agents)) or _stands_by(act) for act in earlier)


def _stands_by(act: Act) -> bool:
    """True for an act that only says where somebody is: "stands behind him and cuts his hair"."""
    entry = lexicon().entries.get(act.act)
    if entry is None or not entry.stage or is_fixture(act.thing):  # before a window something is done
        return False
    return {shape.do for shape in entry.stage} <= {"stay", "place"}


def _same_beat(before: Sequence[Act], group: Sequence[Act], known: Lexicon, text: str) -> bool:
    """True if a group of acts belongs into the beat of the one before it."""
    if not any(act.happens for act in group):
        return True  # who does not do something says nothing about when
    first, then = _with_entries(before, known), _with_entries(group, known)
    return any(_belongs(act, e, later, then_e, text) for act, e in first for later, then_e in then)


def _belongs(act: Act, entry: Entry, later: Act, after: Entry, text: str) -> bool:
    """True if one act answers another, or goes on with it in one movement."""
    does, then = {shape.do: shape for shape in entry.stage}, {shape.do: shape for shape in after.stage}
    other = "b" if act.agents[0] == "a" else "a"
    if (entry.thing, after.thing) == ("throws", "catches") and (later.agents != act.agents) ^ (act.direction == "up"):
        return True
    hit = hits(entry) or getattr(does.get("touch"), "fells", False)
    if hit and other in later.agents and len(later.agents) == 1:
        return bool(then.keys() & {"posture", "strike"}) or getattr(then.get("go"), "way", "") in ("back", "aside")
    way, next_way = (getattr(shapes.get("go"), "way", "") for shapes in (does, then))
    if way and next_way == "after" and later.agents != act.agents:
        return True
    if way == "to" and len(act.agents) == 2 and after.mutual and not then:
        return _in_one_sentence(act, later, text)  # the network walks them into each other's arms
    if (way == "to" and "lift" in then) or ("link" in does and "hold" in then):
        return True  # runs up and is lifted; the hands that they take turn them round
    same = later.agents == act.agents
    if "lift" in does and ((same and "turn" in then) or getattr(then.get("hold"), "hold", "") == "twirl"):
        return True  # "picks her up and spins her around"
    if "lift" in does and later.agents == (act.patient,) and then.keys() == {"gesture"}:
        return True  # "lifts her up, and she spreads her arms"
    if way in ("past", "ahead") and getattr(then.get("go"), "who", "") == "patient" and not same:
        return True  # who is overtaken walks on meanwhile
    if way == "to" and next_way == "past" and same:
        return True  # who passes the other comes up to them on the way
    if ("lift" in does and "lift" in then) or _posture(does) == _posture(then) != "":
        return same  # "drops to one knee and proposes"
    if same and _posture(does) in LOWERED and reaches_low(later, after):
        return True  # "bends down and ties his shoe"
    if not same:
        down = "posture" in does and not act.already
        helped = "touch" in then or _is_caught(then.get("posture"))
        return down and helped and later.patient in act.agents  # "she faints and he catches her"
    if "turn" in does:
        return next_way == "away" or after.mutual or "touch" in then
    pulled = getattr(then.get("go"), "linked", False) or (not then and later.patient is not None)
    led = bool(does.keys() & {"link", "touch"}) and pulled
    return led or (way == "away" and next_way == "away")


def _posture(stage: Mapping[Any, object]) -> str:
    """The posture that a stage ends in; "" for none."""
    return getattr(stage.get("posture"), "posture", "")


def _is_caught(posture: object) -> bool:
    """True for a posture that the other brings about at once: a person who is helped up was down for a moment."""
    return getattr(posture, "who", "") == "patient" and getattr(posture, "posture", "") != "stands"


def _in_one_sentence(act: Act, later: Act, text: str) -> bool:
    """True for two acts of one sentence of a text, and for acts without words."""
    return act.words is None or later.words is None or not _ENDS.search(text, act.words.start, later.words.stop)


def _with_entries(acts: Sequence[Act], known: Lexicon) -> list[tuple[Act, Entry]]:
    return [(act, known.entries[act.act]) for act in acts if act.happens and act.act in known.entries]


# ---- prompts as scenes ---------------------------------------------------------------------------


LEAST_SHARE = 1.25
"""Seconds for each beat of a sentence below which it is made in one."""


def as_scene(request: GenerateRequest) -> SceneRequest | None:
    """The scene of a sentence with several beats, which share the request's seconds, or of one with a plan or paths.

    None if the sentence is given to the network as it is, as one whose beats would be longer than a prompt. A request
    with the plan of a result has its beats from there.
    """
    if not request.split or "scene" not in methods.method(request.model).tasks:
        return None
    request = request.with_plan()
    assert request.plan is not None
    whole, replays = request.plan.acts[0], request.plan.of_result
    beats = tuple(beat_of(beat) for beat in request.plan.beats) if replays else _beats(request, whole)
    try:
        for place, beat in enumerate(beats, 1):
            beat.check(place)
    except InputError:
        if request.paths:
            raise
        return None
    plans = tuple(plan_of_beat(beat) if beat.acts else whole for beat in beats)
    as_it_is = [beat.words for beat in beats] == [request.prompt] and not request.paths and not replays
    if not beats or (as_it_is and not (request.planned and score_of(plans[0].acts).is_planned)):
        return None
    if not replays:
        beats = _filling(request.seconds, beats, plans)
    return SceneRequest(
        beats=beats,
        paths=request.paths,
        planned=request.planned,
        strictness=request.strictness,
        plan=replace(request.plan, acts=plans),
        **request.sampling,
    )


def _filling(seconds: float, beats: Sequence[Beat], plans: Sequence[Plan]) -> tuple[Beat, ...]:
    """Beats that share some seconds by the lengths of their acts, in whole frames."""
    lengths = [seconds_of_acts(beat.acts or plan.acts) for beat, plan in zip(beats, plans, strict=True)]
    filled = zip(beats, filling(seconds, lengths), strict=True)
    return tuple(replace(beat, seconds=max(length, SHORTEST)) for beat, length in filled)


def _beats(request: GenerateRequest, script: Plan) -> tuple[Beat, ...]:
    """The beats of a request's plan.

    A sentence of one beat keeps its words, which the network reads, unless they say what is not done.
    """
    most = request.seconds / LEAST_SHARE
    captions = _in_captions(request, script)
    if not captions and not script.acts:
        return (Beat(request.prompt),)
    words = "" if captions else request.prompt
    beats = beats_of(script, own_words=not captions)
    if not beats or len(beats) > most:
        return (Beat(words, acts=script.acts),)
    score = words and all(act.happens for act in script.acts)  # a network hears no "not"
    return (replace(beats[0], words=words),) if len(beats) == 1 and score else beats


def _in_captions(request: GenerateRequest, script: Plan) -> bool:
    """True where the network reads its acts' captions: of an edited plan, and where it has to know an act's words.

    It never learned the names of a lab's own acts, and an act without a shape is made from its words alone.
    """
    known = lexicon()
    listed = [act.act for act in script.acts if act.happens and act.act in known.entries]
    return request.acts is not None or any(name in known.own or not known.entries[name].stage for name in listed)
