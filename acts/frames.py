"""Frames: the syntax in which an act is said, as ``{a} put|lay {a.hand} on {b.part:shoulder}``.

A frame is a subject, the lemmas of its verb, and what must stand beside it:

- ``{a}`` one person or both, each for themselves; ``{a+b}`` the two together ("they hug", "he dances with her");
- ``{b}`` the other person ("each other" after both); ``{each}`` only "each other"; ``{self}``; ``{thing}`` any noun
  that is no person and no part of the body; ``{part}`` a part of a body, ``{a.part}`` one's own, ``{b.part}`` the
  other's, ``{b.part:head}`` one of a family;
- a preposition before a slot or a noun: ``on {b.part}``, ``to {b}``, ``on floor|ground``; with ``from? {b}`` it may
  also be the object;
- any other word: a particle, an adverb, a complement, or the object's noun: ``sit down``, ``shake hand``; of a part of
  the body in the plural, both: ``put arms around {b}``.

``w|v`` are alternatives, and ``w?`` may be missing. In a lexicon, ``walk+``, ``run+`` and ``gait+`` stand for all of
:data:`FAMILIES`. A frame fits an event if all of its elements are there; other arguments count against it, and an
object that no element asks for rules it out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from acts.plan import Span, other_of
from motion import InputError

_PREPOSITIONS = (
    "about above across after against along alongside among around at away before behind below beneath "
    "beside between beyond by down for from in inside into like near next of off on onto out over past "
    "round through to toward towards under underneath up upon with within without"
)
PREPOSITIONS = frozenset(_PREPOSITIONS.split())
_DIRECTIONS = frozenset(("across", "along", "around", "back", "by", "in", "out", "over", "past", "up"))
"""Particles that only say where somebody goes; "away", "off" and "down" say more."""
_PARTICLES = PREPOSITIONS | {"back"}
FAMILIES = {
    "walk+": "walk|go|come|step|stroll|march|wander|stride|saunter|amble|trot|head|move|hurry|rush|drift|gait+",
    "gait+": "limp|hobble|skip|prance|gallop|crawl|stagger|totter|lurch|reel|weave|teeter|sneak|creep|tiptoe|slink|"
    "prowl",
    "run+": "run|sprint|dash|race|bolt|charge|dart|jog",
}
"""Verbs that an entry need not list."""
_SLOTS = frozenset(("a", "a+b", "b", "each", "self", "thing", "part", "place"))


@dataclass(frozen=True)
class Ref:
    """The person, part of the body or thing that a noun or pronoun stands for.

    Attributes:
        kind: "person", "part", "self", "each" (each other), "thing", "third" (a person who is neither of the two).
        who: the people, "a", "b" or "ab"; of a part or a thing, its owner, "" where the words leave that open.
        lemma: of the head.
        family: of a part: "hand", "head", ….
        side: of a part, "left", "right" or "both".
        place: a thing where people can be, as a room.
        bare: a thing in the singular without an article, as in "in surprise"; a part without a possessive.
        definite: of a part, behind "the".
        first, last: character offsets in the text that was parsed.
    """

    kind: Literal["person", "part", "self", "each", "thing", "third"]
    who: str = ""
    lemma: str = ""
    family: str = ""
    side: str = ""
    place: bool = False
    bare: bool = False
    definite: bool = False
    first: int = 0
    last: int = 0


@dataclass
class Event:
    """A verb of a text with its arguments: what frames are held against.

    Attributes:
        lemma: of the verb.
        subject, object, dative: its arguments.
        words: lemmas of particles, adverbs and complements beside it.
        particles: those of ``words`` that belong to the verb, as "up" in "picks up".
        prepositions: (preposition, argument).
        denied, modality: of the clause.
        ongoing: it goes on when the clause begins, as in "is sitting" and "keeps walking".
        state: a phrase says it that hangs on a noun, as in "the lady on the bench".
        joint: how it is joined to event ``beside``, as in :class:`acts.plan.Relation`.
        first, last: character offsets in the text that was parsed.
        goes: its verb means that somebody moves, so that a particle may just say where to, as in "jumps out".
        said: where in the text the words stand that say it, if that is only a part of its verb's clause.
        adverbs, seconds, times, distance, direction, side: modifiers.
    """

    lemma: str
    subject: Ref | None = None
    object: Ref | None = None
    dative: Ref | None = None
    words: list[str] = field(default_factory=list)
    particles: list[str] = field(default_factory=list)
    prepositions: list[tuple[str, Ref]] = field(default_factory=list)
    denied: bool = False
    ongoing: bool = False
    state: bool = False
    modality: str = "told"
    joint: str = ""
    beside: int | None = None
    first: int = 0
    last: int = 0
    adverbs: list[str] = field(default_factory=list)
    seconds: float | None = None
    times: int | None = None
    distance: float | None = None
    direction: str | None = None
    side: str | None = None
    goes: bool = False
    said: Span | None = None
    noun: Event | None = None
    """The same with the verb that its noun stands for: "gives a hug" as "hugs"."""

    def bare(self, lemma: str, **arguments: Any) -> Event:
        """The clause with another verb, without the arguments and modifiers of its own but for these."""
        kept = {name: getattr(self, name) for name in ("denied", "ongoing", "state", "modality", "first", "last")}
        return Event(lemma, **(kept | arguments))


@dataclass(frozen=True)
class Match:
    """The fit of a frame to an event: how good it is, and what the slots stand for."""

    score: float
    agents: str
    patient: str = ""
    thing: str = ""
    part: Ref | None = None
    rest: tuple[int, ...] = ()
    """The event's prepositions that no element took, by number."""
    left: int = 0
    """Prepositions and particles that no element took."""
    own: bool = False
    """It is about a part of the agent's own body with a possessive: "grabs his chest", which may be either's."""


@dataclass(frozen=True)
class _Element:
    words: frozenset[str] = frozenset()
    slot: str = ""
    family: frozenset[str] = frozenset()
    prepositions: frozenset[str] = frozenset()
    optional: bool = False
    direct: bool = False


@dataclass(frozen=True)
class Frame:
    """A compiled frame; see the module."""

    text: str
    subject: str
    verbs: frozenset[str]
    elements: tuple[_Element, ...]

    @classmethod
    def parse(cls, text: str, to_other: bool = False) -> Frame:
        """Compiles a frame; raises InputError with a sentence that says what is wrong.

        Args:
            text: as it stands in an entry.
            to_other: the act is done to the other person even where the words do not name them.
        """
        tokens = text.split()
        if len(tokens) < 2 or not (tokens[0].startswith("{") and tokens[0].endswith("}")):
            raise InputError(f'A frame begins with a slot and a verb, as in "{{a}} wave", not {text!r:.80}.')
        subject = tokens[0][1:-1]
        if subject not in ("a", "a+b", "part", "a.part", "thing") and not subject.startswith("a.part:"):
            raise InputError(f"A frame's subject is {{a}}, {{a+b}}, {{a.part}} or {{thing}}, not {tokens[0]!r:.40}.")
        elements: list[_Element] = []
        i = 2
        while i < len(tokens):
            token, optional = tokens[i].removesuffix("?"), tokens[i].endswith("?")
            before = frozenset(token.split("|"))
            if before <= PREPOSITIONS and i + 1 < len(tokens) and not _is_particle(token, tokens[i + 1]):
                i += 1
                element = _element(tokens[i].removesuffix("?"), before, tokens[i].endswith("?"), text)
                elements.append(replace(element, direct=optional))
            else:
                elements.append(_element(token, frozenset(), optional, text))
            i += 1
        if to_other:
            elements = [replace(e, optional=True) if e == _Element(slot="b") else e for e in elements]
        return cls(text, subject, frozenset(tokens[1].split("|")), tuple(elements))

    def fits(self, event: Event) -> Match | None:
        """The match of this frame and an event, whatever its verb; None if it does not fit."""
        agents = self._agents(event)
        if agents is None:
            return None
        together = self.subject == "a+b"
        both = together and len(agents) == 2
        bound: dict[str, Ref] = {}
        used: list[int] = []
        taken: set[str] = set()
        score = 0.3 if both else 0.0
        for element in self.elements:
            ref = _found(element, event, agents, used, taken)
            if ref is None:
                if element.optional:
                    continue
                return None
            score += 2.0 if isinstance(ref, Ref) and element.slot != "thing" else 1.6
            if element.prepositions and not element.direct:
                score += 0.6
            if element.words:
                score += 0.9
            if element.family:  # a part that a frame itself names is nearer than one of its family
                score += 0.5 if isinstance(ref, Ref) and ref.lemma in element.family - {ref.family} else 0.4
            if isinstance(ref, Ref):
                own = ref.who == "ab" or (ref.definite and not ref.who)
                if element.slot == "b.part" and len(agents) == 2 and own:
                    score -= _OWN
                elif element.slot == "b.part" and ref.bare and not ref.who and "b" not in bound:
                    score -= _OPEN
                name = element.slot.partition(".")[2] or element.slot
                if name not in bound or element.slot == "b.part":  # "a hand on his shoulder" is about the shoulder
                    bound[name] = ref
        if event.object is not None and "object" not in taken:
            if not (together and event.object.kind in ("person", "each")):
                return None
            score += 1.0
        if event.dative is not None and "dative" not in taken:
            return None
        score += _beside(event, used, taken, together)
        rest = tuple(i for i in range(len(event.prepositions)) if i not in used)
        return Match(
            score,
            agents,
            self._patient(bound, agents) or _receiver(event, agents),
            bound["thing"].lemma if "thing" in bound else "",
            bound.get("part"),
            rest,
            len(rest) + sum(word not in taken for word in event.particles),
            self.of_agent() and "part" in bound and not bound["part"].bare,
        )

    def particles(self) -> Iterator[str]:
        """Particles that belong to the verb, as "up" in "stand up"."""
        for element in self.elements:
            if not element.slot and not element.prepositions and not element.optional:
                yield from element.words & PREPOSITIONS

    def of_agent(self) -> bool:
        """True if the part of the body that it names is the agent's own."""
        return any(element.slot == "a.part" for element in self.elements) and not self._of_other()

    def _patient(self, bound: Mapping[str, Ref], agents: str) -> str:
        """The person to whom it is done, as the slots say; "" if they do not."""
        patient = bound.get("b")
        part = bound.get("part")
        who = patient.who if patient is not None and patient.kind == "person" else ""
        if not who and part is not None and self._of_other() and len(agents) == 1:
            who = other_of(agents)
        if self.subject == "a+b" and len(agents) == 1:
            who = other_of(agents)
        if len(who) == 2:
            who = other_of(agents) if len(agents) == 1 else ""
        return who if who not in agents else ""

    def _of_other(self) -> bool:
        return any(element.slot == "b.part" for element in self.elements)

    def _agents(self, event: Event) -> str | None:
        subject = event.subject
        if subject is None:
            return None
        if self.subject.startswith(("a.part", "part")):
            family = self.subject.partition(":")[2]
            fits = subject.kind == "part" and (not family or subject.family in family.split("|"))
            return (subject.who or "ab") if fits else None
        if self.subject == "thing":
            return "ab" if subject.kind == "thing" else None
        if subject.kind != "person":
            return None
        if self.subject == "a+b":
            with_other = len(subject.who) == 2 or any(
                ref.kind in ("person", "each") and ref.who != subject.who for _, ref in event.prepositions
            )
            return subject.who if with_other or (event.object and event.object.kind == "person") else None
        return subject.who


_OWN = 2.5
"""What it costs that "the arm" or "their arms" of two who do something should be the other's."""

_OPEN = 0.5
"""What it costs that "the wrist" should be the other's, where nothing names them: it is rather one's own."""


def _beside(event: Event, used: list[int], taken: set[str], together: bool) -> float:
    """The score that arguments and particles beside a frame add."""
    score = 0.0
    for i, (preposition, ref) in enumerate(event.prepositions):
        if i in used:
            continue
        if together and preposition in ("with", "against", "to") and ref.kind in ("person", "each"):
            score += 0.8
        else:
            score -= 0.7 if ref.kind in ("person", "part") else 0.3
    left = [word for word in event.particles if word not in taken]
    score -= sum(0.5 if event.goes and word in _DIRECTIONS else 1.5 for word in left)
    return score


def _receiver(event: Event, agents: str) -> str:
    """The other person, if what the words name beside the frame is theirs or done for them; else ""."""
    other = other_of(agents)
    named = [ref for word, ref in event.prepositions if word not in ("without", "like")]
    for ref in (event.object, *named):
        if other and ref is not None and ref.kind in ("person", "part", "thing") and ref.who == other:
            return other
    return ""


def _is_particle(token: str, following: str) -> bool:
    """True for a preposition that stands for itself, as "up" in "up to {b}"."""
    words = frozenset(following.removesuffix("?").split("|"))
    return words <= PREPOSITIONS or token.endswith("?")


def _element(token: str, prepositions: frozenset[str], optional: bool, text: str) -> _Element:
    if not token.startswith("{"):
        return _Element(frozenset(token.split("|")), "", frozenset(), prepositions, optional)
    slot, _, family = token[1:-1].partition(":")
    if slot not in _SLOTS and slot not in ("a.part", "b.part"):
        raise InputError(f"{token} in the frame {text!r:.80} is not a slot: use {{b}}, {{thing}}, {{part}}, ….")
    return _Element(frozenset(), slot, frozenset(family.split("|")) - {""}, prepositions, optional)


def _found(element: _Element, event: Event, agents: str, used: list[int], taken: set[str]) -> Ref | bool | None:
    """The argument that fills an element of a frame; True for a word; None if nothing does."""
    if element.prepositions:
        for i, (preposition, ref) in enumerate(event.prepositions):
            if i not in used and preposition in element.prepositions and _fills(element, ref, agents, event):
                used.append(i)
                taken.add(preposition)
                return ref
        if event.dative is not None and "to" in element.prepositions and _fills(element, event.dative, agents, event):
            taken.add("dative")
            return event.dative
        if not element.direct:
            return None
    if element.words:
        for word in event.words:
            if word in element.words:
                taken.add(word)
                return True
        if event.object is not None and "object" not in taken and _is_noun(element, event.object, agents):
            taken.add("object")
            return True
        for i, (preposition, ref) in enumerate(event.prepositions):  # "from behind", but not "like a top"
            if ref.lemma in element.words and ref.kind == "thing" and preposition != "like":
                used.append(i)
                return True
        return None
    for name, argument in (("object", event.object), ("dative", event.dative)):
        if argument is not None and name not in taken and _fills(element, argument, agents, event):
            taken.add(name)
            return argument
    return None


def _fills(element: _Element, ref: Ref, agents: str, event: Event) -> bool:
    if element.words:
        return _is_noun(element, ref, agents)
    match element.slot:
        case "b":
            return (ref.kind == "person" and ref.who != agents) or (ref.kind == "each" and len(agents) == 2)
        case "each":
            return ref.kind == "each" and len(agents) == 2
        case "self":
            return ref.kind == "self" or (ref.kind == "person" and ref.who == agents and len(agents) == 1)
        case "thing":
            return ref.kind == "thing"
        case "place":
            return ref.kind == "thing" and ref.place
    if ref.kind != "part" or (element.family and not element.family & {ref.family, ref.lemma}):
        return False
    if element.slot == "a.part":
        return ref.who in ("", agents) or (len(agents) == 1 and ref.who == "ab")
    if element.slot == "b.part":
        return ref.who in ("", "each") or ref.who != agents or len(agents) == 2
    return True


def _is_noun(element: _Element, ref: Ref, agents: str) -> bool:
    """True if a noun is one of an element's; "combs hair" is about one's own, and not "combs her hair" of another."""
    others = ref.kind == "part" and len(agents) == 1 and ref.who not in ("", "ab", agents)
    particle = ref.kind == "part" and element.words & _PARTICLES  # "turns his back" is not "turns back"
    plural = ref.side == "both" and f"{ref.lemma}s" in element.words
    return (plural or ref.lemma in element.words) and not others and not particle


def best(frames: Mapping[str, list[tuple[str, Frame]]], event: Event) -> tuple[str, Frame, Match] | None:
    """The name, frame and match of the frame that fits an event best, of those that know its verb."""
    fitting = []
    for form in [event] if event.noun is None else [event, event.noun]:
        for name, frame in frames.get(form.lemma, ()):
            if (match := frame.fits(form)) is None:
                continue
            handed = event.object is not None and match.thing == event.object.lemma
            if form is event and event.noun is not None and handed:  # "gives a hug" hands nothing over
                match = replace(match, score=match.score - 5.0)
            where = all(ref is not match.part for word, ref in form.prepositions if word == "with")  # and not with what
            fitting.append(((match.score, where, match.own, -len(frame.elements)), (name, frame, match)))
    return max(fitting, key=lambda each: each[0])[1] if fitting else None
