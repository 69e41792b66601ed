"""The sets of a study: chosen runs, told apart by one of their settings, and uploaded motions."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from motion import Duet, InputError
from webdemo.study import Stimulus
from webdemo.study.pairs import MOST_SETS
from webdemo.ui.history import Opened

from .actors import read_source
from .notebook import settings

ONE_SET = "one set"
TAG, NAME = "Tag", "Name"
MOST_RUNS = 100
MOST_FILES = 50
_SPEAKING = ("Method", TAG, NAME)
"""Settings whose values need no name before them."""
_LAST = ("Seed", "Seconds", "Samples", NAME)
"""Settings that are offered after all others, since they rarely are what a study is about."""


@dataclass(frozen=True)
class Candidate:
    """A motion of a chosen run.

    Attributes:
        stimulus: the motion.
        settings: of its run, by name; its tags are joined to one text.
    """

    stimulus: Stimulus
    settings: Mapping[str, str] = field(default_factory=dict)


def candidates(runs: Sequence[Opened]) -> list[Candidate]:
    """All motions of runs, and of the cells of their grids."""
    found: dict[str, list[Candidate]] = {}
    for run in runs:
        for each in (run, *run.beside):
            found.setdefault(each.entry.id, list(_motions(each, run)))
    return [candidate for each in found.values() for candidate in each]


def _motions(run: Opened, card: Opened) -> Iterator[Candidate]:
    """The samples of a run; its name and tags are those of the card that it stands on."""
    asked = run.entry.request
    values = dict(settings(run.entry))
    values |= {NAME: card.entry.title, TAG: " ".join(card.entry.tags)}
    given = asked.get("actor") or asked.get("motion")
    prompt = str(asked.get("prompt") or "")
    name = str(given.get("name", "")) if isinstance(given, Mapping) else prompt or run.entry.title
    seed = asked.get("seed")
    for i, motion in enumerate(run.result.duets):
        number = seed + i if isinstance(seed, int) else i
        yield Candidate(Stimulus(prompt, motion, number, name), values)


def ways(found: Sequence[Candidate]) -> list[tuple[str, str]]:
    """(label, setting) of everything that tells two to six sets apart, what a study is likely about first."""
    names = list(dict.fromkeys(name for each in found for name in each.settings))
    names = [TAG, *(n for n in names if n != TAG and n not in _LAST), *(n for n in _LAST if n in names)]
    offered = []
    for name in names:
        made = sets_by(found, name)
        if 2 <= len(made) <= MOST_SETS:
            counts = " against ".join(f"{label[:40]} ({len(each)})" for label, each in made.items())
            offered.append((f"{name}: {counts}", name))
    one_set = f"One set of all chosen motions ({len(found)}), against uploaded ones"
    return [*offered, (one_set, ONE_SET)]


def sets_by(found: Sequence[Candidate], setting: str) -> dict[str, list[Stimulus]]:
    """The motions by the value of a setting; those without a value are left out."""
    if setting == ONE_SET:
        return {"Chosen runs": [each.stimulus for each in found]}
    common: set[str] = set()
    if setting == TAG and found:
        common = set.intersection(*(set(each.settings.get(TAG, "").split()) for each in found))
    made: dict[str, list[Stimulus]] = {}
    for each in found:
        value = each.settings.get(setting, "")
        if setting == TAG:  # the first tag that not all of them have
            value = next((tag for tag in value.split() if tag not in common), "")
        if value:
            name = value if setting in _SPEAKING else f"{setting.lower()} {value}"
            made.setdefault(name, []).append(each.stimulus)
    return made


def uploaded_sets(
    given: Sequence[tuple[Sequence[str] | None, str]], taken: Collection[str] = ()
) -> dict[str, list[Stimulus]]:
    """Uploaded sets by their names.

    Args:
        given: the files of each set, none where it is not wanted, and its name.
        taken: names that other sets have.

    Raises:
        InputError: for a set without a name or with one that another has, and as :func:`uploaded`.
    """
    found: dict[str, list[Stimulus]] = {}
    for files, called in given:
        name = " ".join((called or "").split())
        if not files:
            continue
        if not name:
            raise InputError("An uploaded set has no name: give it one.")
        if name in taken or name in found:
            raise InputError(f"There is a set {name!r:.60} already: give the uploaded one another name.")
        found[name] = uploaded(files)
    return found


def uploaded(paths: Sequence[str]) -> list[Stimulus]:
    """The motions of files; their names, without what follows the point, find the runs that they stand beside.

    Raises:
        InputError: naming the file that cannot be read, or for too many.
    """
    if len(paths) > MOST_FILES:
        raise InputError(f"{len(paths)} files are too many: upload {MOST_FILES} at most.")
    found = []
    for path in map(Path, paths):
        try:
            source = read_source(path)
            people = source.people
            motion = Duet(people[0], people[1]) if len(people) > 1 else people[0]
        except InputError as error:
            raise InputError(f"{path.name}: {error}") from None
        found.append(Stimulus("", motion, name=path.stem))
    return found
