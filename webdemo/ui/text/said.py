"""Sentences of the server in the language of the visitor whose event is answered.

Sentences are made in English wherever they arise: so they are kept, logged and given to programs. The page's edge puts
them into another language by their templates, as gettext does: ``languages/de/sentences.toml`` has the English text,
with names in braces where the code fills something in, and beside it the German one. What no template fits stays
English.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from webdemo.ui.visitor import wanted_language

FOLDER = Path(__file__).with_name("languages")
"""A folder a language, without English."""
NAME = re.compile(r"\{(\w+)\}")
_SENTENCE = re.compile(r"(?<=[.!?…]) (?=[A-Z“])")
_WORD = re.compile(r"[A-Za-z]{2}")
_QUOTED = re.compile(r"“[^“”]*”")
_LISTS = ("; ", ", ")
MOST_PIECES = 60
"""Sentences or parts of a list, at most; a longer text stays English, so that none takes long."""
_DEPTH = 6
"""Templates within values of templates, at most."""

Phrases = Mapping[str, str]
"""Parts of sentences and what they are in the other language."""


@dataclass(frozen=True)
class Template:
    """An English text with names in braces and its translation.

    Attributes:
        parts: the English text before, between and behind the names.
        names: in their order.
        text: the translation.
    """

    parts: tuple[str, ...]
    names: tuple[str, ...]
    text: str

    def values(self, sentence: str) -> dict[str, str] | None:
        """The values with which the English text is this sentence; None if it is another."""
        first, *between, last = self.parts
        end = len(sentence) - len(last)
        if not sentence.startswith(first) or not sentence.endswith(last) or end < len(first):
            return None
        found, at = [], len(first)
        for part in between:
            stop = sentence.find(part, at, end)
            if stop < 0:
                return None
            found.append(sentence[at:stop])
            at = stop + len(part)
        return dict(zip(self.names, (*found, sentence[at:end]), strict=True))

    def filled(self, values: Phrases) -> str:
        """The translation with values in the place of the names."""
        return NAME.sub(lambda match: values[match[1]], self.text)


@dataclass(frozen=True)
class Translations:
    """The translations of a language: of whole texts, and templates, those with most words first."""

    whole: Phrases
    templates: tuple[Template, ...]

    @classmethod
    def of(cls, texts: Phrases) -> Translations:
        """English text → translation, both with the same names in braces."""
        templates = [
            Template(tuple(pieces[::2]), tuple(pieces[1::2]), text)
            for english, text in texts.items()
            if len(pieces := NAME.split(english)) > 1
        ]
        templates.sort(key=lambda each: -sum(map(len, each.parts)))
        return cls({key: text for key, text in texts.items() if not NAME.search(key)}, tuple(templates))

    def say(self, text: str, phrases: Phrases, depth: int = _DEPTH) -> str:
        """A text in this language: as a whole, by its template, sentence by sentence or as a list; or as it is."""
        if found := phrases.get(text) or self.whole.get(text):
            return found
        if not depth or not _WORD.search(text) or _QUOTED.fullmatch(text):
            return text

        def inner(part: str) -> str:
            return self.say(part, phrases, depth - 1)

        over_sentences = ""
        for template in self.templates:
            if (values := template.values(text)) is None:
                continue
            filled = template.filled({name: inner(value) for name, value in values.items()})
            if not any(_SENTENCE.search(value) for value in values.values()):
                return filled
            over_sentences = over_sentences or filled
        sentences = _SENTENCE.split(text)
        if 1 < len(sentences) <= MOST_PIECES and (said := [inner(each) for each in sentences]) != sentences:
            return " ".join(said)
        if over_sentences:
            return over_sentences
        for mark in _LISTS:
            if 1 < len(pieces := text.split(mark)) <= MOST_PIECES:
                return self.whole.get(mark, mark).join(map(inner, pieces))
        return text


def said(text: str, phrases: Phrases | None = None, *, language: str | None = None) -> str:
    """A text of the server in the visitor's language.

    Args:
        text: in English, with the values already in it.
        phrases: parts of it that are known here alone, such as the acts of a plan.
        language: by default that of the event that is being answered.
    """
    known = _translations().get(language or wanted_language())
    return known.say(text, phrases or {}) if known else text


def words_of(language: str, name: str) -> Phrases:
    """A file of a language, without its sections; {} where there is none."""
    return {key: value for section in sections_of(language, name).values() for key, value in section.items()}


def sections_of(language: str, name: str) -> Mapping[str, Phrases]:
    """A file of a language by its sections; {} where there is none."""
    return _files().get(language, {}).get(name, {})


def known_languages() -> Sequence[str]:
    """The languages other than English that have a folder."""
    return tuple(_files())


@cache
def _files() -> dict[str, dict[str, dict[str, dict[str, str]]]]:
    return {
        folder.name: {
            path.stem: tomllib.loads(path.read_text(encoding="utf-8")) for path in folder.glob("*.toml")
        }
        for folder in sorted(FOLDER.iterdir())
        if folder.is_dir()
    }


@cache
def _translations() -> dict[str, Translations]:
    return {language: Translations.of(words_of(language, "sentences")) for language in known_languages()}
