"""Furniture of a finished motion: seats under people who sit, tables, door frames, and fixtures with parts that open.

A window, a door or a hi-fi stands before the person who uses it, and its parts open and close."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from acts.staging.places import AT_TABLE
from motion import SMPL22
from motion.metrics.sentences.joints import stretches
from motion.smoothing import smoothstep
from motion.things import FIXTURES, Thing, kinds, shape
from motion.things.hands import Hands, level, smoothed
from motion.transforms import heading_matrix
from motion.vectors import FLAT, Array, heading_of, left_of

from .uses import Use

UNDER_HIP = 0.095
"""Metres from the joints of the hips down to the seat, of a person who sits."""
LOWEST, HIGHEST = 0.28, 0.75
"""Heights in metres between which a seat can be; people who are lower sit on the floor."""
_BESIDE = 1.6
"""Metres between two people, at most, who share a bench."""
_BACK = 0.06
"""Metres by which the middle of a seat lies before the pelvis."""

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
_HALF = kinds.CURTAIN / 2 + 0.01
_SWUNG = np.radians(105.0)


# ---- seats, tables and door frames -----------------------------------------------------------------------
def seated(hands: Hands, person: int, start: int, stop: int) -> tuple[int, int] | None:
    """The frames of the longest rest with the hips at the height of a seat and the knees bent, or None.

    ``start`` and ``stop`` are those of the act; people stay seated beyond it.
    """
    hips = (hands.joint(person, "left_hip") + hands.joint(person, "right_hip")) / 2
    knees = np.minimum(hands.joint(person, "left_knee")[:, 1], hands.joint(person, "right_knee")[:, 1])
    low = (hips[:, 1] - UNDER_HIP < HIGHEST) & (hips[:, 1] - UNDER_HIP > LOWEST)
    bent = hips[:, 1] - knees < 0.25  # the thighs are nearly level
    still = np.linalg.norm(np.gradient(hips, axis=0), axis=1) * hands.fps < 0.35
    rests = [
        (i, j) for i, j in stretches(low & bent & still, hands.fps, pause=0.3) if j > start and i < stop + hands.fps
    ]
    if not rests:
        return None
    best = max(rests, key=lambda each: each[1] - each[0])
    return best if best[1] - best[0] >= 0.4 * hands.fps else None


def furniture(hands: Hands, uses: Sequence[Use]) -> Iterator[tuple[Use, tuple[int, ...], Thing]]:
    """The seats, tables and door frames of some uses, each with the people whom it is for."""
    taken: set[tuple[int, int]] = set()
    for use in uses:
        if use.does == "passes":
            yield from _doors(hands, use)
        if use.does != "sits":
            continue
        rests = {who: rest for who in use.agents if (rest := seated(hands, who, use.start, use.stop))}
        rests = {who: rest for who, rest in rests.items() if (who, rest[0]) not in taken}
        taken |= {(who, rest[0]) for who, rest in rests.items()}
        spots = {who: _spot(hands, who, rest) for who, rest in rests.items()}
        kind = use.kind or "chair"
        if len(spots) == 2 and kind == "bench" and (shared := _shared(hands, use, spots)):
            yield use, tuple(spots), shared
        else:
            for who, (hips, ahead, height) in spots.items():
                yield use, (who,), _seat(kind, use.name, hips, ahead, height, hands.frames)
        if use.on and spots:
            yield from _tables(hands, use, spots)


Spot = tuple[Array, Array, float]
"""The place where hips rest (3,), the way they face (3,), and the height of a seat under them."""


def _spot(hands: Hands, person: int, rest: tuple[int, int]) -> Spot:
    part = slice(*rest)
    hips = ((hands.joint(person, "left_hip") + hands.joint(person, "right_hip")) / 2)[part]
    knees = ((hands.joint(person, "left_knee") + hands.joint(person, "right_knee")) / 2)[part]
    ahead = level(np.median(knees - hips, axis=0))
    return np.median(hips, axis=0), ahead, float(np.percentile(hips[:, 1], 20) - UNDER_HIP)


def _seat(kind: str, name: str, hips: Array, ahead: Array, height: float, frames: int) -> Thing:
    place = hips + _BACK * ahead
    yaw = heading_of(ahead)
    if kind == "bed":  # people sit on its side
        place, yaw = place - 0.3 * ahead, yaw - np.pi / 2
    return Thing.at_rest(kind, shape(kind, height=round(height, 2)), place * FLAT, yaw, frames, name)


def _shared(hands: Hands, use: Use, spots: dict[int, Spot]) -> Thing | None:
    """One bench for two who sit beside each other."""
    (one, one_ahead, low), (other, other_ahead, high) = spots.values()
    gap = float(np.linalg.norm((other - one)[[0, 2]]))
    ahead = level(one_ahead + other_ahead)
    across = abs(float((other - one) @ ahead))
    if gap > _BESIDE or one_ahead @ other_ahead < 0.7 or across > 0.3:
        return None
    width = round(min(max(gap + 0.8, 1.3), 2.6), 1)
    place = ((one + other) / 2 + _BACK * ahead) * FLAT
    mesh = shape("bench", height=round(min(low, high), 2), width=width)
    return Thing.at_rest("bench", mesh, place, heading_of(ahead), hands.frames, use.name)


def _tables(hands: Hands, use: Use, spots: dict[int, Spot]) -> Iterator[tuple[Use, tuple[int, ...], Thing]]:
    """One table between two who face each other across less than two metres, or one before each."""
    pairs = list(spots.values())
    if len(pairs) == 2 and pairs[0][1] @ pairs[1][1] < -0.5:
        gap = float(np.linalg.norm((pairs[0][0] - pairs[1][0])[[0, 2]]))
        if gap < 2.4:
            middle = (pairs[0][0] + pairs[1][0]) / 2 * FLAT
            mesh = shape("table", width=round(max(min(1.2, (gap - 0.7) / 0.9), 0.5), 2))
            yield use, tuple(spots), Thing.at_rest("table", mesh, middle, heading_of(pairs[0][1]), hands.frames)
            return
    for who, (hips, ahead, _) in spots.items():
        place = (hips + AT_TABLE * ahead) * FLAT
        yield use, (who,), Thing.at_rest(use.on, shape(use.on), place, heading_of(-ahead), hands.frames)


def _doors(hands: Hands, use: Use) -> Iterator[tuple[Use, tuple[int, ...], Thing]]:
    """A door frame half way along the path of the person who goes furthest."""
    part = slice(use.start, max(use.stop, use.start + 1))
    ways = {who: hands.joint(who, "pelvis")[part] for who in use.agents}
    who = max(ways, key=lambda person: float(np.linalg.norm((ways[person][-1] - ways[person][0])[[0, 2]])))
    way = ways[who]
    ahead = way[-1] - way[0]
    if np.linalg.norm(ahead[[0, 2]]) < 1.0:
        return
    middle = way[int(np.linalg.norm((way - way[0])[:, [0, 2]], axis=1).searchsorted(np.linalg.norm(ahead[[0, 2]]) / 2))]
    door = Thing.at_rest(
        "door frame", shape("door frame"), middle * FLAT, heading_of(level(ahead)), hands.frames, "door"
    )
    yield use, use.agents, door


# ---- fixtures --------------------------------------------------------------------------------------------
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
                (-side * kinds.PANE_WIDTH, kinds.SILL, 0.0, hinge),
                (-side * kinds.PANE_WIDTH, kinds.SILL, 0.0, hinge + side * _SWUNG),
            )
            for side, hinge in ((1, 0.0), (-1, np.pi))
        ),
        *(
            Leaf("curtain", "curtain", (side * _HALF, 0.0, 0.14, 0.0), (side * 3.1 * _HALF, 0.0, 0.14, 0.0), True)
            for side in (-1, 1)
        ),
    ),
    "door frame": (
        Leaf("door", "door frame", (-kinds.DOOR_WIDTH / 2, 0.0, 0.0, 0.0), (-kinds.DOOR_WIDTH / 2, 0.0, 0.0, _SWUNG)),
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
        yield Thing.at_rest(self.kind, shape(self.kind), self.place, heading_of(self.ahead), frames, self.name)
        for leaf in LEAVES.get(self.kind, ()):
            yield placed_leaf(leaf, self.place, heading_of(self.ahead), self._open(leaf, frames, fps))

    def _open(self, leaf: Leaf, frames: int, fps: float) -> Array:
        """(T,) how far a part is open, 0 to 1."""
        moments = [(frame, opens) for kind, frame, opens in self.turned if kind == leaf.moved_by]
        first = not moments[0][1] if moments else leaf.is_open
        share = np.full(frames, float(first))
        for frame, opens in moments:
            now = smoothstep((np.arange(frames) - frame) / (TAKES * fps))
            share += now * (float(opens) - share)
        return share


def placed_leaf(leaf: Leaf, place: Array, yaw: float | Array, share: Array) -> Thing:
    """A moving part of a fixture at ``place`` (3,) turned by ``yaw``, open by a share (T,)."""
    x, y, z, turn = ((1 - share) * shut + share * wide for shut, wide in zip(leaf.closed, leaf.opened, strict=True))
    places = np.stack([x, y, z], axis=1) @ heading_matrix(yaw).T + place
    return Thing(leaf.kind, shape(leaf.kind), places, heading_matrix(yaw + turn))


def fixtures(hands: Hands, uses: Sequence[Use]) -> list[Fixture]:
    """The fixtures of some uses: one of each kind, where somebody first does something with it."""
    by_kind: dict[str, Fixture] = {}
    ours = [use for use in uses if use.does in ("faces", "opens", "closes") and use.kind in FIXTURES]
    for use in sorted(ours, key=lambda use: use.does == "faces"):  # hands say best where it is
        kind = BODIES.get(use.kind, use.kind)
        if kind not in by_kind:
            by_kind[kind] = Fixture(kind, kind if kind != use.kind else use.name, *_place(hands, use, use.agents[0]))
    for use in ours:
        fixture = by_kind[BODIES.get(use.kind, use.kind)]
        for who in use.agents:
            _use(hands, use, who, fixture)
    return list(by_kind.values())


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


def _place(hands: Hands, use: Use, who: int) -> tuple[Array, Array]:
    """The place of a fixture before a person who uses it, and the direction of its front."""
    frame = _moment(hands, use, who)
    part = slice(frame, max(min(use.stop, hands.frames), frame + 1))
    ahead = level(hands.ahead[who, part].mean(axis=0))
    depth = float(shape(BODIES.get(use.kind, use.kind)).vertices[:, 2].max())
    out = float(np.clip(_reach(hands, who)[part].max(), NEAR, FAR))
    pelvis = hands.joint(who, "pelvis")[part].mean(axis=0) * FLAT
    place = pelvis + (out + depth) * ahead
    return place + _clear(hands, use.kind, place, -ahead) * ahead, -ahead


def _clear(hands: Hands, kind: str, place: Array, ahead: Array) -> float:
    """The metres by which a fixture at a place moves back so that nobody steps into it; 0 where that does not help."""
    if kind == "door frame":  # people go through it
        return 0.0
    vertices = shape(BODIES.get(kind, kind)).vertices
    low, high = vertices.min(axis=0) - FOOT, vertices.max(axis=0) + FOOT
    across = left_of(ahead)
    legs = hands.positions[:, :, LEGS].reshape(-1, 3) - place
    own = np.stack([legs @ across, legs[:, 1], legs @ ahead], axis=1)
    beside = (own[:, [0, 1]] >= low[[0, 1]]).all(axis=1) & (own[:, [0, 1]] <= high[[0, 1]]).all(axis=1)
    deep = own[beside & (own[:, 2] >= low[2]), 2]
    needed = float(np.max(high[2] - deep, initial=0.0))
    return needed if needed <= BACK else 0.0


def _use(hands: Hands, use: Use, who: int, fixture: Fixture) -> None:
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
