"""The given person of a reaction: read from a file or taken from a result, trimmed, shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from motion import Clip, Duet, InputError
from motion.formats.importing import import_motion
from motion.formats.recording import ImportChoices
from motion.retarget import to_smpl
from webdemo.inference.method import SECONDS, Variant
from webdemo.inference.methods import AUTOMATIC, automatic, installed, variants
from webdemo.inference.requests.actor import LETTERS, at_30_fps, choose_actor
from webdemo.inference.run import Result
from webdemo.ui.places import READING
from webdemo.view.payload import Payload, player_payload

from .fields import animation_labels, animation_list
from .player import GIVEN

AUTO = "auto"
ReadWith = tuple[str, float | None, str, int | None]
"""Up axis, frames a second, order of joints and number of the animation, as the page's controls give them."""


def react_choices() -> list[tuple[str, str]]:
    """(label, key) of the ways to react whose weights are there, in each of their modes; automatic first."""
    choices = [(v.label, v.key) for method in installed("react") for v in method.variants]
    return [("Automatic", AUTOMATIC), *choices]


def reactor(key: str | None, fields: Mapping[str, Any] | None = None) -> Variant:
    """A way to react, by key; the default for an empty one.

    Args:
        key: of a variant, or "automatic".
        fields: the page's; their ``prompt`` and ``role`` decide what is automatic.

    Raises:
        InputError: for an unknown key.
    """
    known = variants("react")
    if key == AUTOMATIC:
        asked = fields or {}
        key = automatic(str(asked.get("prompt") or ""), str(asked.get("role") or "a")).name
    if key and key not in known:
        raise InputError(f"There is no method {key!r:.40}: choose one of {', '.join(known)}.")
    return known[key] if key else next(iter(known.values()))


@dataclass(frozen=True)
class Source:
    """The motion from which a session chose an actor.

    Attributes:
        name: of the file or the result.
        people: up to six, at 30 fps, with the joints of the file where those have to be fitted.
        chosen: "a", "b" …: which one is offered first.
        path: the file, so that it can be read anew with other choices; None for a result.
        found: a line on how the file was read, "" for a result.
        notes: sentences about how well it could be read.
        read_with: what was known of the file: up axis, rate, order of its joints, and its chosen animation.
        animations: labels of those in the file, where there is one to choose.
        asks: True if how it was read should be looked at: something was assumed.
    """

    name: str
    people: tuple[Clip, ...] = field(repr=False)
    chosen: str = "a"
    path: Path | None = None
    found: str = ""
    notes: tuple[str, ...] = ()
    read_with: ReadWith = ("auto", None, "auto", None)
    animations: tuple[str, ...] = ()
    asks: bool = False
    _fitted: dict[Any, tuple[Clip, ...]] = field(default_factory=dict, repr=False, compare=False)
    """What was fitted last, by what was asked."""

    @property
    def choices(self) -> list[tuple[str, str]]:
        """(label, letter) of everybody."""
        return [(f"Person {letter.upper()}", letter) for letter in LETTERS[: len(self.people)]]

    @property
    def seconds(self) -> float:
        """Length in seconds."""
        return self.people[0].seconds

    @property
    def end(self) -> float:
        """The default end of the trim: that of the motion, or as much of it as a network takes."""
        return min(self.seconds, SECONDS[1])

    def actor(self, person: str, start: float, end: float) -> Clip:
        """The trimmed actor on SMPL22; raises InputError where the times do not lie in the motion."""
        return self._on_smpl((person, start, end), (self._part(person, start, end),))[0]

    def _part(self, person: str, start: float, end: float) -> Clip:
        chosen = person if len(self.people) > 1 else None
        clip = choose_actor(self.people, person=chosen, start=start, end=end, name=self.name)
        return replace(clip, name=self.name)

    def whole(self, longest: float) -> tuple[Clip, ...]:
        """Everybody on SMPL22, or as they are in the file where that is longer than ``longest`` seconds."""
        return self.people if self.seconds > longest else self._on_smpl("whole", self.people)

    def _on_smpl(self, asked: Any, people: tuple[Clip, ...]) -> tuple[Clip, ...]:
        if asked not in self._fitted:
            made = to_smpl(Duet(*people)).people if len(people) == 2 else tuple(map(to_smpl, people))
            self._fitted.clear()
            self._fitted[asked] = made
        return self._fitted[asked]

    def preview(self, person: str, start: float, end: float) -> Payload:
        """The trimmed actor for the player; a part that is too long to react to is shown as it is."""
        too_long = end - start > SECONDS[1] + 0.05
        actor = self._part(person, start, end) if too_long else self.actor(person, start, end)
        return player_payload(replace(actor, name=GIVEN), title=self.describe(person))

    def describe(self, person: str) -> str:
        """The name, and which person of two."""
        return f"{self.name}, person {person.upper()}" if len(self.people) > 1 else self.name


def offered_animations(source: Source | None) -> Any:
    """An update of the list of a source's animations."""
    return animation_list(source.animations, source.read_with[3]) if source else animation_list((), None)


def read_source(path: str | Path, name: str | None = None, read_with: ReadWith | None = None) -> Source:
    """A motion file as a source; raises InputError where it cannot be read."""
    path = Path(path)
    with READING.place():
        imported = import_motion(path, choices=import_choices(*read_with) if read_with else None)
    return Source(
        name or path.name,
        tuple(at_30_fps(person) for person in imported.people),
        path=path,
        found=imported.describe(),
        notes=imported.notes,
        asks=imported.asks,
        read_with=read_with or Source.read_with,
        animations=animation_labels(imported.animations),
    )


def import_choices(up: str, fps: float | None, order: str = AUTO, animation: int | None = None) -> ImportChoices:
    """The page's import controls as choices; "auto" and an empty or zero rate leave a thing to be found."""
    chosen = {"up": up, "order": order}
    known = {name: value for name, value in chosen.items() if value != AUTO}
    return ImportChoices(**known, fps=float(fps) if fps else None, animation=animation)


def result_source(result: Result, title: str) -> Source:
    """The people of a result's first sample, as they were made or given.

    It is called after the file that the result began with, or else after its title without a full stop.
    """
    asked = result.manifest.get("request", {})
    given = asked.get("motion" if asked.get("kind") == "predict" else "actor") or {}
    return Source(given.get("name") or title.rstrip("."), result.duets[0].people)


def with_method(fields: Mapping[str, Any], key: str) -> dict[str, Any]:
    """The page's fields for another method, with the steps it is meant for where the model is another."""
    asked, other = reactor(fields.get("method"), fields).method, reactor(key, fields).method
    steps = fields["steps"] if other == asked else other.steps
    return {**fields, "method": key, "steps": steps}


def chosen_actor(fields: Mapping[str, Any]) -> dict[str, Any]:
    """A request's fields from those of the page.

    ``source``, ``person``, ``start`` and ``end`` become ``actor``, and ``method`` becomes ``model`` and ``mode``. Words
    are left out if the method takes none.

    Raises:
        InputError: where no source is chosen or the times do not fit.
    """
    source: Source | None = fields["source"]
    if source is None:
        raise InputError("Nobody is given yet: drop a motion file, or pick an example or a result.")
    own = ("source", "person", "start", "end", "method")
    actor = source.actor(fields["person"], fields["start"], fields["end"])
    chosen = reactor(fields.get("method"), fields)
    kept = {name: value for name, value in fields.items() if name not in own}
    if "words" not in chosen.method.takes:
        kept["prompt"] = ""
    return {"actor": actor, "model": chosen.method.name, "mode": chosen.mode, **kept}
