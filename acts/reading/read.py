"""Sentence → plan, once: prepared, parsed, taken apart into events, and matched against the lexicon."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from acts.frames import Event, Frame, Match, Ref
from acts.lexicon import SEATS, Entry, Lexicon, is_fixture, kind_of, lexicon, nouns_in
from acts.plan import GAITS, MOST_ACTS, ON_TIPTOE, Act, Plan, Relation, Span, Unread, merged, other_of
from acts.shapes import Go, Touch
from motion import InputError

from .matching import Found, completed, formations, held, matcher, next_to, noun_acts, of_the_last, repeated, seated
from .parses import Parse, parses
from .people import A_NAME, B_NAME
from .reader import Reader
from .relations import related
from .spelling import Speller, other_language, unknown
from .syntax import spans
from .vocabulary import closed, vocabulary

MOST_CHARACTERS = 2000
"""Characters of a text that is read at once."""
_DOUBT = 0.5
"""Words that another parse may leave over more, and still be as likely."""
_CANON = "move canon"
"""The formation of those who do something one after the other."""


def read(text: str, folders: tuple[Path, ...] = ()) -> Plan:
    """The plan of an English text.

    Args:
        text: one sentence or several, at most :data:`MOST_CHARACTERS`.
        folders: further folders of acts, beside ours and those of the settings.

    Raises:
        InputError: if the text is too long, or the parser is not installed.
    """
    if len(text) > MOST_CHARACTERS:
        raise InputError(f"The text has {len(text)} characters: shorten it to {MOST_CHARACTERS}, or use several beats.")
    if not text.strip():
        return Plan(sentence=text, notes=("Nothing is said: write what the two people do.",))
    if (foreign := other_language(text)) is not None:
        return Plan(sentence=text, unread=(Unread(words=Span(start=0, stop=len(text)), why=foreign),), notes=(foreign,))
    attempts = sorted(_attempts(text, lexicon(folders)), key=lambda attempt: attempt[0])
    cost, plan = attempts[0]
    others = [other for its_cost, other in attempts[1:] if its_cost <= cost + _DOUBT]
    return plan.model_copy(update={"doubts": tuple(_doubts(plan, others))[:8]}) if others else plan


def _doubts(plan: Plan, others: Sequence[Plan]) -> Iterator[Unread]:
    """Acts that other plans of the same text, which leave as little over, have and a plan does not."""
    seen = {act.act for act in plan.acts}
    for act in (act for other in others for act in other.acts):
        if act.act not in seen and act.words is not None:
            seen.add(act.act)
            why = f"“{plan.text(act.words)[:80]}” may also mean: {act.act.replace('-', ' ')}."
            yield Unread(words=act.words, why=why, nearest=(act.act,))


def _attempts(text: str, known: Lexicon) -> Iterator[tuple[float, Plan]]:
    """Plans of several parses of a text, with the cost of what each leaves over, until one leaves nothing."""
    speller = Speller(known)
    for parsed in parses(text, speller):
        planner = _Planner(text, parsed, known, speller)
        plan = planner.plan()
        yield planner.cost + parsed.cost, plan
        if planner.cost == 0:
            return


class _Planner:
    """Turns events into acts."""

    def __init__(self, text: str, parsed: Parse, known: Lexicon, speller: Speller) -> None:
        self._text, self._prepared, self._known = text, parsed.text, known
        self._reader = reader = Reader(parsed.doc, known, parsed.lemmas, speller.forms)
        self._events = reader.read()
        self._clauses = list(spans(parsed.doc, self._events))
        self._matcher = matcher(known)
        self._acts: list[Act] = []
        self._unread: list[Unread] = []
        self._of: dict[int, str] = {}
        self._taken: set[int] = set()
        self._nonsense = list(unknown(parsed.doc, speller.knows))
        self._beside: dict[str, Relation] = {}
        """Relations of acts that stand beside a verb's own."""
        self._in_turns: set[int] = set()
        """Events of what is done in turn."""
        self._answers: set[str] = set()
        """Acts that repeat the one before."""
        self._missed = list(reader.missed())
        self.cost = float(len(self._missed) + reader.without_subject())
        """What the plan leaves over, in words."""

    def plan(self) -> Plan:
        """The plan."""
        for number, event in enumerate(self._events):
            if number in self._taken or len(self._acts) >= MOST_ACTS:
                continue
            self._event(number, event)
        self._acts = related(
            self._acts, self._events, self._of, self._beside, known=self._known, repeated=self._answers
        )
        self._left_over()
        people = self._reader.cast.people()
        things = dict.fromkeys(act.thing for act in self._acts if act.thing)
        notes = []
        if self._reader.cast.third:
            notes.append("Only two people can be shown: the others that are named do nothing.")
        said = {token.lower() for token in self._text.replace(",", " ").replace(".", " ").split()}
        notes += [note for note, words in vocabulary().limits.items() if words & said and self._acts]
        if not self._acts and not self._unread:
            self.cost += 2.0
            span = Span(start=0, stop=len(self._text))
            self._unread.append(Unread(words=span, why="There is no act in this text that can be shown."))
        return Plan(
            sentence=self._text,
            people=people,
            things=tuple(things)[:20],
            acts=tuple(self._acts[:MOST_ACTS]),
            unread=tuple(self._unread[:60]),
            notes=tuple(notes),
        )

    def _event(self, number: int, event: Event) -> None:
        inner = [i for i, other in enumerate(self._events) if other.beside == number and other.joint == "comp"]
        if self._in_turn(number, event) or self._with_hand(number, event) or self._repeated(number, event, bool(inner)):
            return
        match = self._matcher.find(event)
        if (theirs := of_the_last(event, self._acts)) is not None and (other := self._matcher.find(theirs)) is not None:
            touches = self._known.entries[other[0]].group in ("touch", "care") and other[2].patient
            definite = theirs.object is not None and theirs.object.definite  # "takes his ankle and bends the knee"
            if touches and (definite or match is None or other[2].score >= match[2].score):
                event, match = theirs, other
        if self._about_another(event) and inner and (match is None or match[2].score < 2.4):
            return
        if match is None and event.lemma == "be":
            placed = replace(event, lemma="stand", ongoing=True, state=True)
            match = self._matcher.find(placed) if event.prepositions or event.particles else None
            match = None if match is not None and (match[0] == "stand-still" or match[2].rest) else match
            event = placed if match is not None else event
        if match is None:
            for whole, cost in completed(number, event, self._events, self._acts, self._known, self._reader.cast.alone):
                self.cost += cost
                if (match := self._matcher.find(whole)) is not None:
                    event = whole
                    break
        formed = self._found(formations(event, self._formations(number)))
        vague = match is None or event.lemma in vocabulary().verbs["vague"] | vocabulary().verbs["begins"]
        rest = range(len(event.prepositions)) if match is None else match[2].rest
        nouns = noun_acts(event, self._known, rest) if vague and (match is None or not inner) else ()
        if named := self._found(other for _, other in nouns):  # "answers with a bow"
            event, match = named[0]
        elif formed and (
            vague or event.lemma in closed("shows nothing") | closed("stands") or formed[0][0].lemma == event.lemma
        ):
            (event, match), *formed = formed
            event = replace(event, said=None)
        if match is not None and not self._known.entries[match[0]].shown:
            self._unread.append(Unread(words=self._span(number), why="Bodies cannot show this."))
        elif match is not None:
            if inner and any(self._events[i].lemma in f for f in (e.words for e in match[1].elements) for i in inner):
                self._takes(number, inner)
            near = self._found(next_to(event, match, self._known))
            comes = [each for each in near if each[0].lemma == "sidle"]
            for coming, found in comes:
                self._add(number, coming, *found)
            then = Relation(kind="after", act=self._acts[-1].id) if comes else None
            self._add(number, event, *match, beside=then)
            self._companions(number, event, match, formed if comes else [*formed, *near])
        elif event.lemma not in closed("shows nothing") and not (inner and self._about_another(event)):
            self._takes(number, [i for i in inner if self._events[i].lemma in closed("shows nothing")])
            self._not_read(number, event)

    def _takes(self, number: int, inner: Sequence[int]) -> None:
        """Makes clauses below one a part of it: "guesses who it is"."""
        self._taken.update(inner)
        self._clauses[number] = (self._clauses[number][0], max(self._clauses[i][1] for i in (number, *inner)))

    def _found(self, events: Iterable[Event]) -> list[tuple[Event, Found]]:
        """The events that mean an act, with it."""
        each = ((event, self._matcher.find(event)) for event in events)
        return [(event, match) for event, match in each if match is not None]

    def _companions(self, number: int, event: Event, match: Found, formed: Sequence[tuple[Event, Found]]) -> None:
        """Adds the acts that the words beside a verb name."""
        of = str(len(self._acts))
        at_once = Relation(kind="with", act=of)
        told = {agent for act in self._acts[:-1] for agent in act.agents}
        both = len(match[2].agents) == 2
        entry = self._known.entries[match[0]]
        shown = {shape.do for shape in entry.stage}
        if both and not entry.mutual and any(isinstance(s, Touch) and s.times and not s.fells for s in entry.stage):
            self._one_after_the_other(to_each=True)  # "they pat each other": of a touch there is one at a time
        for other, formation in formed:
            placed = shown & {"go", "place"} and formation[0].startswith("form-line")
            placed = placed or (other.distance is not None and not event.denied)  # "they dance two metres apart"
            if formation[0] == "canon" and both and not entry.mutual:
                self._one_after_the_other()
            elif formation[0] != match[0] and not placed:
                self._add(number, other, *formation, beside=at_once)
        for other, posture in held(event, match, self._known, self._matcher.find):
            self._add(number, other, *posture, beside=at_once)
        if (sits := seated(event, match, self._known, told)) is not None:
            for other, sat in self._found([sits]):
                self._add(number, other, *sat, beside=at_once)
        for preposition, noun in noun_acts(event, self._known, match[2].rest):
            kind = "after" if preposition == "into" else "with"
            for other, done in self._found([noun])[: self._acts[-1].id == of]:
                self._add(number, other, *done, beside=Relation(kind=kind, act=of))  # type: ignore[arg-type]

    def _one_after_the_other(self, *, to_each: bool = False) -> None:
        """Has the last act of both done by one after the other, or by each to the other."""
        last = self._acts.pop()
        for who, other in ("ab", "ba"):
            whom = {"patient": other, "part_of": other if last.part else None} if to_each else {}
            own = str(len(self._acts) + 1)
            self._acts.append(last.model_copy(update={"agents": (who,), "id": own, **whom}))
        self._beside[own] = Relation(kind="after", act=last.id)

    def _in_turn(self, number: int, event: Event) -> bool:
        """Passes "take turns", which is parsed as "keep", on to what is done in turn; False for other verbs."""
        turns = event.lemma == "keep" and _CANON in self._formations(number)
        done = {i for i, other in enumerate(self._events) if other.beside == number and turns}
        self._in_turns |= done
        return bool(done)

    def _with_hand(self, number: int, event: Event) -> bool:
        """Passes the hand of "uses the left hand to throw" on to what is done with it; False for other verbs."""
        hand = event.object
        done = [i for i, other in enumerate(self._events) if other.beside == number and other.joint != "after"]
        if event.lemma != "use" or hand is None or hand.kind != "part" or not done:
            return False
        for i in done:
            self._events[i].prepositions.append(("with", replace(hand, who="")))
            self._clauses[i] = (self._clauses[number][0], self._clauses[i][1])
        return True

    def _formations(self, number: int) -> dict[str, Span | None]:
        """The ways to move together that the clause of an event names, and where."""
        span, event = self._span(number), self._events[number]
        named: dict[str, Span | None] = dict(self._prepared.formations(span.start, span.stop))
        named |= {_CANON: None} if number in self._in_turns else {}
        crowds = ((word, ref) for word, ref in event.prepositions if ref.lemma in closed("crowd"))
        for word, crowd in crowds if event.subject is not None and len(event.subject.who) == 2 else ():
            start, stop = self._prepared.span(crowd.first, crowd.last)  # the two turn to it side by side
            named |= {"form line": Span(start=max(self._text.lower().rfind(word, 0, start), 0), stop=stop)}
        return named

    def _repeated(self, number: int, event: Event, has_inner: bool) -> bool:
        """Adds the last act once more where the words say so."""
        last = next(reversed(self._acts), None)
        told = None if last is None else repeated(event, last, has_inner, self._known)
        if last is None or told is None:
            return False
        own = str(len(self._acts) + 1)
        self._acts.append(last.model_copy(update={**told, "id": own, "words": self._span(number)}))
        self._of[number] = own
        self._answers.add(own)
        return True

    def _left_over(self) -> None:
        """Adds the words that no dictionary has, and those that no act has taken up, to what was not read."""
        unknown = {first for first, _ in self._nonsense}
        missed = [t for t in self._missed if t.text not in (A_NAME, B_NAME)]
        left = [(t.idx, t.idx + len(t)) for t in missed if t.idx + len(t) + 1 not in unknown]
        reasons = [(each, "These words are not known.") for each in self._nonsense]
        reasons += [(each, "These words belong to no act.") for each in merged(left, self._prepared.parsed)]
        for (first, last), why in reasons:
            start, stop = self._prepared.span(first, last)
            if stop > start and not any(u.words.start < stop and start < u.words.stop for u in self._unread):
                self._unread.append(Unread(words=Span(start=start, stop=stop), why=why))

    def _about_another(self, event: Event) -> bool:
        verbs = vocabulary().verbs
        return any(event.lemma in verbs[k] for k in verbs if k not in ("light", "sees", "seems", "nouns", "held"))

    def _span(self, number: int) -> Span:
        start, stop = self._prepared.span(*self._clauses[number])
        return Span(start=start, stop=max(stop, start))

    def _not_read(self, number: int, event: Event) -> None:
        self.cost += 2.0
        subject = event.subject
        if subject is not None and subject.kind == "third":
            why = "This is done by a third person; only two can be shown."
        elif subject is not None and subject.kind == "thing":
            why = "This is not done by either of the two people."
        else:
            why = f"No act is known for “{event.lemma:.40}” in this form."
        self._unread.append(Unread(words=self._span(number), why=why, nearest=self._matcher.nearest(event)))

    def _add(
        self, number: int, event: Event, name: str, frame: Frame, match: Match, beside: Relation | None = None
    ) -> None:
        if self._reader.cast.alone and (other := self._known.entries[name].alone) in self._known.entries:
            name = other
        entry, words = self._known.entries[name], event.said or self._span(number)
        if beside is None and (begun := self._includes(entry, match.agents)) is not None:
            words = Span(start=begun.start, stop=words.stop)
        number_of = str(len(self._acts) + 1)
        self.cost += 0.5 * match.left
        part = match.part
        speed = 1.0
        for adverb in event.adverbs:
            speed *= vocabulary().speeds.get(adverb, 1.0)
        usual = Go.model_fields["speed"].default
        goes = [shape for shape in entry.stage if isinstance(shape, Go)]
        if any(shape.speed == usual for shape in goes):
            speed *= vocabulary().gaits.get(event.lemma, 1.0)
        toes = any(word == "on" and ref.lemma in closed("on tiptoe") for word, ref in event.prepositions)
        toes = toes or (event.lemma in closed("on tiptoe") and not any(shape.gait for shape in goes))
        captions = " ".join(entry.caption)
        gaits = [gait for gait, verb in GAITS.items() if goes and event.lemma in closed(gait) and verb not in captions]
        patient = match.patient
        floored = any(ref.lemma in closed("floors") for word, ref in event.prepositions if word != "from")
        upwards = entry.thing == "throws" and (event.direction == "up" or floored)  # to nobody
        shared = entry.mutual and event.modality == "offered"
        if (entry.to == "other" or shared) and len(match.agents) == 1 and not upwards:
            patient = patient or other_of(match.agents)
        given = event.object is None or entry.thing == "throws"
        last = next(reversed(self._acts), None)
        same = last is not None and (last.act, last.direction) == (name, None) and last.agents != tuple(match.agents)
        apart = event.distance is not None and "apart" in event.words
        answers = (
            event.direction == "back" and (patient or same) and given and not goes
        )  # "throws it back", "bows back"
        if answers and same:
            self._answers.add(number_of)
        owner = None
        if part is not None:
            whose = match.agents if frame.of_agent() else patient or match.agents
            owner = whose if len(whose) == 1 else None
        part_side = _side_of_other(part, frame, match, patient, owner)
        by = (r for word, r in event.prepositions if word not in closed("laid") or r.family in ("foot", "leg", "knee"))
        refs = [event.object, part, *by]  # "with the left foot", but not "with a purse on the left arm"
        parts = [ref for ref in refs if ref is not None and ref.kind == "part" and ref.side]
        own = [ref.side for ref in parts if ref.who in ("", match.agents) and not (part_side and ref is part)]
        by_part = event.object is not None and event.object.kind == "part" and event.object is not part
        both = () if by_part else (ref.side for ref in parts if ref.side == "both")  # not "an arm around his shoulders"
        side = next(filter(None, (event.side, *own, *both)), None)
        if own and event.direction in ("left", "right"):
            side = own[0]  # "to the left with the right foot"
        act = Act(
            id=number_of,
            act=name,
            agents=tuple(match.agents),  # type: ignore[arg-type]
            patient=patient or None,  # type: ignore[arg-type]
            thing=match.thing or self._named(event, name, self._text[words.start : words.stop]),
            part=part.lemma if part is not None else None,
            part_of=owner,  # type: ignore[arg-type]
            part_side=part_side,  # type: ignore[arg-type]
            polarity="not" if event.denied else "done",
            modality=event.modality,  # type: ignore[arg-type]
            already=self._goes_on(event, match.agents, entry) and not entry.moment,
            seconds=event.seconds,
            side=side if side in ("left", "right", "both") else None,
            times=None if event.distance and (toes or not name.startswith("step")) else event.times,
            manner=(*([ON_TIPTOE] if goes and toes else ()), *gaits, *event.adverbs[:7]),
            speed=min(max(speed, 0.2), 3.0),
            direction="down" if entry.thing == "throws" and floored else None if answers or apart else event.direction,
            distance=event.distance,
            words=words,
        )
        self._acts.append(act)
        if beside is not None:
            self._beside[number_of] = beside
        else:
            self._of[number] = number_of

    def _includes(self, entry: Entry, agents: str) -> Span | None:
        """Takes out the act before with which an act's captions begin, as "bends down and picks up"; its words."""
        last = next(reversed(self._acts), None)
        if last is None or last.agents != tuple(agents) or not last.happens or last.seconds or last.times:
            return None
        own = self._known.entries[last.act].caption[0]
        if last.already or not any(text.startswith((f"{own} and [", f"{own} to ")) for text in entry.caption):
            return None
        self._acts.pop()
        self._of = {number: name for number, name in self._of.items() if name != last.id}
        return last.words

    def _named(self, event: Event, name: str, text: str) -> str | None:
        """The thing of an act whose frame has its noun as a word, a seat, or the window before which one is done."""
        ref = event.object
        if self._known.entries[name].thing == "sits":
            before = "".join(act.thing or "" for act in self._acts[-1:])  # "walks to the bench and sits down"
            found = nouns_in(f"{text} {before}")
            return next((noun for kinds in (SEATS, ("table",)) for noun, kind in found if kind in kinds), None)
        if ref is not None and ref.kind == "thing" and self._known.entries[name].thing and kind_of(ref.lemma):
            return ref.lemma
        goals = (ref for word, ref in event.prepositions if word in closed("before goals") and ref.kind == "thing")
        goes = any(isinstance(shape, Go) for shape in self._known.entries[name].stage)
        return next((ref.lemma for ref in goals if is_fixture(ref.lemma) or (goes and kind_of(ref.lemma))), None)

    def _goes_on(self, event: Event, agents: str, entry: Entry) -> bool:
        """True for what somebody is doing when the text first speaks of them, or how they sit while they do that."""
        if event.state:
            return True
        told = {act.id for act in self._acts if set(act.agents) & set(agents)}
        if event.joint == "while" and event.beside is not None and entry.takes_down():
            told.discard(self._of.get(event.beside, ""))  # "pats him while both are sitting"
        ongoing = event.ongoing or (event.joint == "while" and event.direction != "down")
        return ongoing and not told


def _side_of_other(part: Ref | None, frame: Frame, match: Match, patient: str, owner: str | None) -> str | None:
    """The side of the other's part that an act is about, "left" or "right": "B's left shoulder"."""
    if part is None or part.side not in ("left", "right") or frame.of_agent():
        return None
    return part.side if (part.who == "each" if len(match.agents) == 2 else owner == patient) else None
