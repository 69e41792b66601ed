"""What nouns and pronouns stand for, and the subject of each clause: its own, an earlier one's, or who is spoken to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from acts.frames import Event, Ref, best
from acts.lexicon import Lexicon, is_fixture
from acts.plan import other_of

from .people import A_NAME, ANYONE, B_NAME, PRONOUN_SEX, Cast, begins_clause
from .syntax import ClauseTree, has, is_finite
from .vocabulary import closed, vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Doc, Token

_SUBJECTS = frozenset(("nsubj", "nsubjpass", "csubj", "expl"))
_SOMEBODY = ANYONE | {"someone", "somebody"}
_PLAIN = _SOMEBODY | {"man", "woman", "guy", "boy", "girl", "human", "kid", "child", "dude", "figure", "sim"}
"""Nouns that name nobody's part in a scene, as "nurse" does, who has a patient."""


def names_one(doc: Doc) -> bool:
    """True for a parsed text that names a single person, whose every part of a body and pronoun are."""
    words_of = vocabulary()
    nouns = [t for t in doc if t.pos_ not in ("VERB", "ADV", "ADJ") and t.dep_ != "amod"]
    nouns = [t for t in nouns if t.lower_ in _SOMEBODY or words_of.is_usual_person(t.lemma_.lower())]
    words = {t.lower_ for t in doc if not (_is_of_thing(t) or (t.lower_ == "second" and t.dep_ == "pobj"))}
    if not nouns:
        told = next((t for t in doc if t.pos_ in ("VERB", "NOUN")), None)  # "walks forward and sits"
        if told is None:
            return False
        part = told.dep_ == "nsubj" and bool(words_of.part(told.lemma_.lower()))
        acts = told.tag_ == "VBZ" or (told.tag_ == "NNS" and told.i == 0)
        own = any(words_of.part(t.lemma_.lower()) for t in doc) and told.lemma_ not in closed("each other's")
        goes = own or told.lemma_ in words_of.verbs["goes"] - {"dance"}
        acts = acts or (told.tag_ == "VBG" and goes)
        others = closed("company") | closed("they") | words_of.both | PRONOUN_SEX.keys() | {"together", "one"}
        return (part or acts) and words.isdisjoint(others - {"his"}) and all(t.pos_ != "PROPN" for t in doc)
    if any(t.lower_ == "one" and words_of.part(t.nbor().lemma_) for t in doc[:-1]):
        words -= {"other"}  # "one foot in front of the other"
    new = sum(any(c.lower_ in ("a", "an") for c in t.children) for t in nouns)
    plain = all(t.lemma_.lower() in _PLAIN for t in nouns)
    objects = (t for t in doc if t.lower_ in ("him", "her", "them") and t.dep_ != "poss")
    plain = plain and all(
        t.head.lower_ in closed("around oneself") or (t.lower_ == "them" and t.dep_ != "pobj") for t in objects
    )
    same = plain and len({t.lemma_.lower() for t in nouns}) == 1 and new < 2 and all(t.tag_ == "NN" for t in nouns)
    sexes = {PRONOUN_SEX[word] for word in words & PRONOUN_SEX.keys()}
    sexes |= {words_of.sex(t.lemma_.lower()) for t in nouns} - {""}
    named = any(t.text in (A_NAME, B_NAME) for t in doc) or bool(words & closed("company"))
    return same and len(sexes) < 2 and not named


def _is_of_thing(token: Token) -> bool:
    """True for a word of company that says of a thing which one it is: "another ball", "the other hand"."""
    noun, words = token.head.lemma_.lower(), vocabulary()
    counted = token.lower_ == "another" and has(token.head, "nummod")
    if token.dep_ in ("poss", "ROOT") or (token.head.tag_ != "NN" and not counted):  # "the other hands him a cup"
        return False
    if token.lower_ == "another":
        return not words.is_person(noun)
    return token.lower_ in closed("ordinals") and bool(words.part(noun) or noun in closed("countable"))


def reference(token: Token, cast: Cast, subject: str) -> Ref:
    """The reference of a noun or pronoun; see :class:`acts.frames.Ref`."""
    first, last = token.idx, token.idx + len(token.text)
    lemma = token.lemma_.lower()
    children = {child.lower_ for child in token.children}
    if token.lower_.endswith(("self", "selves")):
        return Ref("self", subject, lemma, first=first, last=last)
    if token.lower_ in ("other", "another") and children & {"each", "one"}:
        return Ref("each", "ab", "other", first=first, last=last)
    behind = cast.alone and token.dep_ == "pobj"  # "holds them in front of them"
    many = cast.things  # "drops her keys, and he picks them up", "opens her arms, and he runs into them"
    meant = many is not None and (many.kind == "thing" or cast.alone or token.head.lower_ == "into")
    if token.lower_ == "them" and many is not None and meant and len(subject) == 1 and not behind:
        return replace(many, first=first, last=last)
    if token.lower_ == "it" and cast.thing is not None and not cast.person(token):
        said_of = cast.thing_of if cast.thing_of != subject and len(cast.thing_of) == 1 else ""
        hers = bool(cast.thing_sex) and cast.thing_sex == cast.sex(subject)  # "kisses her hand; she withdraws it"
        owner = cast.thing.who or (said_of if cast.thing.kind == "part" and not hers else "")
        return replace(cast.thing, who=owner, first=first, last=last)  # "extends a hand, and she shakes it"
    if token.dep_ in ("dobj", "pobj") and token.lower_ in ("that", "which") and token.head.dep_ == "relcl":
        return replace(reference(token.head.head, cast, subject), first=first, last=last)  # "the cup that she holds"
    ref = _reference(token, cast, subject)
    cast.seen[token.i] = ref
    if ref.kind == "person":
        cast.note_states(token, ref.who)
        of = (c for c in token.children if c.lower_ == "of")  # "one of the kids"
        cast.seen |= {c.i: ref for each in of for c in each.children if vocabulary().is_person(c.lemma_.lower())}
    _note_thing(token, ref, cast, subject)
    return ref


def _is_aside(token: Token, cast: Cast) -> bool:
    """True for the noun of a preposition whose verb does something with a thing: "throws the ball in the air"."""
    verb = token.head.head if token.dep_ == "pobj" else token
    objects = (child for child in verb.children if child.dep_ in ("dobj", "obj"))
    thing = cast.thing
    if thing is None or thing.kind != "thing":
        return False
    return any(each.lemma_.lower() in ("it", thing.lemma) for each in objects)


def _note_thing(token: Token, ref: Ref, cast: Cast, subject: str) -> None:
    """Notes what "it" and "them" mean from here on."""
    light = token.head.lemma_.lower() in vocabulary().verbs["light"]  # "does two jumps"
    many = ref.kind == "thing" or (ref.kind == "part" and (cast.alone or token.head.lemma_ in closed("opens")))
    taken = token.dep_ == "dobj" or (ref.kind == "part" and token.head.lower_ in ("with", "of"))
    if many and token.tag_ == "NNS" and taken and (ref.kind == "part" or not light):
        cast.things = ref
    beside = token.dep_ == "pobj" and cast.thing is not None and (ref.kind, cast.thing.kind) == ("part", "thing")
    lifted = cast.alone and cast.thing is not None and cast.thing.family in closed("limbs")
    if lifted and ref.kind == "part" and (ref.family not in closed("limbs") or token.head.lower_ in ("at", "from")):
        return  # "raises a hand, rubs his head and lowers it", "bends an arm at the elbow and lowers it"
    if beside or _is_aside(token, cast):  # "throws the ball over her shoulder, and he catches it"
        return
    if ref.lemma in closed("manners"):
        return
    goal = ref.kind == "thing" and cast.thing is None and is_fixture(ref.lemma)  # "at the door, and opens it"
    if ref.kind in ("part", "thing") and token.tag_ in ("NN", "NNP") and (goal or not ref.place):
        cast.thing, cast.thing_of = ref, subject
        cast.thing_sex = next((sex for c in token.children if (sex := PRONOUN_SEX.get(c.lower_))), "")


def _reference(token: Token, cast: Cast, subject: str) -> Ref:
    words = vocabulary()
    first, last = token.idx, token.idx + len(token.text)
    lemma = token.lemma_.lower()
    family = words.part(lemma)
    if family and not (token.ent_type_ or token.pos_ == "PROPN"):
        owner = cast.owner(token, subject)
        side = next((child.lower_ for child in token.children if child.lower_ in ("left", "right", "both")), "")
        many = token.tag_ == "NNS" and all(c.lower_ not in ("a", "an") for c in token.children)  # not "a thumbs up"
        if not side and many and family in ("hand", "arm", "foot", "leg", "knee", "shoulder"):
            side = "both"
        lemma = "back" if lemma == "spine" else lemma
        bare = all(c.dep_ != "poss" and c.tag_ != "PRP$" and c.lower_ != "of" for c in token.children)
        definite = any(c.lower_ == "the" for c in token.children)
        return Ref("part", owner, lemma, family, side, bare=bare, definite=definite, first=first, last=last)
    thirds = len(cast.third)
    who = cast.person(token, subject)
    if who:
        conjuncts = [c for c in token.conjuncts if c.i > token.i and c.dep_ == "conj" and not begins_clause(c)]
        if len(who) == 1 and any(cast.person(c, who) not in (None, who) for c in conjuncts):
            both = Ref("person", "ab", lemma, first=first, last=last)
            cast.seen |= {c.i: both for c in conjuncts}
            return both
        return Ref("person", who, lemma, first=first, last=last)
    if len(cast.third) > thirds:
        return Ref("third", "", lemma, first=first, last=last)
    owner = cast.owner(token, subject) if has(token, "poss") else ""
    owner = "ab" if owner == "each" else owner
    bare = token.tag_ == "NN" and not has(token, "det", "poss", "nummod", "predet")
    return Ref("thing", owner, lemma, place=lemma in words.places, bare=bare, first=first, last=last)


# ---- subjects --------------------------------------------------------------------------------------------
_OPENS = frozenset((".", ";", ":", "!", "?", ",", "and", "then"))
"""What stands before a clause."""


def ends_before(noun: Token, verb: Token) -> bool:
    """True for a noun that the parser joined to what stands before, and whose phrase ends where a verb begins."""
    joined = noun.dep_ == "conj" and noun.tag_ == "NN" and noun.right_edge.i == verb.i - 1
    own = has(verb, "nsubj", "nsubjpass")
    return joined and not own and has(noun, "det")


class Subjects:
    """The subjects of a text's clauses, each found once.

    Args:
        tree: the text's clauses.
        cast: the people named so far.
        event_of: gives the event that was read from a clause's verb, or None before its turn.
    """

    def __init__(self, tree: ClauseTree, cast: Cast, event_of: Callable[[Token], Event | None]) -> None:
        self._tree = tree
        self._cast = cast
        self._event_of = event_of
        self._words = vocabulary()
        self._found: dict[int, Ref | None] = {}

    def found(self, token: Token | None) -> Ref | None:
        """The subject of a clause whose turn has been, or None."""
        return self._found.get(token.i) if token is not None else None

    def of(self, token: Token, head: Token | None) -> Ref | None:
        """The subject of a clause, found once, and before its turn where an earlier clause has the same."""
        waiting = [(token, head)]
        while (above := waiting[-1][1]) is not None and above.i not in self._found:
            if len(waiting) > len(self._tree.doc) or any(
                c.dep_ in ("nsubj", "nsubjpass") for c in waiting[-1][0].children
            ):
                break
            waiting.append((above, self._tree.head(above)))
        for clause, its_head in reversed(waiting):  # from above, so that none calls another in turn
            if clause.i not in self._found:
                self._found[clause.i] = self._subject_of(clause, its_head)
        return self._found[token.i]

    def _subject_of(self, token: Token, head: Token | None) -> Ref | None:
        if (told := self._told(token, head) or self._called(token) or self._named_before(token)) is not None:
            return told
        if token.dep_ in ("relcl", "acl", "amod") and token.head != head:
            return self._antecedent(token)
        if head is not None:
            own = self.of(head, self._tree.head(head))
            kept = token.dep_ == "pcomp" and token.head.lower_ == "from"  # "stops him from falling"
            if kept or token.dep_ in ("xcomp", "ccomp"):  # "makes her laugh", "asks him to sit"
                above = self._event_of(head)
                shown = any(child.lower_ == "how" for child in token.children)  # "teaches him how to bow"
                if (
                    above is not None
                    and above.object is not None
                    and above.object.kind == "person"
                    and above.lemma not in closed("promises")
                    and not shown
                ):
                    return above.object
            return own
        main = self._tree.main_before(token)
        if main is not None and main < token.i:  # "creeps up, covers her eyes", where the second became the main one
            return self._found.get(main)
        if token.dep_ == "ROOT" or head is None:
            # "grab her by the wrist" is said to one
            one = token.tag_ == "VBZ" and {"each", "together", "both"}.isdisjoint(t.lower_ for t in token.sent)
            alone = (
                self._cast.alone
                or one
                or any(t.lower_ in closed("somebody") or self._is_someone(t) for t in token.subtree)
            )
            if alone:
                self._cast.address()
            return Ref("person", "a" if alone else "ab", "", first=token.idx, last=token.idx)
        return None

    def _called(self, token: Token) -> Ref | None:
        """The person to whom a clause is said that begins with their name: "A, run at B"."""
        if token.i < 2 or token.nbor(-1).text != "," or token.tag_ not in ("VB", "VBP"):
            return None
        name = token.nbor(-2)
        before = name.nbor(-1).lower_ if name.i else "."
        if before not in _OPENS or not (name.text in (A_NAME, B_NAME) or self._words.is_person(name.lower_)):
            return None
        return reference(name, self._cast, "")

    def _told(self, token: Token, head: Token | None) -> Ref | None:
        """The subject that stands beside a verb."""
        before = token.nbor(-1) if token.i > 1 else token
        which = before.nbor(-1) if before.lower_ == "one" and before.i > 0 else before  # "the other one counts"
        # "the other ducks" may be birds to the parser
        if which.i and which.lower_ in closed("ordinals") and which.nbor(-1).lower_ == "the" and is_finite(token):
            self._cast.seen[before.i] = other = reference(which, self._cast, "")
            return other
        helper = self._found.get(head.i) if head is not None and token.dep_ in ("ccomp", "xcomp") else None
        # "he comes running"
        moving = (c for aux in token.children if aux.dep_ == "aux" for c in aux.children)
        for child in (*token.children, *moving):
            if child.dep_ in _SUBJECTS or (child.dep_ == "nummod" and child.lower_ == "one"):  # "one jumps"
                if child.tag_ in ("WP", "WDT") and (token.dep_ == "relcl" or child.lower_ == "who"):
                    return self._antecedent(token) if token.dep_ == "relcl" else None
                if child.tag_ in ("VBZ", "VBD") and (known := self._found.get(child.i)) is not None:
                    return known  # "she leans back, then kicks"
                # "helps him get up"
                whose = helper.who if helper is not None and child.lower_ in closed("somebody") else ""
                ref = self._cast.seen.get(child.i) or reference(child, self._cast, whose)
                if child.lower_ in ("nobody", "neither", "none") or (
                    child.lower_ == "one" and "no" in {c.lower_ for c in child.children}
                ):
                    return Ref("person", "ab", child.lower_, first=ref.first, last=ref.last)
                return ref
            if child.dep_ == "poss" and token.dep_ == "ccomp" and head is not None:  # "helps her walk"
                return reference(child, self._cast, helper.who if helper is not None else "")
            if child.dep_ in ("det", "preconj") and child.lower_ in closed("of all"):  # "…, both freeze"
                return Ref("person", "ab", child.lower_, first=child.idx, last=child.idx + len(child.text))
        return None

    def _is_someone(self, noun: Token) -> bool:
        """True for one person to whom something is done, but not for "your partner", whom both have."""
        lemma = noun.lemma_.lower()
        if lemma == "other" and any(c.lower_ == "the" for c in noun.children):
            return True
        done_to = noun.dep_ in ("dobj", "dative", "poss") and noun.tag_ == "NN" and lemma != "partner"
        return done_to and self._words.is_person(lemma)

    def _named_before(self, token: Token) -> Ref | None:
        """The person named right before a verb whom the parser took for a part of it, or for another's object.

        As in "while Beth crouches", "he runs to Beth and Beth lifts him", "he hugs Beth and she waves" and "he holds
        out his hand and the girl shakes it".
        """
        before = token.nbor(-1) if token.i and token.tag_ in ("VBZ", "VBD") else None
        if before is None:
            return None
        if not begins_clause(before) and (before.tag_ != "NNP" or before.dep_ not in ("conj", "compound")):
            before = next((noun for noun in (before, *before.ancestors) if ends_before(noun, token)), None)
        ref = reference(before, self._cast, "") if before is not None else None
        return ref if ref is not None and ref.kind == "person" else None

    def _antecedent(self, token: Token) -> Ref | None:
        noun = token.head
        if (known := self._cast.seen.get(noun.i)) is not None:
            return known
        if noun.pos_ not in ("NOUN", "PROPN", "PRON", "ADJ", "NUM"):
            return None
        ref = reference(noun, self._cast, "")
        return ref if ref.kind == "person" or noun.pos_ in ("NOUN", "PROPN") else None


# ---- voice ---------------------------------------------------------------------------------------------
def other_person(ref: Ref) -> Ref | None:
    """The other of the two; None for both and for what is no person."""
    other = other_of(ref.who)
    return Ref("person", other) if ref.kind == "person" and other else None


def is_passive(token: Token) -> bool:
    """True for a passive of its own: "is pushed", "pushed by her"."""
    return token.tag_ == "VBN" and has(token, "nsubjpass", "auxpass", "agent")


def goes_on(token: Token) -> bool:
    """True for a participle that shares the auxiliary of a passive before it: "is pushed and kicked"."""
    if token.dep_ != "conj" or has(token, "nsubj", "auxpass", "aux"):
        return False
    being = next((child for child in token.head.children if child.dep_ == "auxpass"), None)
    present = being is not None and being.tag_ in ("VBZ", "VBP")
    return being is not None and (token.tag_ == "VBN" or (present and token.tag_ == "VBD"))


def state_of(token: Token, event: Event, known: Lexicon) -> Event | None:
    """A passive that only says how somebody is, as an event of "be": "they are seated"; None for other verbs."""
    if not is_passive(token) or has(token, "agent"):
        return None
    state = replace(event, lemma="be", words=[*event.words, token.lower_], ongoing=True)
    match = best(known.frames, state)
    named = match is not None and any(token.lower_ in element.words for element in match[1].elements)
    return state if named else None


def give_roles(token: Token, event: Event, agent: Ref | None) -> None:
    """Makes the subject of a passive the one to whom it is done, and the agent, said or not, its subject."""
    subject = event.subject
    agent = agent or (other_person(subject) if subject is not None else None)
    if agent is None and subject is not None and subject.kind in ("thing", "part"):  # "is held out to her"
        of = [*(ref for _, ref in event.prepositions if ref.kind == "person"), Ref("person", subject.who)]
        agent = other_person(of[0])
    if event.object is not None and event.dative is None:  # "she is given a book"
        event.dative, event.subject = subject, agent
    else:
        event.object, event.subject = subject, agent
