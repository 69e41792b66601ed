"""The words and frames that every family's captions share; notation as in :mod:`training.corpus.phrases`."""

# ruff: noqa: E501 (tables of sentences read better unbroken)

from __future__ import annotations

from dataclasses import dataclass

MANNERS: dict[str, tuple[str, ...]] = {
    "active": ("energetically", "with energy", "vigorously", "in an active way", "full of energy"),
    "angry": ("angrily", "in an angry way", "furiously", "with anger"),
    "childish": ("childishly", "like a child", "in a childish way", "playfully"),
    "chimpira": ("like a thug", "in a cocky way", "in a rough way", "roughly"),
    "feminine": ("in a feminine way", "in a womanly way", "femininely", "like a lady"),
    "giant": ("like a giant", "heavily", "in a heavy way", "with huge movements"),
    "happy": ("happily", "joyfully", "cheerfully", "in a happy way"),
    "masculine": ("in a masculine way", "in a manly way", "with a manly air"),
    "musical": ("rhythmically", "in a musical way", "as if to music", "with rhythm"),
    "not-confident": ("shyly", "timidly", "without confidence", "in an unsure way", "nervously"),
    "old": ("like an old person", "in an elderly way", "stiffly, like an old person", "as if very old"),
    "proud": ("proudly", "in a proud way", "with pride"),
    "sad": ("sadly", "in a sad way", "with sadness", "sorrowfully"),
    "tired": ("tiredly", "wearily", "in a tired way", "as if exhausted"),
    "youthful": ("in a youthful way", "like a young person", "with youthful energy", "youthfully"),
}
MANNERS.update(elderly=MANNERS["old"], exhausted=MANNERS["tired"], masculinity=MANNERS["masculine"])
ADJECTIVES = {
    "active": "energetic", "angry": "angry", "childish": "childish", "giant": "giant", "happy": "happy",
    "not-confident": "shy", "old": "old", "elderly": "elderly", "proud": "proud", "sad": "sad", "tired": "tired",
    "exhausted": "exhausted", "youthful": "young",
}  # fmt: skip
SPEEDS = {"slow": ("slowly", "at a slow pace", "without haste"), "fast": ("quickly", "fast", "in a hurry")}
DISTANCES = {
    "near": ("face to face", "standing close together", "close to each other", "at arm's length"),
    "far": ("from a distance", "standing far apart", "some way apart", "from afar"),
}
THINGS = (
    "an object",
    "a book",
    "a cup",
    "something",
    "a box",
    "a phone",
    "a bottle",
    "a gift",
    "a letter",
    "an apple",
)


@dataclass(frozen=True)
class Pair:
    """Names of two people, at first and later; ``by_text`` if the name follows the order of the text."""

    first: tuple[str, str]
    later: tuple[str, str]
    by_text: bool = True
    pronouns: tuple[str, str] = ("they", "they")


PAIRS: tuple[tuple[Pair, int], ...] = (
    (Pair(("one person", "the other"), ("the first person", "the other")), 6),
    (Pair(("one person", "the other person"), ("the first person", "the other person")), 3),
    (Pair(("one person", "another person"), ("the first person", "the second person")), 2),
    (Pair(("a person", "another person"), ("the first person", "the second person")), 4),
    (Pair(("a person", "someone else"), ("the first person", "the other")), 1),
    (Pair(("someone", "their partner"), ("the first person", "the partner")), 1),
    (Pair(("one", "the other"), ("the first", "the other")), 2),
    (Pair(("the first person", "the second person"), ("the first person", "the second person"), False), 3),
    (Pair(("the first", "the second"), ("the first", "the second"), False), 1),
    (Pair(("person A", "person B"), ("person A", "person B"), False), 2),
    (Pair(("person 1", "person 2"), ("person 1", "person 2"), False), 1),
    (Pair(("a man", "a woman"), ("the man", "the woman"), False, ("he", "she")), 1),
    (Pair(("a woman", "a man"), ("the woman", "the man"), False, ("she", "he")), 1),
    (Pair(("a man", "another man"), ("the first man", "the second man"), True, ("he", "he")), 1),
)
LEADS = (
    "Two people are together:",
    "There are two people:",
    "Two friends are together:",
    "Two people in a room:",
)
GROUPS = ("two people", "two friends", "two persons", "both people", "a pair of people", "the two people", "they",
           "the two", "two partners", "{A} and {B}", "{A} and {B}")  # fmt: skip
CASES = {
    "they": ("they", "them", "their"), "he": ("he", "him", "his"), "she": ("she", "her", "her"),
}  # fmt: skip

_ORDER = (
    "{A} {VA}, then {B} {VB}.", "{A} {VA}( and|, and) then {B} {VB}.", "First {A} {VA}, then {B} {VB}.",
    "First, {A} {VA}. Then {B} {VB}.", "{A} {VA}. (Then|After that,|Afterwards,|Next,) {B} {VB}.",
    "{B} {VB} after {A} {VA}.", "After {A} {VA}, {B} {VB}.", "{A} {VA}, after which {B} {VB}.",
    "{A} *start by {VA.ing}, and {B} *follow by {VB.ing}.", "{A} {VA} before {B} {VB}.",
    "Once {A} *has finished {VA.ing}, {B} {VB}.", "{A} {VA}; afterwards {B} {VB}.", "{A} {VA}( and|,) later {B} {VB}.",
)  # fmt: skip
_REPLY = (
    "{A} {VA} and {B} {VB}.", "{A} {VA}, and {B} {VB}.", "{A} {VA}, and in response {B} {VB}.",
    "{A} {VA}. In response, {B} {VB}.", "{A} {VA}. {B} {VB}.", "{A} {VA}, then {B} {VB}.",
    "First {A} {VA}, then {B} {VB}.", "{B} {VB} after {A} {VA}.", "{B} {VB} when {A} {VA}.",
    "When {A} {VA}, {B} {VB}.", "As {A} {VA}, {B} {VB}.", "{A} {VA}, so {B} {VB}.", "As an answer to {A}, who {VA}, {B} {VB}.",
    "{A} {VA}, and as an answer {B} {VB}.", "{B} {VB} as soon as {A} {VA}.", "{A} {VA}; {B} {VB}.",
    "{A} {VA} and (after that|a moment later) {B} {VB}.", "{B} *react to {A}, who {VA}: {B} {VB}.",
    "{B} {VB} in response to {A}, who {VA}.",
)  # fmt: skip
_WHILE = (
    "{A} {VA} while {B} {VB}.", "{A} {VA}, and {B} {VB}.", "{A} {VA} and {B} {VB}.", "{A} {VA} as {B} {VB}.",
    "While {A} {VA}, {B} {VB}.", "{B} {VB} while {A} {VA}.", "{A} {VA}. (Meanwhile,|At the same time,) {B} {VB}.",
    "{A} {VA}; {B} {VB}.", "{A} *is {VA.ing} while {B} *is {VB.ing}.", "{A} *is {VA.ing} and {B} {VB}.",
    "{A} {VA}. {B} {VB}.", "{B} *is {VB.ing} and {A} *is {VA.ing}.", "{A}, {VA.ing}, and {B}, {VB.ing}.",
    "As {B} {VB}, {A} {VA}.",
)  # fmt: skip
FRAMES = {"order": _ORDER, "reply": _REPLY, "while": _WHILE}
BOTH = (
    "{P} {V}.", "{P} {V}.", "{P} *is {V.ing}.", "{P} {V.ing}", "{P} *begin to {V.inf}.", "Here {P} {V}.",
    "A scene in which {P} {V}.",
)  # fmt: skip
ONE = ("{A} {VA}.", "{A} *is {VA.ing}.")

IRREGULAR = {"is": ("is", "are", "being", "be"), "be": ("is", "are", "being", "be"), "has": ("has", "have", "having", "have"),
              "do": ("does", "do", "doing", "do"), "go": ("goes", "go", "going", "go"),
              "lie": ("lies", "lie", "lying", "lie")}  # fmt: skip
DOUBLED = {"put", "pat", "stop", "hit", "get", "let", "step", "run", "clap", "slap", "jog", "chat", "hug",
            "wrap", "tap", "spar", "sit", "cut", "bid"}  # fmt: skip
