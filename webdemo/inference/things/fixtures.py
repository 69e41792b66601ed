"""Windows, doors and a hi-fi: they stand before the people who go to them, and their parts open and close."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion import SMPL22
from motion.easing import smoothstep
from motion.things import FIXTURES, Thing, room, shape

from .holding import Hands, level, smoothed, yaw_of
from .uses import Use

Array = NDArray[np.floating]

BODIES = {"curtain": "window"}
"""Kinds that are part of another one."""
NEAR, FAR = 0.42, 0.72
"""Metres from a pelvis to a fixture at least, and as far as hands may reach."""
BY = 1.0
"""Metres from where a fixture is used beyond which somebody is elsewhere."""
THERE = 0.3
"""Metres from where somebody stays within which they have come to it."""
BACK = 0.45
"""Metres by which a fixture is moved back, at most, from where hands would reach it best."""
FOOT = 0.08
"""Metres around a joint of a leg that are its own."""
LEGS = [SMPL22.index(f"{side}_{joint}") for side in ("left", "right") for joint in ("knee", "ankle", "foot")]
TAKES = 1.1
"""Seconds in which a part opens or closes."""
_HALF = room.CURTAIN / 2 + 0.01
_SWUNG = np.radians(105.0)


@dataclass(frozen=True)
class Leaf:
    """A part of a fixture that moves.

    Attributes:
        kind: of its surface.
        moved_by: kind of the noun that it stands for.
        closed, opened: its place (x, y, z) in the fixture's frame and its yaw in radians.
        is_open: as it is where nothing says.
    """

    kind: str
    moved_by: str
    closed: tuple[float, float, float, float]
    opened: tuple[float, float, float, float]
    is_open: bool = False


LEAVES: dict[str, tuple[Leaf, ...]] = {
    "window": (
        *(
            Leaf(
                "sash",
                "window",
                (-side * room.PANE_WIDTH, room.SILL, 0.0, hinge),
                (-side * room.PANE_WIDTH, room.SILL, 0.0, hinge + side * _SWUNG),
            )
            for side, hinge in ((1, 0.0), (-1, np.pi))
        ),
        *(
            Leaf("curtain", "curtain", (side * _HALF, 0.0, 0.14, 0.0), (side * 3.1 * _HALF, 0.0, 0.14, 0.0), True)
            for side in (-1, 1)
        ),
    ),
    "door frame": (
        Leaf("door", "door frame", (-room.DOOR_WIDTH / 2, 0.0, 0.0, 0.0), (-room.DOOR_WIDTH / 2, 0.0, 0.0, _SWUNG)),
    ),
}
"""The moving parts of fixtures by kind; seen from the front, which is where the people are, they open to the back."""


@dataclass
class Fixture:
    """One fixture with all that is done before it.

    Attributes:
        kind: of :data:`motion.things.FIXTURES`, without those that are part of another.
        name: what the words call it.
        place: (3,) metres on the floor.
        ahead: (3,) level direction of its front.
        events: what is done, as a manifest holds it.
        turned: (kind, frame, opens) of each opening and closing.
    """

    kind: str
    name: str
    place: Array
    ahead: Array
    events: list[dict[str, Any]] = field(default_factory=list)
    turned: list[tuple[str, int, bool]] = field(default_factory=list)

    def things(self, frames: int, fps: float) -> Iterator[Thing]:
        """The body and the moving parts, each with its track."""
        yield Thing.at_rest(self.kind, shape(self.kind), self.place, yaw_of(self.ahead), frames, self.name)
        for leaf in LEAVES.get(self.kind, ()):
            yield placed_leaf(leaf, self.place, yaw_of(self.ahead), self._open(leaf, frames, fps))

    def _open(self, leaf: Leaf, frames: int, fps: float) -> Array:
        """(T,) how far a part is open, 0 to 1."""
        moments = [(frame, opens) for kind, frame, opens in self.turned if kind == leaf.moved_by]
        first = not moments[0][1] if moments else leaf.is_open
        share = np.full(frames, float(first))
        for frame, opens in moments:
            now = smoothstep((np.arange(frames) - frame) / (TAKES * fps))
            share += now * (float(opens) - share)
        return share


def placed_leaf(leaf: Leaf, place: Array, yaw: float, share: Array) -> Thing:
    """A moving part of a fixture at ``place`` (3,) turned by ``yaw``, open by a share (T,)."""
    x, y, z, turn = ((1 - share) * shut + share * wide for shut, wide in zip(leaf.closed, leaf.opened, strict=True))
    cos, sin = np.cos(yaw), np.sin(yaw)
    places = np.stack([cos * x + sin * z, y, -sin * x + cos * z], axis=1) + place
    angles = yaw + turn
    turned = np.zeros((len(share), 3, 3))
    turned[:, 0, 0] = turned[:, 2, 2] = np.cos(angles)
    turned[:, 0, 2], turned[:, 2, 0], turned[:, 1, 1] = np.sin(angles), -np.sin(angles), 1.0
    return Thing(leaf.kind, shape(leaf.kind), places, turned)


def fixtures(hands: Hands, uses: Sequence[Use]) -> list[Fixture]:
    """The fixtures of some uses: one of each kind, where somebody first does something with it."""
    found: dict[str, Fixture] = {}
    ours = [use for use in uses if use.does in ("faces", "opens", "closes") and use.kind in FIXTURES]
    for use in sorted(ours, key=lambda use: use.does == "faces"):  # hands say best where it is
        kind = BODIES.get(use.kind, use.kind)
        if kind not in found:
            found[kind] = Fixture(kind, kind if kind != use.kind else use.name, *_spot(hands, use, use.agents[0]))
    for use in ours:
        fixture = found[BODIES.get(use.kind, use.kind)]
        for who in use.agents:
            _done(hands, use, who, fixture)
    return list(found.values())


def _moment(hands: Hands, use: Use, who: int) -> int:
    """The frame at which somebody there has their hands out as far as they get, or the last one of a way or a look."""
    start, stop = min(use.start, hands.frames - 1), max(min(use.stop, hands.frames), use.start + 1)
    if use.does == "faces":
        return stop - 1
    pelvis = hands.joint(who, "pelvis")[start:stop, [0, 2]]
    there = np.linalg.norm(pelvis - pelvis[-1], axis=1) < THERE
    reach = np.where(there, _reach(hands, who)[start:stop], -np.inf)
    return start + int(np.argmax(reach > reach.max() - 0.08))


def _reach(hands: Hands, who: int) -> Array:
    """(T,) metres by which a person's foremost palm is ahead of their pelvis."""
    out = hands.palms[who] - hands.joint(who, "pelvis")
    return smoothed(np.einsum("stj,tj->st", out, hands.ahead[who]).max(axis=0), 5)


def _spot(hands: Hands, use: Use, who: int) -> tuple[Array, Array]:
    """The place of a fixture before a person who uses it, and the direction of its front."""
    frame = _moment(hands, use, who)
    part = slice(frame, max(min(use.stop, hands.frames), frame + 1))
    ahead = level(hands.ahead[who, part].mean(axis=0))
    depth = float(shape(BODIES.get(use.kind, use.kind)).vertices[:, 2].max())
    out = float(np.clip(_reach(hands, who)[part].max(), NEAR, FAR))
    pelvis = hands.joint(who, "pelvis")[part].mean(axis=0) * [1, 0, 1]
    place = pelvis + (out + depth) * ahead
    return place + _clear(hands, use.kind, place, -ahead) * ahead, -ahead


def _clear(hands: Hands, kind: str, place: Array, ahead: Array) -> float:
    """The metres by which a fixture at a place moves back so that nobody steps into it; 0 where that does not help."""
    if kind == "door frame":  # people go through it
        return 0.0
    vertices = shape(BODIES.get(kind, kind)).vertices
    low, high = vertices.min(axis=0) - FOOT, vertices.max(axis=0) + FOOT
    across = np.cross([0.0, 1.0, 0.0], ahead)
    legs = hands.positions[:, :, LEGS].reshape(-1, 3) - place
    own = np.stack([legs @ across, legs[:, 1], legs @ ahead], axis=1)
    beside = (own[:, [0, 1]] >= low[[0, 1]]).all(axis=1) & (own[:, [0, 1]] <= high[[0, 1]]).all(axis=1)
    deep = own[beside & (own[:, 2] >= low[2]), 2]
    needed = float(np.max(high[2] - deep, initial=0.0))
    return needed if needed <= BACK else 0.0


def _done(hands: Hands, use: Use, who: int, fixture: Fixture) -> None:
    """Notes what somebody does, and moves the parts if they stand before it."""
    frame = _moment(hands, use, who)
    event: dict[str, Any] = {"act": use.id, "does": use.does, "by": "ab"[who]}
    away = float(np.linalg.norm((hands.joint(who, "pelvis")[frame] - fixture.place)[[0, 2]]))
    if away > FAR + BY:
        fixture.events.append(event | {"at": None, "why": f"{event['by'].upper()} is {away:.1f} m from it"})
        return
    fixture.events.append(event | {"at": round(frame / hands.fps, 2)})
    if use.does in ("opens", "closes"):
        fixture.turned.append((use.kind, frame, use.does == "opens"))
