"""The lexicon: one entry an act, in TOML files grouped by kind, and the nouns of things that have a shape.

An entry gives everything about its act: how it is said, the words on which the network was trained, how long it takes,
how it is staged, the rule that checks it, and examples that are its tests. ``python -m acts check FOLDER`` says what is
wrong with an entry, with its file and line.
"""

from __future__ import annotations

import os
import re
import tomllib
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from motion import InputError
from motion.things import FIXTURES

from .frames import FAMILIES, Frame
from .plan import Act, problem
from .shapes import Posture, Shape

OURS = Path(__file__).with_name("lexicon")
FOLDERS = "PASDEDEUX_ACTS"
"""Environment variable with further folders of acts, separated as in ``PATH``."""
MOST_BYTES = 1_000_000
"""Bytes of a lexicon file, at most."""

_NAME = re.compile(r"[a-z0-9-]{1,60}")

Sentence = Annotated[str, Field(min_length=1, max_length=300)]
_Passed = Literal["gives", "takes", "throws", "catches", "rolls", "kicks", "bounces"]
_Held = Literal["carries", "holds", "lifts", "puts", "drops", "plays", "fights", "uses"]
_Stands = Literal["sits", "passes", "faces", "opens", "closes"]
Does = Literal["", _Passed, _Held, _Stands]
"""What is done with a thing: the values that an entry's ``thing`` may have."""
SEATS = ("chair", "bench", "bed")
"""Kinds of things on which people sit."""
Prop = Literal["", "ball", "book", "cup", "guitar", "phone", "ring", "rope", "stick", "sword"]
"""Things that go without saying, of which only a rope has no shape: the values that an entry's ``prop`` may have."""


class Entry(BaseModel):
    """One act.

    Attributes:
        frames: how it is said; see :mod:`acts.frames`.
        synsets: WordNet senses whose other verbs, and those below them, may stand in its frames' place.
        caption: the network's words, as ``{a} [pat] {b} on the {part}``; see :func:`acts.captions.worded`. The first is
            used, the others are paraphrases of it.
        chip: the act in a few words beside its people, as a caption, where neither caption nor name says it well.
        seconds: how long it usually takes.
        stage: its score; empty leaves it to the network's words.
        refused: what is then shown of a refusal, which leaves the act itself undone.
        reaction: what the other does at it, where the words say nothing that they do.
        rule: predicates of :mod:`motion.metrics.sentences` that its motion fulfils, with ``who`` for the agent and
            ``whom`` for the patient.
        shown: False for what no body shows ("falls in love", "turns on the lamp"): it is known, and stays unread.
        to: "other" for what is done to the other person even where the words do not name them, as a salute.
        thing: what it does with the thing that its words name, one of :data:`Does`; a person who "sits" has a seat
            even where they name none.
        prop: the kind of thing with which it is done where they name none: a cup for "drinks".
        hand: the shape of the fingers while it is done (:mod:`motion.hands`); "" where none is special.
        mutual: done together even where one is named first: "he hugs her" has both arms around.
        near: metres between the two people, where one comes up to the other for it.
        alone: the act that it is where the text names nobody else: what is taken from nobody is grabbed.
        moment: over so soon that nobody is found at it: "as she faints" begins with her on her feet.
        answers: done because of what the other does, and so after it, such as ducking or catching.
        reads, ignores: sentences that have the act and that do not.
        group: the file that it stands in.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    frames: Annotated[tuple[Sentence, ...], Field(min_length=1, max_length=60)]
    synsets: Annotated[tuple[str, ...], Field(max_length=20)] = ()
    caption: Annotated[tuple[Sentence, ...], Field(max_length=12)] = ()
    chip: Sentence | None = None
    seconds: Annotated[float, Field(gt=0, le=60)] = 3.0
    stage: Annotated[tuple[Shape, ...], Field(max_length=12)] = ()
    refused: Annotated[tuple[Shape, ...], Field(max_length=6)] = ()
    reaction: Annotated[tuple[Shape, ...], Field(max_length=6)] = ()
    rule: Annotated[tuple[Sentence, ...], Field(max_length=6)] = ()
    to: Literal["", "other"] = ""
    thing: Does = ""
    prop: Prop = ""
    hand: Literal["", "flat", "fist", "point", "grasp", "clasp", "thumbs up", "pinch"] = ""
    mutual: bool = False
    near: Annotated[float, Field(ge=0.3, le=1.5)] = 0.75
    answers: bool = False
    alone: str = ""
    moment: bool = False
    shown: bool = True
    reads: Annotated[tuple[Sentence, ...], Field(min_length=1)]
    ignores: tuple[Sentence, ...] = ()
    group: str = ""

    @field_validator("frames")
    @classmethod
    def _spell_out(cls, frames: tuple[str, ...]) -> tuple[str, ...]:
        """The frames with the verbs that a family stands for."""
        for family, verbs in FAMILIES.items():
            frames = tuple(frame.replace(family, verbs) for frame in frames)
        return frames

    @model_validator(mode="after")
    def _check(self) -> Entry:
        if self.shown and not self.caption:
            raise ValueError("an act that is shown needs a caption")
        return self

    def takes_down(self) -> bool:
        """True for an act with a posture off one's feet in which somebody stays from then on."""
        postures = [shape for shape in self.stage if isinstance(shape, Posture) and shape.posture != "stands"]
        return any(not (posture.passing or posture.already) for posture in postures)


@dataclass(frozen=True, eq=False)
class Lexicon:
    """Entries by name, and their frames by the lemma of the verb. Two lexicons are equal if they are the same object.

    Attributes:
        entries: by name, a lab's own among them.
        frames: (name, frame) by the lemma of the verb.
        synsets: names by the WordNet sense that stands for them.
        own: names of the entries of further folders.
    """

    entries: Mapping[str, Entry]
    frames: Mapping[str, list[tuple[str, Frame]]]
    synsets: Mapping[str, tuple[str, ...]]
    own: frozenset[str] = frozenset()

    @classmethod
    def of(cls, entries: Mapping[str, Entry]) -> Lexicon:
        """Compiles the entries' frames; raises InputError for a frame that is none."""
        frames: dict[str, list[tuple[str, Frame]]] = defaultdict(list)
        synsets: dict[str, list[str]] = defaultdict(list)
        for name, entry in entries.items():
            for text in entry.frames:
                frame = Frame.parse(text, entry.to == "other")
                for verb in frame.verbs:
                    frames[verb].append((name, frame))
            for synset in entry.synsets:
                synsets[synset].append(name)
        return cls(entries, dict(frames), {key: tuple(names) for key, names in synsets.items()})


def lexicon(folders: tuple[Path, ...] = ()) -> Lexicon:
    """Our entries, and those of further folders: of ``PASDEDEUX_ACTS`` and of ``folders``, each read once.

    A later entry replaces an earlier one of its name.

    Raises:
        InputError: for the first thing that is wrong in a further folder, with its file and line.
    """
    named = os.environ.get(FOLDERS, "").split(os.pathsep)
    return _lexicon((*(Path(name).resolve() for name in named if name), *folders))


@lru_cache(maxsize=8)
def _lexicon(folders: tuple[Path, ...]) -> Lexicon:
    ours: dict[str, Entry] = {}
    _read_all(OURS, ours)
    own: dict[str, Entry] = {}
    for folder in folders:
        _read_all(folder, own)
    return replace(Lexicon.of(ours | own), own=frozenset(own))


def _read_all(folder: Path, into: dict[str, Entry]) -> None:
    for wrong in (each for path in files(folder) for each in read_file(path, into)):
        raise InputError(wrong)


def files(folder: Path) -> list[Path]:
    """The TOML files of a folder, by name; raises InputError if it is none."""
    if not folder.is_dir():
        raise InputError(f"{folder} is not a folder of acts: name one that holds .toml files.")
    return sorted(folder.glob("*.toml"))


def read_file(path: Path, into: dict[str, Entry]) -> Iterator[str]:
    """Adds the entries of a file to ``into``, and yields a sentence, with file and line, for each that is wrong."""
    try:
        if path.stat().st_size > MOST_BYTES:
            yield f"{path.name} is larger than {MOST_BYTES // 1000} kB: split it."
            return
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        yield f"{path.name} cannot be read: {error.strerror}."
        return
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        yield f"{path.name} is not TOML: {error}."
        return
    for name, fields in tables.items():
        where = f"{path.name}, line {_line(text, name)}, [{name}]"
        if not isinstance(fields, dict):
            yield f"{where}: write the entry as a table, [{name}], with its frames below."
            continue
        if not _NAME.fullmatch(name):
            yield f"{where}: a name has at most 60 small letters, digits and dashes."
            continue
        try:
            entry = Entry(**{**fields, "group": path.stem})
            for frame in entry.frames:
                Frame.parse(frame)
        except ValidationError as error:
            yield f"{where}: {problem(error)}"
        except InputError as error:
            yield f"{where}: {error}"
        else:
            into[name] = entry


def _line(text: str, name: str) -> int:
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip().strip("[]").strip('"') == name:
            return number
    return 1


# ---- nouns: the kinds of things that have a shape ---------------------------------------------------------------
NOUNS = Path(__file__).parent / "things" / "nouns.toml"
_WORD = re.compile(r"[a-z]+(?:'s)?")


@lru_cache(maxsize=1)
def _tables() -> tuple[dict[str, str], dict[str, frozenset[str]]]:
    tables = tomllib.loads(NOUNS.read_text(encoding="utf-8"))
    kinds = {noun: kind for kind, nouns in tables["nouns"].items() for noun in nouns}
    return kinds, {name: frozenset(nouns) for name, nouns in tables["lists"].items()}


def kind_of(noun: str) -> str:
    """The kind of thing that a noun names, such as "cup" for "a mug" or "mugs"; "" if it has no shape."""
    return next((kind for _, kind in reversed(nouns_in(noun))), "")  # "paper bag" is a bag


def nouns_in(text: str) -> list[tuple[str, str]]:
    """The nouns of a text that have a shape, in order, each with its kind."""
    kinds = _tables()[0]
    return [(word, kinds[word]) for word in map(_singular, _WORD.findall(text.lower())) if word in kinds]


def is_fixture(noun: str | None) -> bool:
    """True for a noun of what stands where it is, such as a window, so that people go to it and face it."""
    return kind_of(noun or "") in FIXTURES


def is_listed(text: str, name: str) -> bool:
    """True if a text has a noun of a list of ``nouns.toml``, such as the "floor" or something like it."""
    return any(_singular(word) in _tables()[1][name] for word in _WORD.findall(text.lower()))


def thing_of(act: Act, words: str) -> tuple[str, str]:
    """The thing of an act, as its noun and its kind; ("", "") where the words name nothing that has a shape.

    Args:
        act: of a plan.
        words: the text that it was read from.
    """
    if act.thing:
        kind = kind_of(act.thing)
        return (act.thing, kind) if kind else ("", "")
    return next(iter(nouns_in(words)), ("", ""))


def _singular(word: str) -> str:
    kinds, lists = _tables()
    known = kinds.keys() | frozenset[str]().union(*lists.values())
    word = word.removesuffix("'s")
    for end, instead in (("", ""), ("ves", "fe"), ("ies", "y"), ("es", ""), ("s", "")):
        if word.endswith(end) and (bare := word[: len(word) - len(end)] + instead) in known:
            return bare
    return word
