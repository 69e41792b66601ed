"""Captions of a scene from its label: of both people, of one alone, and of one beat.

A caption tells less than the label knows: a transition, a person who stands still, a side or a manner may be left out.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from acts import Act
from acts.captions import VERB
from motion.metrics.sentences import kept_out

from .cues import STILL, WORDS, Label, Scene, entry, label
from .phrasing import Cast, Names, Rng, draw_cast, fitting, held_out, spoken

JOINT, ALONE, ONE_BEAT = 8, 3, 2
"""Numbers of captions of a scene, of each single person, and of each beat."""
LONGEST = 320
"""Characters of a caption, at most."""


def describe(rng: Rng, scene: Scene) -> Scene:
    """The scene with its label and captions, from the beats that were played."""
    frames = scene.positions.shape[1]
    scene.label = label(scene.played, frames)
    teller = Teller(rng, scene.label, scene.split)
    scene.captions = teller.tell(JOINT)
    scene.alone = (teller.tell(ALONE, "a"), teller.tell(ALONE, "b"))
    if scene.family.startswith("beats"):
        for beat, ids in zip(scene.played, scene.label.beats, strict=True):
            known = {"start": int(beat.start), "end": int(min(beat.end, frames)), "acts": list(beat.acts)}
            scene.beats.append(known | {"minor": beat.minor, "captions": teller.tell(ONE_BEAT, only=ids)})
    return scene


class Teller:
    """Writes the captions of one scene.

    Args:
        split: "train" or "test": a test caption uses a phrase or names that no training caption uses.
    """

    def __init__(self, rng: Rng, label: Label, split: str) -> None:
        self.rng, self.label, self.split = rng, label, split
        self._groups = label.plan.beats()

    def tell(self, count: int, people: str = "ab", only: Collection[str] | None = None) -> list[str]:
        """Up to ``count`` different captions.

        Args:
            people: "ab" for all that the two do, "a" or "b" for what one of them does.
            only: the ids of the acts that are told.
        """
        sentences: dict[str, None] = {}
        for _ in range(15 * count):
            groups = self._chosen(only, people)
            if not groups or len(sentences) == count:
                break
            cast = draw_cast(self.rng, joint=len(groups[0][0].agents) == 2)
            writer = _Writer(self.rng, cast, self.split, alone=len(people) == 1)
            text = writer.write(groups)
            if writer.test == (self.split == "test") and len(text) <= LONGEST and not kept_out(text):
                sentences[text] = None
        return list(sentences)

    def _chosen(self, only: Collection[str] | None, people: str) -> list[list[Act]]:
        """The acts that a caption tells, in groups that follow each other."""
        everything = [act for group in self._groups for act in group if only is None or act.id in only]
        acts = [act for act in everything if set(act.agents) & set(people)]
        if len(people) == 1:
            acts = [act.model_copy(update={"agents": (people,)}) for act in acts]
        active = [act for act in acts if act.act != STILL]
        keep_still = len(people) == 1 or self.rng.random() < 0.25
        chosen = acts if keep_still or not active else active
        main = [act for act in chosen if only is not None or act.id not in self.label.minor or self.rng.random() < 0.5]
        kept = {act.id for act in main or chosen}
        told = {act.id: act for act in acts}
        groups = [[told[act.id] for act in group if act.id in kept] for group in self._groups]
        return _without_repeats([group for group in groups if group])


def _without_repeats(groups: list[list[Act]]) -> list[list[Act]]:
    """The groups without saying again that a person stands still, where the group before says it."""
    shortened: list[list[Act]] = []
    still: set[tuple[str, ...]] = set()
    for group in groups:
        kept = [act for act in group if act.act != STILL or act.agents not in still]
        still = {act.agents for act in group if act.act == STILL}
        if kept:
            shortened.append(kept)
    return shortened


class _Writer:
    """One caption in the making.

    Attributes:
        test: whether it uses words that are kept for the test split.
        going: whether it says what the people are doing, as in "is waving".
    """

    def __init__(self, rng: Rng, cast: Cast, split: str, *, alone: bool) -> None:
        self.rng, self.split, self.alone = rng, split, alone
        self.names = Names(rng, cast)
        self.test = held_out(cast.first[0] + cast.first[1])
        self.going = False

    def write(self, groups: Sequence[Sequence[Act]]) -> str:
        """The caption of acts in groups that follow each other."""
        self.going = len(groups) == 1 and self.rng.random() < 0.25
        pair = len(groups) == 2 and not self.alone and self.rng.random() < 0.4
        link = self._one_of(WORDS["pairs"]) if pair else ""
        text = ""
        last: list[str] = []
        clauses: list[str] = []
        for group in groups:
            made, last = self._clause(group, [] if pair else last)
            clauses.append(made)
            text += made if made[0] in ", " or not text or pair else self._one_of(WORDS["then"]).format(made)
        if pair:
            text = link.format(*clauses)
        if self.rng.random() < 0.15:
            text = f"{self._one_of(WORDS['places'])}, {text[:1].lower()}{text[1:]}"
        return finished(text)

    def _one_of(self, items: Sequence[str]) -> str:
        return items[int(self.rng.integers(len(items)))]

    def _pick(self, items: Sequence[str]) -> str:
        """One phrase; a training caption avoids those that are held out, unless there are no others."""
        free = [text for text in items if not held_out(text)]
        chosen = self._one_of(free if free and self.split != "test" else items)
        self.test |= bool(free) and held_out(chosen)
        return chosen

    def _clause(self, group: Sequence[Act], last: Sequence[str]) -> tuple[str, list[str]]:
        """A clause on acts at the same time, and its subjects.

        It begins with a comma or a space where it goes on with the subject of the clause before, ``last``.
        """
        subjects = list(dict.fromkeys("".join(sorted(act.agents)) for act in group))
        if subjects == list(last) and len(subjects) == 1 and (self.alone or self.rng.random() < 0.6):
            link = self._one_of((", and then ", " and then ", " and ", ", then "))
            return f"{link}{self._phrases(group, subjects[0])}", subjects
        parts = []
        for subject in subjects:
            own = [act for act in group if "".join(sorted(act.agents)) == subject]
            parts.append(f"{self.names.subject(subject)} {self._phrases(own, subject)}")
        return " while ".join(parts), subjects

    def _phrases(self, acts: Sequence[Act], subject: str) -> str:
        """The verb phrases of acts of one subject at the same time."""
        both = len(subject) == 2
        form = ("are" if both else "is") if self.going else "plural" if both else "s"
        return " while ".join(self._phrase(act, "ing" if k else form) for k, act in enumerate(acts))

    def _phrase(self, act: Act, form: str) -> str:
        sided = act.side is not None and self.rng.random() < 0.5
        phrases = fitting(act, sided=sided)
        usual = [text for text in phrases if text in entry(act.act).caption]
        phrase = self._pick(usual if usual and self.rng.random() < 0.5 else phrases)
        both = len(act.agents) == 2
        other = "b" if act.agents[0] == "a" else "a"
        whom = ""
        if "{b}" in phrase:  # "pats her shoulder" may be one's own
            whom = "each other" if both else self.names.object(other, pronoun="{b}'s" not in phrase)
        if act.modality == "offered":
            phrase = VERB.sub(r"[offer] to \1", phrase, count=1)
        text = spoken(act, phrase, whom, self.names.own(act.agents), form)
        if act.manner and self.rng.random() < 0.4:
            text = f"{text} {act.manner[0]}"
        return text


def finished(text: str) -> str:
    """Capitalised, with a full stop, single spaces."""
    text = re.sub(r"\s+", " ", text).strip().rstrip(".") + "."
    text = re.sub(r"([.!?] )([a-z])", lambda match: match[1] + match[2].upper(), text)
    return text[:1].upper() + text[1:]
