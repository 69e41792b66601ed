"""Verb phrases of an act from its entry: its captions, also with other verbs of its frames, and its plainer frames;
and the names of two people.

A phrase is written as captions are (:mod:`acts.captions`), ``{a+b}`` for what is only said of both.
"""

from __future__ import annotations

import re
import zlib
from collections import Counter
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

from acts import Act
from acts.captions import VERB, gerund, plural, singular
from acts.frames import PREPOSITIONS, Frame
from acts.lexicon import Entry, lexicon
from acts.reading import read
from acts.reading.vocabulary import closed

from .cues import WORDS, entry

Rng = np.random.Generator
HELD_OUT = 6
"""Percentage of the phrases and names that are kept for captions of the test split."""
_SLOT = re.compile(r"\{([a-z]+)\}")
_ONE_EACH = re.compile(r"\btheir (head|face|chest|fist|ear|guard|temper)\b")
_LIGHT = ("be", "do", "go", "have", "make", "remain")
"""Verbs that stand in no other's place."""
_PLAIN = PREPOSITIONS | {"back", "together", "apart", "forward", "backward", "backwards"}
"""Words of a frame that need no article."""


def held_out(text: str) -> bool:
    """True if a phrase is kept for captions of the test split."""
    return zlib.crc32(text.encode()) % 100 < HELD_OUT


@cache
def phrases(name: str) -> tuple[str, ...]:
    """All phrases of an entry.

    A caption by another verb than its frames, or that other entries share, is left out where there are others: it keeps
    to the words that the network knew, as "turns around" for looking around.
    """
    known = entry(name)
    shared = _shared()
    verbs = {verb.replace("-", "") for frame in known.frames for verb in Frame.parse(frame).verbs}
    own = [text for text in known.caption if _verb(text) in verbs and text not in shared]
    if all(text.startswith("{a+b}") for text in own):
        own += known.caption[:1]
    others = [other for text in own for other in _reworded(text, known)]
    return tuple(dict.fromkeys([*own, *others, *_of_frames(known)]))


@cache
def _shared() -> frozenset[str]:
    """Captions of more than one entry."""
    counts = Counter(text for known in lexicon().entries.values() for text in set(known.caption))
    return frozenset(text for text, count in counts.items() if count > 1)


def _verb(phrase: str) -> str:
    return VERB.findall(phrase)[0].replace("-", "")


def _reworded(phrase: str, known: Entry) -> list[str]:
    """The phrase by other verbs of the entry's frames that hold its verb."""
    verb = _verb(phrase)
    verbs: dict[str, None] = {}
    for frame in known.frames:
        alike = Frame.parse(frame).verbs
        if verb in alike:
            verbs |= dict.fromkeys(sorted(other for other in alike - {verb} if other not in _LIGHT))
    return [VERB.sub(f"[{other}]", phrase, count=1) for other in verbs]


def _of_frames(known: Entry) -> list[str]:
    """The entry's frames that are nothing but verbs, particles and the other person."""
    captions = []
    for frame in known.frames:
        subject, verbs, *rest = frame.replace("?", "").split()
        if all(word == "{b}" or _PLAIN.issuperset(word.split("|")) for word in rest):
            choices = product([v for v in verbs.split("|") if v not in _LIGHT], *(w.split("|") for w in rest))
            captions += [" ".join([subject, f"[{verb}]", *words]) for verb, *words in choices]
    return captions


@cache
def reads_back(name: str, phrase: str, *, both: bool) -> bool:
    """True if a sentence by this phrase is read as the entry and as nothing else.

    Args:
        both: as it is said of two people at once; else of one.
    """
    act = Act(
        id="1",
        act=name,
        agents=("a", "b") if both else ("a",),
        part="shoulder" if "{part}" in phrase else None,
        direction="forward" if "{direction}" in phrase else None,
        side="left" if names_side(phrase) else None,
    )
    who, *form = ("they", "each other", "their", "plural") if both else ("he", "the woman", "his", "s")
    acts = read(f"A man jumps, and then {who} {spoken(act, phrase, *form)}.").acts
    return [one.act for one in acts] == ["jump", name] and acts[1].speed == 1.0


def fitting(act: Act, *, sided: bool) -> list[str]:
    """The phrases that fit an act's number of people and what is known of it.

    Args:
        sided: only those that name the act's side, if there are any; else only those that name none.
    """
    both = len(act.agents) == 2
    texts = [text for text in phrases(act.act) if both or not text.startswith("{a+b}")]
    if both and entry(act.act).to != "other":
        mutual = [text for text in texts if text.startswith("{a+b}") or "{b}" in text]
        texts = mutual or texts
    texts = [text for text in texts if reads_back(act.act, text, both=both)] or texts
    texts = [text for text in texts if act.part or "{part}" not in text]
    texts = [text for text in texts if act.direction or "{direction}" not in text]
    texts = [text for text in texts if act.thing or "{thing}" not in text] or texts
    if both and act.side != "both":  # "they wave with the left hand" has one hand of the two
        texts = [text for text in texts if "with {limb}" not in text and "{side}" not in text] or texts
    with_side = [text for text in texts if "{limb}" in text or ("{side}" in text and act.side != "both")]
    return with_side if sided and with_side else [text for text in texts if not names_side(text)] or texts


def spoken(act: Act, phrase: str, other: str, whose: str, form: str) -> str:
    """A phrase as a verb phrase: "waves at the other person with the left hand".

    Args:
        other: name of the other person, or "each other".
        whose: "his", "her" or "their", of the agent.
        form: "s" (waves), "plural" (wave), "ing" (waving), "is" (is waving) or "are" (are waving).
    """
    if form in ("is", "are"):
        return f"{form} {spoken(act, phrase, other, whose, 'ing')}"
    inflected = {"s": singular, "ing": gerund}.get(form, str)
    text = VERB.sub(lambda match: inflected(match[1]), phrase).partition(" ")[2]
    limb = act.part if act.part in closed("limbs") and "{part}" not in phrase else "hand"
    limbs = {"both": f"both {plural(limb)}", None: f"a {limb}"}
    values = {
        "part": act.part or "",
        "side": act.side if act.side in ("left", "right") else "",
        "limb": limbs.get(act.side, f"the {act.side} {limb}"),
        "thing": act.thing or "something",
        "direction": act.direction or "",
    }
    text = _SLOT.sub(lambda match: values.get(match[1], match[0]), text)
    if form != "s" and len(act.agents) == 2:
        text = _ONE_EACH.sub(lambda match: f"their {match[1]}s", text)
    text = text.replace("{b}", other)
    text = re.sub(r"\btheir\b", whose, text)
    return " ".join(text.split())


def names_side(phrase: str) -> bool:
    """True if a phrase names the side of the act."""
    return "{limb}" in phrase or "{side}" in phrase


# ---- names of two people -------------------------------------------------------------------------
@dataclass(frozen=True)
class Cast:
    """Names of two people.

    Attributes:
        first: names at the first mention, of the person named first and of the other.
        later: their names afterwards.
        pronouns: "he", "she" or "they" of each.
        group: name of both together; None for "two people".
    """

    first: tuple[str, str]
    later: tuple[str, str]
    pronouns: tuple[str, str] = ("they", "they")
    group: str | None = None


OBJECTS = {"he": "him", "she": "her"}
OWN = {"they": "their", "he": "his", "she": "her"}
_CASTS = [Cast(**{name: tuple(v) if name != "group" else v for name, v in cast.items()}) for cast in WORDS["casts"]]
_ROLES = WORDS["roles"]


def draw_cast(rng: Rng, *, joint: bool = False) -> Cast:
    """Three of five times plain words ("one person"), else roles; of two who begin together mostly plain words."""
    if rng.random() < (0.85 if joint else 0.6):
        return _CASTS[int(rng.integers(len(_CASTS)))]
    pairs = (("he", "she"), ("she", "he"), ("he", "they"), ("they", "she"), ("they", "they"), ("she", "they"))
    pronouns = pairs[int(rng.integers(len(pairs)))]
    one, other = (_ROLES[p][int(rng.integers(len(_ROLES[p])))] for p in pronouns)
    if one == other:
        return draw_cast(rng, joint=joint)
    later = tuple(re.sub("^an? ", "the ", name) for name in (one, other))
    return Cast((one, other), (later[0], later[1]), pronouns, f"{one} and {other}")


class Names:
    """The names of a and b through one caption.

    Attributes:
        order: the people in the order in which the caption names them.
    """

    def __init__(self, rng: Rng, cast: Cast) -> None:
        self.rng, self.cast = rng, cast
        self.order: list[str] = []
        self.named: set[str] = set()
        self.together = False

    def _slot(self, who: str) -> int:
        if who not in self.order:
            self.order.append(who)
        return self.order.index(who)

    def _name(self, who: str) -> str:
        slot = self._slot(who)
        fresh = who not in self.named
        self.named.add(who)
        if fresh and self.together and self.cast.group is None:  # "two people …, one of them …"
            return ("one of them", "the other")[slot] if len(self.named) < 2 or slot else self.cast.later[slot]
        return self.cast.first[slot] if fresh and not self.together else self.cast.later[slot]

    def subject(self, people: str) -> str:
        """The subject of a clause: "a", "b" or "ab"."""
        if len(people) == 1:
            return self._name(people)
        if self.together or self.named:
            if len(self.named) == 1 and not self.together:
                self._name("b" if "a" in self.named else "a")
            self.together = True
            return ("they", "the two", "the two of them")[int(self.rng.integers(3))]  # "both" may be hands
        self.together = True
        for who in "ab":
            self._slot(who)
        group = self.cast.group
        return group or ("two people", "two people", "the two people", "they")[int(self.rng.integers(4))]

    def object(self, who: str, *, pronoun: bool = True) -> str:
        """The other person as an object; once named, half of the time "him" or "her" where a ``pronoun`` may stand."""
        known = self.cast.pronouns[self._slot(who)]
        if pronoun and who in self.named and known != "they" and self.rng.random() < 0.5:
            return OBJECTS[known]
        return self._name(who)

    def own(self, people: tuple[str, ...]) -> str:
        """ "his", "her" or "their": of the subject."""
        return "their" if len(people) == 2 else OWN[self.cast.pronouns[self._slot(people[0])]]
