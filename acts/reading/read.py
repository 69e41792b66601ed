"""Sentence → plan, once: prepared, parsed, taken apart into events, and matched against the lexicon."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from acts.frames import Event, Frame, Match, Ref
from acts.lexicon import Lexicon, lexicon
from acts.plan import MOST_ACTS, Act, Plan, Relation, Span, Unread
from acts.shapes import Go
from motion import InputError

from . import order
from .clauses import spans
from .events import Reader
from .language import other_language, unknown
from .matching import Found, matcher
from .spelling import Speller
from .syntax import parse
from .vocabulary import vocabulary
from .wording import Text, prepared

MOST_CHARACTERS = 2000
"""Characters of a text that is read at once."""
_STATES = frozenset(("be", "become", "seem", "have", "there", "feel", "look", "appear"))
"""Verbs that say how somebody is; where no frame knows them, they show nothing and are passed over."""
_SHARING = frozenset(("conj", "after", "with"))
"""Joints of clauses that may share an object."""
_SAME = frozenset(("same", "it", "that", "this", "likewise", "so"))
_MOVEMENTS = frozenset(("movement", "move", "gesture", "motion", "pose", "step", "action"))
_LINE = Ref("thing", lemma="line")
_HELD = frozenset(("crossed", "folded", "cross", "fold", "outstretched", "raised", "raise", "outstretch"))
"""Participles of postures of the arms, and the parser's lemmas of them."""


def _is_next_to(event: Event) -> bool:
    """True for what is done beside the other: "lies down next to her"."""
    near = (p for p, ref in event.prepositions if ref.kind == "person")
    return any(p in ("beside", "alongside") or (p == "to" and "next" in event.words) for p in near)


def read(text: str, folders: tuple[Path, ...] = ()) -> Plan:
    """The plan of an English text.

    Args:
        text: one sentence or several, at most :data:`MOST_CHARACTERS`.
        folders: further folders of acts, beside ours and those of the settings.

    Raises:
        InputError: if the text is too long, or the parser is not installed.
    """
    if len(text) > MOST_CHARACTERS:
        raise InputError(
            f"The text has {len(text)} characters: shorten it to {MOST_CHARACTERS}, or use several beats."
        )
    return _read(text, lexicon(folders))


@lru_cache(maxsize=512)
def _read(text: str, known: Lexicon) -> Plan:
    if not text.strip():
        return Plan(sentence=text, notes=("Nothing is said: write what the two people do.",))
    if (foreign := other_language(text)) is not None:
        return Plan(
            sentence=text,
            unread=(Unread(words=Span(start=0, stop=len(text)), why=foreign),),
            notes=(foreign,),
        )
    speller = Speller(known)
    prepared_text = prepared(text, speller.mended, speller.is_form)
    doc = parse(prepared_text.parsed)
    lemmas: dict[int, str] = {}
    if changes := speller.verbs_found(doc):
        # the new words may be longer: what counts is which of the words they are
        numbers = {doc_token.i: changes[doc_token.idx] for doc_token in doc if doc_token.idx in changes}
        prepared_text = prepared_text.replaced({at: word for at, (word, _) in changes.items()})
        doc = parse(prepared_text.parsed)
        lemmas = {i: lemma for i, (word, lemma) in numbers.items() if i < len(doc) and doc[i].text == word}
    reader = Reader(doc, frozenset(known.frames), lemmas, speller.forms)
    events = reader.read()
    return _Planner(text, prepared_text, known, events, list(spans(doc, events)), reader).plan()


class _Planner:
    """Turns events into acts."""

    def __init__(
        self, text: str, prepared_text: Text, known: Lexicon, events: Sequence[Event],
        clauses: Sequence[tuple[int, int]], reader: Reader,
    ) -> None:  # fmt: skip
        self._text, self._prepared, self._known = text, prepared_text, known
        self._events, self._clauses, self._reader = events, clauses, reader
        self._matcher = matcher(known)
        self._acts: list[Act] = []
        self._unread: list[Unread] = []
        self._of: dict[int, str] = {}
        self._taken: set[int] = set()
        self._nonsense = list(unknown(reader.doc, Speller(known).knows))
        self._held_beside: dict[str, str] = {}
        self._answers: set[str] = set()
        """Acts that repeat the one before."""

    def plan(self) -> Plan:
        """The plan."""
        for number, event in enumerate(self._events):
            if number in self._taken or len(self._acts) == MOST_ACTS:
                continue
            self._event(number, event)
        self._order()
        self._unknown_words()
        people = self._reader.cast.people()
        things = dict.fromkeys(act.thing for act in self._acts if act.thing)
        notes = []
        if self._reader.cast.third:
            notes.append("Only two people can be shown: the others that are named do nothing.")
        if not self._acts and not self._unread:
            span = Span(start=0, stop=len(self._text))
            self._unread.append(Unread(words=span, why="Nothing in this text is something that people do."))
        return Plan(
            sentence=self._text, people=people, things=tuple(things)[:20], acts=tuple(self._acts),
            unread=tuple(self._unread[:60]), notes=tuple(notes),
        )  # fmt: skip

    def _event(self, number: int, event: Event) -> None:
        inner = [
            i for i, other in enumerate(self._events) if other.beside == number and other.joint == "comp"
        ]
        if self._in_turn(number, event) or self._repeated(number, event, bool(inner)):
            return
        found = self._matcher.find(event)
        if self._about_another(event) and inner and (found is None or found[2].score < 2.4):
            return
        if found is None:
            borrowed = (self._matcher.find(other) for other in self._completed(number, event))
            found = next((other for other in borrowed if other is not None), None)
        if found is not None and not self._known.entries[found[0]].shown:
            self._unread.append(Unread(words=self._span(number), why="This is nothing that bodies show."))
        elif found is not None:
            if inner and any(
                self._events[i].lemma in f for f in (e.words for e in found[1].elements) for i in inner
            ):
                self._taken.update(inner)
            self._add(number, event, *found)
            self._held(number, event, found)
            self._beside(number, event, found)
            self._seated(number, event, found)
        elif event.lemma not in _STATES and not (inner and self._about_another(event)):
            self._not_read(number, event)

    def _in_turn(self, number: int, event: Event) -> bool:
        """Passes "take turns" on to the verb of what is done in turn; False for other verbs."""
        turns = event.lemma == "take" and event.object is not None and event.object.lemma == "turn"
        done = [other for other in self._events if other.beside == number and turns]
        for other in done:
            other.adverbs.append("in turn")
        return bool(done)

    def _repeated(self, number: int, event: Event, has_inner: bool) -> bool:
        """Adds the last act once more where the words say so: "and B copies it", "he does", "she refuses"."""
        verbs, subject, last = vocabulary().verbs, event.subject, next(reversed(self._acts), None)
        repeats = event.lemma in verbs["repeats"]
        ref = event.object
        named = ref is None or ref.lemma in _SAME or ref.kind == "person"
        named = named or (repeats and ref is not None and (ref.kind == "part" or ref.lemma in _MOVEMENTS))
        if last is None or subject is None or subject.kind != "person" or not named or has_inner:
            return False
        declines = event.lemma in verbs["not"] | verbs["wished"]
        if event.lemma != "do" and not repeats and not declines:
            return False
        if declines and (event.object is not None or not (event.denied or event.lemma in verbs["not"])):
            return False
        agents, other = tuple(subject.who), "b" if subject.who == "a" else "a"
        if len(last.agents) > 1 or (len(agents) > 1 and event.lemma != "do"):
            return False
        both = len(agents) > 1 or last.patient is None
        patient = None if both else (last.patient if agents == last.agents else other)
        denied = declines or event.denied
        number_of = str(len(self._acts) + 1)
        told = {
            "id": number_of,
            "agents": agents,
            "patient": patient,
            "modality": "told",
            "order": (),
            "already": False,
        }
        self._acts.append(
            last.model_copy(
                update={**told, "polarity": "not" if denied else "done", "words": self._span(number)}
            )
        )
        self._of[number] = number_of
        self._answers.add(number_of)
        return True

    def _seated(self, number: int, event: Event, found: Found) -> None:
        """Adds that somebody sits where a phrase beside the act says so: "reads in his armchair"."""
        seat = next(
            (r for p, r in event.prepositions if p in ("in", "on") and r.lemma in vocabulary().seats), None
        )
        if seat is None:
            return
        shown = {shape.do for shape in self._known.entries[found[0]].stage}
        who, other = event.subject, event.object
        if found[2].patient and other is not None and other.kind == "person" and other.last <= seat.first:
            who = other  # "pushes an old man in a wheelchair"
        elif not shown <= order.BESIDE | {"stay"}:
            return
        told = {agent for act in self._acts[:-1] for agent in act.agents}
        if who is None or told & set(who.who):
            return
        sits = Event("sit", who, first=event.first, last=event.last, ongoing=True)
        sat = self._matcher.find(sits)
        if sat is not None:
            self._add(number, sits, *sat, beside=str(len(self._acts)))
            self._acts[-1] = self._acts[-1].model_copy(update={"already": True})

    def _beside(self, number: int, event: Event, found: Found) -> None:
        """Adds that two people are side by side in what they do: "they sit next to each other"."""
        start, stop = self._span(number).start, self._span(number).stop
        phrases = [
            span for span in self._prepared.phrases("together") if start <= span[0] and span[1] <= stop
        ]
        shown = {shape.do for shape in self._known.entries[found[0]].stage}
        next_to = found[2].patient and "posture" in shown and _is_next_to(event)
        if not (phrases or next_to) or shown & {"go", "place"}:
            return
        who = Ref("person", "ab") if next_to else event.subject
        beside = Event("form", who, first=event.first, last=event.last, object=_LINE)
        line = self._matcher.find(beside)
        if line is not None:
            self._add(number, beside, *line, beside=str(len(self._acts)))

    def _completed(self, number: int, event: Event) -> Iterator[Event]:
        """The event with the object that a coordinated one has: "he reads and tears up the letter"."""
        if event.object is not None or event.dative is not None:
            return
        beside = self._events[event.beside] if event.beside is not None and event.joint in _SHARING else None
        after = [other for other in self._events if other.beside == number and other.joint in _SHARING]
        for other in (beside, *after):
            if other is not None and other.object is not None and other.subject == event.subject:
                yield replace(event, object=other.object)

    def _held(self, number: int, event: Event, found: Found) -> None:
        """Adds the posture that a phrase beside an act names: "begs on his knees", "with folded arms"."""
        for i in found[2].rest:
            preposition, ref = event.prepositions[i]
            own = ref.kind == "part" and (
                ref.who == found[2].agents or (preposition == "with" and not ref.who)
            )
            if not own or (preposition == "on" and ref.family != "knee"):
                continue
            words = [word for word in event.words if word in _HELD]
            if preposition == "with" and not words:
                continue
            posture = replace(
                event, lemma="stand", object=None, dative=None, words=words, particles=[], noun=None, times=None,
                prepositions=[(preposition, ref)], side=None, direction=None, adverbs=[],
            )  # fmt: skip
            held = self._matcher.find(posture)
            if held is not None and held[0] != found[0] and not held[2].rest and held[2].score > 1.5:
                self._add(number, posture, *held, beside=str(len(self._acts)))

    def _unknown_words(self) -> None:
        """Adds the words that are none to what was not read."""
        for first, last in self._nonsense:
            start, stop = self._prepared.span(first, last)
            if not any(u.words.start <= start and stop <= u.words.stop for u in self._unread):
                self._unread.append(
                    Unread(words=Span(start=start, stop=stop), why="These words are not known.")
                )

    def _about_another(self, event: Event) -> bool:
        verbs = vocabulary().verbs
        return any(event.lemma in verbs[k] for k in verbs if k not in ("light", "sees"))

    def _span(self, number: int) -> Span:
        start, stop = self._prepared.span(*self._clauses[number])
        return Span(start=start, stop=max(stop, start))

    def _not_read(self, number: int, event: Event) -> None:
        subject = event.subject
        if subject is not None and subject.kind == "third":
            why = "This is done by a third person; only two can be shown."
        elif subject is not None and subject.kind == "thing":
            why = "This is not done by either of the two people."
        else:
            why = f"No act is known for “{event.lemma:.40}” in this form."
        self._unread.append(Unread(words=self._span(number), why=why, nearest=self._matcher.nearest(event)))

    def _add(
        self, number: int, event: Event, name: str, frame: Frame, match: Match, beside: str = ""
    ) -> None:
        number_of = str(len(self._acts) + 1)
        part = match.part
        speed = 1.0
        for adverb in event.adverbs:
            speed *= vocabulary().speeds.get(adverb, 1.0)
        usual = Go.model_fields["speed"].default
        if any(isinstance(shape, Go) and shape.speed == usual for shape in self._known.entries[name].stage):
            speed *= vocabulary().gaits.get(event.lemma, 1.0)
        refs = [event.object, part, *(ref for _, ref in event.prepositions)]  # "with the left foot"
        parts = [ref for ref in refs if ref is not None and ref.kind == "part" and ref.side]
        own = [ref.side for ref in parts if ref.who in ("", match.agents)]
        side = event.side or next((side for side in (*own, *(ref.side for ref in parts))), None)
        patient = match.patient
        if self._known.entries[name].to == "other" and len(match.agents) == 1:
            patient = patient or ("b" if match.agents == "a" else "a")
        owner = None
        if part is not None:
            owner = patient or (match.agents if len(match.agents) == 1 else None)
        act = Act(
            id=number_of, act=name, agents=tuple(match.agents),  # type: ignore[arg-type]
            patient=patient or None, thing=match.thing or None,  # type: ignore[arg-type]
            part=part.lemma if part is not None else None, part_of=owner,  # type: ignore[arg-type]
            polarity="not" if event.denied else "done", modality=event.modality,  # type: ignore[arg-type]
            already=self._goes_on(event, match.agents), seconds=event.seconds,
            side=side if side in ("left", "right", "both") else None,  # type: ignore[arg-type]
            times=event.times, manner=tuple(event.adverbs[:8]), speed=min(max(speed, 0.2), 3.0),
            direction=event.direction, distance=event.distance, words=self._span(number),
        )  # fmt: skip
        self._acts.append(act)
        if beside:
            self._held_beside[number_of] = beside
        else:
            self._of[number] = number_of

    def _goes_on(self, event: Event, agents: str) -> bool:
        """True for what somebody is doing when the text first speaks of them."""
        if event.state:
            return True
        told = {who for act in self._acts for who in act.agents}
        ongoing = event.ongoing or event.joint == "while"
        return ongoing and event.direction != "down" and not told & set(agents)

    def _waits(self, act: Act) -> bool:
        return {shape.do for shape in self._known.entries[act.act].stage} == {"stay"}

    def _last_after(self, first: str, until: str, found: Mapping[str, Sequence[Relation]]) -> str:
        """The last of the acts that follow each other from ``first`` on, before the act ``until`` in the text."""
        for act in self._acts:
            if act.id == until:
                break
            follows = any(r.kind == "after" and r.act == first for r in found[act.id])
            first = act.id if follows and not self._waits(act) else first
        return first

    def _order(self) -> None:
        """Gives the acts their relations, each to one that stands before it or above it in the syntax."""
        number_of = {name: i for i, name in self._of.items()}
        found: dict[str, list[Relation]] = {act.id: [] for act in self._acts}
        acts = {act.id: act for act in self._acts}
        for act in self._acts:
            if act.id in self._held_beside:
                found[act.id].append(Relation(kind="with", act=self._held_beside[act.id]))
                continue
            event = self._events[number_of[act.id]]
            kind, beside, seen = event.joint, event.beside, set[int]()
            while beside is not None and beside not in self._of and beside not in seen:  # passed over
                seen.add(beside)
                passed = self._events[beside]
                kind = passed.joint if kind in ("comp", "") else kind
                beside = passed.beside
            if beside is None or beside not in self._of or self._of[beside] == act.id:
                continue
            other = acts[self._of[beside]]
            told, kind = kind == "then", "after" if kind == "then" else kind
            if kind == "after" and (other.already or self._waits(other)):
                above = next((r.act for r in found[other.id] if r.kind == "while"), None)
                # What follows "A talks while B waits" follows the talk.
                other = acts[self._last_after(above, act.id, found)] if above else other
            if kind == "conj":
                kind = order.coordinated(other, act, self._known, repeats=act.id in self._answers)
            if kind == "after":
                act = acts[act.id] = order.turned_to(other, act, self._known)
            apart = not set(other.agents) & set(act.agents)
            waits = self._waits(act) and not told  # "then she waits" is said of what comes next
            if kind == "after" and apart and (other.already or act.already or waits):
                kind = "while"  # what goes on, goes on
            if kind in ("main-after", "main-until"):
                found[other.id].append(
                    Relation(kind="after" if kind == "main-after" else "until", act=act.id)
                )
            else:
                kind = kind if kind in ("after", "with", "while", "before", "until") else "with"
                found[act.id].append(Relation(kind=kind, act=other.id))  # type: ignore[arg-type]
        self._acts = [acts[act.id].model_copy(update={"order": tuple(found[act.id])}) for act in self._acts]
