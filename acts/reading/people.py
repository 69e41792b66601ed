"""People: the nouns and pronouns of a whole text as person a, person b or both."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from acts.frames import Ref
from acts.plan import Person, other_of

from . import wordnet
from .syntax import is_likeness
from .vocabulary import Vocabulary, closed, vocabulary

if TYPE_CHECKING:
    from spacy.tokens import Token

A_NAME, B_NAME = "Adam", "Beth"
"""Names that stand for "A" and "B" while a text is parsed: the parser takes letters for articles and nouns."""

_FIRST, _SECOND = frozenset(("first", "former")), frozenset(("second", "latter"))
PRONOUN_SEX = dict.fromkeys(("he", "him", "his", "himself"), "m") | dict.fromkeys(
    ("she", "her", "hers", "herself"), "f"
)
"""The sex that a pronoun tells."""
ANYONE = frozenset(("someone", "somebody", "anyone", "anybody", "person"))
_OTHERS = frozenset(("conj", "poss", "appos"))
"""What hangs on a noun and is somebody else: "a man and a girl", "the child's mother"."""


@dataclass
class _Known:
    words: list[str] = field(default_factory=list)
    sex: str = ""
    age: str = ""


class Cast:
    """The two people of a text, as far as it has been read."""

    def __init__(self) -> None:
        self._words: Vocabulary = vocabulary()
        self._known: dict[str, _Known] = {}
        self._pair = _Known()
        """What words for both say about each: "two men"."""
        self.last = ""
        self.focus = ""
        """The subject of what the two did together, of whom a pronoun goes on: "A hugs B. He waves."."""
        self.thing: Ref | None = None
        """The part or thing that was named last, which "it" means."""
        self.things: Ref | None = None
        """The things that were named last, which "them" means."""
        self.thing_sex = ""
        """The sex of its owner, by a possessive."""
        self.thing_of = ""
        """The people of the clause that named it."""
        self.alone = False
        """The text names one person and nobody else, whose every part of a body and pronoun are."""
        self.seen: dict[int, Ref] = {}
        """What the tokens mean that were looked at."""
        self.states: dict[int, tuple[str, str]] = {}
        """What somebody does by a phrase that hangs on their noun: (verb, who), by the phrase's preposition."""
        self.third: list[Token] = []
        """Mentions of a person who is neither of the two, or of more than two."""

    def people(self) -> tuple[Person, Person]:
        """The two as a plan has them."""
        a, b = (self._person(who) for who in "ab")
        return a, b

    def _person(self, who: str) -> Person:
        known, pair = self._known.get(who, _Known()), self._pair
        words = tuple(dict.fromkeys(known.words))[:8]
        return Person(id=who, words=words, sex=known.sex or pair.sex, age=known.age or pair.age)  # type: ignore[arg-type]

    def person(self, token: Token, subject: str = "") -> str | None:
        """The people whom a noun or pronoun means: "a", "b" or "ab"; None if it means no person.

        Args:
            token: the head of the noun phrase.
            subject: the people of the clause's subject, whom its other arguments do not mean.
        """
        lemma, text = token.lemma_.lower(), token.lower_
        children = {child.lower_ for child in token.children}
        if self.alone and (text in PRONOUN_SEX or text in closed("they")):
            return self._as("a", text)
        if text in PRONOUN_SEX:
            return self._pronoun(PRONOUN_SEX[text], subject, _meets_other(token))
        if text in ("i", "me", "my", "myself", "you", "your", "yourself"):
            return self._named("i" if text in ("i", "me", "my", "myself") else "you")
        if text in closed("they"):
            return self._other(subject) if len(subject) == 1 and text in ("them", "us") else "ab"
        figure = (
            self.alone and token.dep_ == "nsubj" and bool(closed("neuter") & set(self._known.get("a", _Known()).words))
        )
        if text == "it" or is_likeness(token):
            return "a" if text == "it" and figure else None
        if text in closed("nobody") or (text == "one" and "no" in children):
            return "ab"
        if text == "other" and self.alone:
            return None  # "crosses one foot over the other"
        if text == "other" or ("other" in children and (text == "one" or self._words.is_person(lemma))):
            return self._other(subject, lemma) if children.isdisjoint(("each", "one")) else "ab"
        if text in ("both", "each", "everyone", "everybody", "all") or lemma in self._words.both:
            return self._many(token, children)
        numbered = text == "one" or self._words.is_person(lemma) or self._has(lemma)  # and not "the first step"
        if text in _FIRST or (numbered and children & _FIRST):
            return self._as("a", lemma)
        if text in _SECOND or (numbered and children & _SECOND):
            return self._as("b", lemma)
        if text == "one":
            return self._as("a" if "a" not in self._known or self.last != "a" else "b", "one")
        if text in ("another", "else", "someone", "somebody"):
            return self._new(lemma, token)
        if text in (A_NAME.lower(), B_NAME.lower()) and token.text in (A_NAME, B_NAME):
            return self._as("a" if token.text == A_NAME else "b", "person")
        acts = token.dep_ in ("nsubj", "nsubjpass", "poss")
        # "her teddy bear"
        small = token.text.islower() and not self._words.is_usual_person(lemma) and not acts
        if token.tag_ == "NNP" and token.pos_ == "PROPN" and lemma not in closed("capitals") and not small:
            return self._named(text)
        if not self._is_somebody(token, lemma, children):
            return None
        if self._is_plural(token, lemma) or children & {"two", "both"}:
            return self._many(token, children)
        who = self._noun(token, lemma, children, subject)
        if who in self._known:
            self._describe(token, self._known[who])
        return who

    def _noun(self, token: Token, lemma: str, children: set[str], subject: str) -> str | None:
        if "one" in children:
            return self._as("a" if "a" not in self._known or self.last == "b" else "b", lemma)
        if children & {"another", "third"} or (children & {"a", "an"} and self._has(lemma)):
            return self._new(lemma, token)
        if "other" in children:
            return self._other(subject)
        own = self._has(lemma)
        if own and not (own == subject and len(subject) == 1):
            return self._as(own, lemma)
        return self._new(lemma, token)

    def _is_somebody(self, token: Token, lemma: str, children: set[str]) -> bool:
        """True for a noun that names a person, by itself or by what it does here."""
        if token.pos_ in ("ADV", "VERB", "ADP"):
            return False
        acts = token.dep_ in ("nsubj", "nsubjpass") and bool(children & closed("articles"))
        known = self._words.is_person(lemma) or bool(self._has(lemma)) or self._is_many(token)
        return known or _is_who(token) or (acts and self._is_acting(token))

    def _is_plural(self, token: Token, lemma: str) -> bool:
        """True for the plural of a noun, and not for a name like one: "Chris"."""
        text = token.lower_
        named = token.tag_ == "NNS" and token.text.istitle() and lemma == text and lemma not in self._words.both
        return (token.tag_ in ("NNS", "NNPS") and not named) or self._is_many(token)

    def _is_many(self, token: Token) -> bool:
        """True for a plural that the parser does not know as one: "ninjas"."""
        lemma = token.lemma_.lower()
        one = lemma.removesuffix("s")
        return one != lemma == token.lower_ and not self._words.is_person(lemma) and self._words.is_person(one)

    def _is_acting(self, token: Token) -> bool:
        """True for a noun that is a person where it acts: "the model poses", "the base lies on her back"."""
        if len(self._known) == 2 or self._words.part(token.lemma_.lower()):
            return False
        return wordnet.may_be_person(token.lemma_.lower()) and not wordnet.is_animal(token.lemma_.lower())

    def _many(self, token: Token, children: set[str]) -> str:
        if any(self._words.numbers.get(child, 0) > 2 for child in children):  # "three people"
            self.third.append(token)
            return ""
        self._describe(token, self._pair)
        return "ab"

    def _describe(self, token: Token, known: _Known) -> None:
        """Notes what a noun and its adjectives say: "an elderly lady", "two men", but not "an old friend"."""
        words, lemma = self._words, token.lemma_.lower()
        known.sex = known.sex or words.sex(lemma)
        known.age = known.age or words.age(lemma)
        if words.sex(lemma) or lemma in ANYONE | {"couple", "people"}:
            beside = (c for c in token.children if c.dep_ not in _OTHERS)
            known.age = known.age or next((age for c in beside if (age := words.age(c.lower_))), "")

    def _has(self, word: str) -> str:
        return next((who for who, known in self._known.items() if word in known.words), "")

    def _named(self, word: str) -> str | None:
        own = self._has(word)
        return self._as(own, word) if own else self._new(word, None)

    def _new(self, lemma: str, token: Token | None) -> str | None:
        free = next((who for who in "ab" if who not in self._known), "")
        if not free:
            bare = [who for who in "ab" if set(self._known[who].words) <= ANYONE | {"one", "other", "another"}]
            free = next((who for who in bare if who != self.last), "")
            if not free and lemma in ANYONE | {"another"}:
                free = other_of(self.last) or "a"
        if not free:
            if token is not None:
                self.third.append(token)
            return None
        return self._as(free, lemma)

    def _as(self, who: str, word: str) -> str:
        known = self._known.setdefault(who, _Known())
        known.words.append(word)
        known.sex = known.sex or self._words.sex(word)
        known.age = known.age or self._words.age(word)
        self.last = who
        return who

    def _other(self, subject: str, lemma: str = "other") -> str:
        named = self._has("other")
        one = subject if len(subject) == 1 else self.last
        who = "a" if one == "b" else "b"
        if named and len(subject) != 1 and len(named) == 1:
            who = named  # "one whispers into the other's ear, and the other nods"
        known = self._known.setdefault(who, _Known())
        known.sex = known.sex or self._words.sex(lemma)
        return self._as(who, "other")

    def _pronoun(self, sex: str, subject: str, meets: bool = False) -> str:
        others = [who for who in "ab" if who not in (subject, self._has("i"), self._has("you"))]
        others = others or [who for who in "ab" if who != subject]
        fits = [who for who in others if who in self._known and self._known[who].sex == sex]
        open_ = [who for who in others if who not in self._known or not self._known[who].sex]
        if fits:
            who = self.last if self.last in fits else fits[0]
        elif open_:
            known = [who for who in open_ if who in self._known]
            likely = self.focus or self.last
            who = likely if likely in known else (known or open_)[0]
            who = other_of(who) if meets and len(known) == 1 < len(open_) else who
            self._known.setdefault(who, _Known()).sex = sex
        else:
            who = (other_of(subject) or "a") if subject else self.last or "a"
        self.last = who
        return who

    def address(self) -> None:
        """Says that an order is given to person a."""
        if not self._has("you"):
            self._as("a", "you")

    def sex(self, who: str) -> str:
        """The sex of a person, as far as the words have told it."""
        return self._known.get(who, _Known()).sex

    def owner(self, token: Token, subject: str) -> str:
        """The owner of a part of the body, by its possessive; "" where the words leave it open."""
        if self.alone and len(subject) < 2:
            return subject or "a"
        if subject and any(child.lower_ == "own" for child in token.children):
            return subject
        for child in token.children:
            if child.dep_ == "poss" or child.tag_ == "PRP$":
                text = child.lower_
                if text in ("his", "her"):
                    return self._possessive(PRONOUN_SEX[text], subject)
                if text in ("their", "our", "its"):
                    return "ab" if len(subject) == 2 else ""
                if text == "your" and not self._has("you"):  # of an order: whoever is addressed
                    return "ab" if len(subject) == 2 else subject
                if child.lower_ == "other" and any(c.lower_ in ("each", "one") for c in child.children):
                    return "each"
                who = self.person(child, subject) or ""
                self.note_states(child, who)
                return who
        of = next((child for child in token.children if child.lower_ == "of"), None)
        for child in of.children if of is not None else ():
            return self.person(child, subject) or ""
        return ""

    def note_states(self, noun: Token, who: str) -> None:
        """Notes what a person does by their noun and the phrases that hang on it."""
        if who and noun.pos_ in ("NOUN", "PROPN"):
            self.states |= {phrase.i: (verb, who) for phrase, verb in states_of(noun)}

    def _possessive(self, sex: str, subject: str) -> str:
        if len(subject) == 1:
            other = other_of(subject)
            if self._has("you") == subject or self._has("i") == subject:
                return other
            own = self._known.get(subject, _Known()).sex
            others = self._known.get(other, _Known()).sex
            if own == sex and others != sex:
                return subject
            if (own and own != sex) or (not own and others == sex):
                return other
            return ""
        owner = next((who for who in "ab" if who in self._known and self._known[who].sex == sex), "")
        told = any(known.sex for known in self._known.values())
        return owner or (self._pronoun(sex, "") if subject == "ab" and not told else "")  # "they dance, her head …"


def _is_who(noun: Token) -> bool:
    """True for a noun of which a clause with "who" goes on: "the model, who poses"."""
    clauses = (c for c in noun.children if c.dep_ == "relcl" and wordnet.may_be_person(noun.lemma_.lower()))
    return any(c.lower_ == "who" for clause in clauses for c in clause.children)


def is_somebody(word: str) -> bool:
    """True for a word that stands for one of the two people, or for both: "he", "kids", "other"."""
    named = closed("nominatives") | closed("others") | vocabulary().both | {A_NAME.lower(), B_NAME.lower()}
    return word in named | ANYONE or any(map(vocabulary().is_person, (word, word.removesuffix("s"))))


def _meets_other(pronoun: Token) -> bool:
    """True for a person who acts on one of the other sex and did not act before: "a thief runs, she chases him"."""
    beside = [t for c in pronoun.head.children for t in (c, *c.children) if t.dep_ in ("dobj", "dative", "pobj")]
    other = any(PRONOUN_SEX.get(t.lower_, "") not in ("", PRONOUN_SEX[pronoun.lower_]) for t in beside)
    return pronoun.dep_ == "nsubj" and not pronoun.is_sent_start and other


def begins_clause(pronoun: Token) -> bool:
    """True for a subject that the parser joined to the object before: "hugs Beth and he waves"."""
    joined = pronoun.dep_ == "conj" and pronoun.head.dep_ in ("dobj", "dative", "pobj")
    return joined and pronoun.lower_ in closed("nominatives") and pronoun.tag_ == "PRP"


def states_of(noun: Token) -> Iterator[tuple[Token, str]]:
    """The words of place or posture on a noun or its adjective, with their verbs: "a man in a chair"."""
    words = vocabulary()
    yield from ((c, verb) for c in noun.children if c.dep_ == "amod" and (verb := words.state("-", c.lower_)))
    within = [noun, *(c for c in noun.children if c.dep_ in ("amod", "acl", "appos") and c.pos_ == "ADJ")]
    for phrase in (c for token in within for c in token.children if c.dep_ == "prep"):
        for place in phrase.children:
            own = not words.part(place.lemma_.lower()) or any(c.tag_ == "PRP$" for c in place.children)
            if place.dep_ == "pobj" and own and (verb := words.state(phrase.lower_, place.lemma_.lower())):
                yield phrase, verb
