"""Beats: what two people do one thing after another, as plans of acts, and how long it takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from pydantic import ValidationError

from acts import Plan
from acts.captions import sentence
from acts.lexicon import lexicon
from acts.plan import MOST_ACTS, Act, beats, plan_of, problem
from acts.reading.wording import begins_with_subject
from motion import FPS, InputError
from webdemo.inference.requests.plans import kept_plan, plan_of_words
from webdemo.inference.requests.sampling import MAX_PROMPT, MAX_SEED, number, whole

SHORTEST, LONGEST = 0.5, 30.0
"""Seconds of one beat."""
MOST_BEATS = 60
TITLE = 90
"""Characters of a title."""
DEFAULT_SECONDS = 4.0
"""Of a beat whose words name no act that is known."""


@dataclass(frozen=True)
class Beat:
    """A part of a story in which one thing happens.

    Attributes:
        words: what both people do, in English.
        a: what person a does, if it is said separately.
        b: what person b does.
        seconds: length; by default it follows from the words.
        seed: makes this beat another way than its neighbours; by default the story's seed.
        acts: of a plan, which are then done in place of what the words say; the network still reads the words.
    """

    words: str = ""
    a: str = ""
    b: str = ""
    seconds: float | None = None
    seed: int | None = None
    acts: tuple[Act, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """As JSON; acts only where there are any."""
        plain = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "acts"}
        written = [act.model_dump(mode="json", exclude_defaults=True) for act in self.acts]
        return plain | ({"acts": written} if written else {})

    @property
    def sentence(self) -> str:
        """All its words as one sentence, or its acts where it has no words, for a model that reads one."""
        alone = [_of_person(text, who) for text, who in ((self.a, "one person"), (self.b, "the other person")) if text]
        parts = [part.strip().rstrip(".") for part in (self.words, ", while ".join(alone)) if part.strip()]
        if self.acts and not parts:
            return sentence(beats(self.acts), lexicon())
        return " ".join(_sentence(part) for part in parts)

    @property
    def alone(self) -> tuple[str, str]:
        """A sentence for a and one for b, for a model that reads them; "" for a person without words of their own."""
        clauses = [_of_person(text, "one person") if text else "" for text in (self.a, self.b)]
        return (_sentence(clauses[0]), _sentence(clauses[1]))

    @property
    def length(self) -> float:
        """Seconds, as set or as they follow from the acts or the words."""
        if self.seconds is not None:
            return self.seconds
        return seconds_of_acts(plan_of_beat(self).acts)

    def check(self, place: int) -> None:
        """Raises InputError if something is wrong with it; ``place`` from 1 is for the message."""
        which = f"Beat {place}"
        for name in ("words", "a", "b"):
            if not isinstance(getattr(self, name), str):
                raise InputError(f"{which}: {name} must be text, not {getattr(self, name)!r:.40}.")
        if len(self.sentence) > MAX_PROMPT:
            raise InputError(f"{which} has {len(self.sentence):,} characters: shorten it to {MAX_PROMPT}, or split it.")
        if self.seconds is not None:
            number(f"{which}: its length", self.seconds, SHORTEST, LONGEST, " seconds")
        if self.seed is not None:
            whole(f"{which}: its seed", self.seed, 0, MAX_SEED)


def story_title(beats: Sequence[Mapping[str, Any]]) -> str:
    """A title for beats as a manifest has them: their words, as many as fit on a line."""
    each = (Beat(beat.get("words") or "", beat.get("a") or "", beat.get("b") or "") for beat in beats)
    title = " ".join(beat.sentence or "…" for beat in each)
    return title if len(title) <= TITLE else f"{title[:TITLE].rsplit(' ', 1)[0]} …"


def _sentence(clause: str) -> str:
    """A clause as a sentence; "" stays as it is."""
    return f"{clause[:1].upper()}{clause[1:]}." if clause else ""


def _of_person(text: str, who: str) -> str:
    """Writes what one person does as a clause with a subject."""
    text = text.strip().rstrip(".")
    if begins_with_subject(text):
        return text[:1].lower() + text[1:]
    return f"{who} {text[:1].lower()}{text[1:]}"


def plan_of_beat(beat: Beat) -> Plan:
    """The plan of a beat: of its acts alone, without their relations to acts of other beats, or of its words."""
    if not beat.acts:
        return plan_of_words(beat.sentence)
    here = {act.id for act in beat.acts}
    acts = (act.model_copy(update={"order": tuple(r for r in act.order if r.act in here)}) for act in beat.acts)
    return Plan(acts=tuple(acts))


def beat_of(values: Mapping[str, Any]) -> Beat:
    """A beat from its fields; raises InputError for acts that are none."""
    plain = {f.name: values[f.name] for f in fields(Beat) if values.get(f.name) is not None}
    return Beat(**{**plain, "acts": acts_of(plain.get("acts", ()))})


def plans_of_result(manifest: Mapping[str, Any]) -> tuple[Plan, ...]:
    """The plans of a result's words, of each beat where it is of a story; read now, if a version kept none.

    Raises:
        InputError: if they are damaged.
    """
    if (kept := kept_plan(manifest)) is not None and kept.acts:
        return kept.acts
    asked = manifest.get("request") or {}
    if asked.get("acts"):
        return (plan_of(asked["acts"]),)
    if asked.get("beats"):
        return tuple(plan_of_beat(beat_of(beat)) for beat in asked["beats"])
    return (plan_of_words(str(asked.get("prompt") or "")),)


def acts_of(values: Sequence[Any]) -> tuple[Act, ...]:
    """Acts from JSON; raises InputError for anything else, with a sentence on the first that is wrong."""
    if not isinstance(values, (list, tuple)) or len(values) > MOST_ACTS:
        raise InputError(f"The acts of a beat are a list of {MOST_ACTS} at most.")
    try:
        return tuple(
            Act.model_validate({"id": str(i), **value} if isinstance(value, Mapping) else value)
            for i, value in enumerate(values, 1)
        )
    except ValidationError as error:
        raise InputError(f"An act of a beat is wrong: {problem(error)}") from None


def seconds_of_acts(acts: Sequence[Act]) -> float:
    """The length of acts of one beat: of the longest of those that happen one after another, in half seconds."""
    if not acts:
        return DEFAULT_SECONDS
    known = lexicon().entries
    total = 0.0
    for group in beats(acts):
        lengths = [
            act.seconds or known[act.act].seconds * min(act.times or 1, 3) ** 0.5 / act.speed**0.5
            for act in group
            if act.act in known
        ]
        total += max(lengths, default=DEFAULT_SECONDS)
    return min(max(round(2 * total) / 2, 1.5), 10.0)


def filling(seconds: float, lengths: Sequence[float]) -> list[float]:
    """Lengths of beats that share some seconds by the lengths that they would have, in whole frames."""
    factor = seconds / sum(lengths)
    edges = np.round(np.cumsum([0.0, *(length * factor for length in lengths)]) * FPS) / FPS
    return [round(float(length), 4) for length in np.diff(edges)]


def seconds_of(words: str) -> float:
    """The length of what a sentence says, in half seconds: as it states, or as long as its acts usually take."""
    return seconds_of_acts(plan_of_words(words).acts)
