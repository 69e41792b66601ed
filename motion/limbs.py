"""Limbs of two bones that reach for a place, and bodies that move over feet that stay.

People who walk roll over their toes: the heel of a foot that is left behind rises, as a foot that stayed flat until it
swings would pull the body down into a lunge.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # its parts are loaded with their first use

from .skeleton import LEGS, SMPL22
from .smoothing import least_jerk, smoothstep
from .transforms import facing
from .vectors import FLAT, Array, square_to, unit

HIPS = [0, *(leg[0] for leg in LEGS)]
"""The pelvis and both hips."""
UPPER = [joint for joint in range(SMPL22.num_joints) if joint not in {0, *(joint for leg in LEGS for joint in leg)}]
"""Joints above the legs."""
_SINKS, _MOST = 0.06, 0.995
"""Metres by which a body sinks at most, and the share of a leg's length that it reaches."""
_BEHIND = 0.2
"""Metres that a foot is behind its hip from which its heel rises fully."""
_BENT, _STRAIGHT, _STEADY = 0.12, 1e-3, 0.1
"""Metres of a joint beside the line of its limb from which its side is certain, the weight of the side of a straight
limb, and the weight of what was made against least jerk."""
_FOLDED = (0.15, 0.35)
"""Shares of a limb's length between its ends up to which it is folded, and from which it is not."""
_LEANS = 0.03
"""Metres by which the side of a limb leans towards the one to which people bend it."""
_USED = 0.97
"""Share of an arm's length that it uses at most where it bends to a side that is given."""


def solve_two_bones(
    root: Array, middle: Array, end: Array, goal: Array, pole: Array, *, soft: Array | float = 0.0
) -> tuple[Array, Array]:
    """Analytic IK of a limb of two bones.

    The middle joint of a limb that is nearly straight moves by centimetres where its end moves by a millimetre. With
    ``soft`` the last part of the reach is used up ever more slowly, and the limb is never quite straight (Nicholson
    2009, "Soft IK").

    Args:
        root, middle, end: (…, 3) the limb's joints; they give the bone lengths and the plane it bends in.
        goal: (…, 3) where the end should go; out of reach, it is drawn in along the line to the root.
        pole: (…, 3) the direction in which a straight limb bends.
        soft: share of the limb's length before its end that is softened, a number or (…, 1); the goal is missed by
            less than half of it.

    Returns:
        (…, 3) new middle joint, and (…, 3) new end.
    """
    upper = np.linalg.norm(middle - root, axis=-1, keepdims=True)
    lower = np.linalg.norm(end - middle, axis=-1, keepdims=True)
    reach = goal - root
    distance = np.linalg.norm(reach, axis=-1, keepdims=True)
    axis = reach / np.maximum(distance, 1e-9)
    margin = np.maximum(soft * (upper + lower), 1e-9)
    over = distance - (upper + lower - margin)
    distance = np.where(over > 0, upper + lower - margin * np.exp(-over.clip(0) / margin), distance)
    distance = np.clip(distance, np.abs(upper - lower) + 1e-6, upper + lower - 1e-6)
    along = (distance**2 + upper**2 - lower**2) / (2 * distance)
    aside = np.sqrt(np.maximum(upper**2 - along**2, 0.0))
    bend = square_to(middle - root, unit(end - root))
    # What the limb bends more than before goes towards the pole: the direction in which a nearly straight
    # limb bends is noise. A limb that need not bend more keeps its own.
    more = np.maximum(aside - np.linalg.norm(bend, axis=-1, keepdims=True), 0.0)
    side = unit(square_to(bend + more * pole, axis))
    return root + along * axis + aside * side, root + distance * axis


def ankle_moved(person: Array, leg: Sequence[int], goal: Array, pole: Array, *, soft: float = 0.0) -> None:
    """Takes an ankle of a person (…, J, 3) to a goal (…, 3), in place: the knee follows, the foot keeps its way."""
    hip, knee, ankle, toe = leg
    foot = person[..., toe, :] - person[..., ankle, :]
    at, bend, end = (person[..., joint, :] for joint in (hip, knee, ankle))
    person[..., knee, :], person[..., ankle, :] = solve_two_bones(at, bend, end, goal, pole, soft=soft)
    person[..., toe, :] = person[..., ankle, :] + foot


def bent_towards(root: Array, middle: Array, end: Array, goal: Array, pole: Array) -> tuple[Array, Array]:
    """The elbow and the wrist (T, 3) of an arm that reaches for a goal and bends towards a pole, however it bent."""
    upper, lower = (np.linalg.norm(tip - base, axis=-1, keepdims=True) for base, tip in ((root, middle), (middle, end)))
    axis = unit(goal - root)
    reach = np.clip(
        np.linalg.norm(goal - root, axis=-1, keepdims=True), np.abs(upper - lower) + 1e-3, _USED * (upper + lower)
    )
    along = (reach**2 + upper**2 - lower**2) / (2 * reach)
    aside = np.sqrt(np.maximum(upper**2 - along**2, 0.0))
    return root + along * axis + aside * unit(square_to(pole, axis)), root + reach * axis


def across(bone: Array, line: Array) -> Array:
    """(T, 3) the unit direction of a bone across a line (T, 3); 0 where the bone lies along it."""
    out = square_to(bone, unit(line))
    return np.asarray(out / np.maximum(np.linalg.norm(out, axis=-1, keepdims=True), 1e-3))


def steadied(
    root: Array,
    middle: Array,
    end: Array,
    guide: Array,
    pole: Array,
    *,
    free: Array | float = 1.0,
    hinged: bool = False,
) -> Array:
    """(T, 3) the middle joints of a limb, turned about the line between its ends so that they go round it smoothly.

    Where a limb is nearly straight, the side to which it bends is noise, and its middle joint jumps from one side to
    the other. There the side follows from the frames around it, and more and more from the pole.

    Args:
        root, middle, end: (T, 3) the limb's joints.
        guide: (T, 3) where the middle joint was seen, on bones of any length.
        pole: (T, 3) the direction in which a straight limb bends.
        free: (T,) from 1, where the joint may move, to 0, where it stays.
        hinged: the limb bends towards the pole alone, as a knee does: a joint seen on the other side is mirrored.
    """
    axis = unit(end - root)
    own, towards = square_to(middle - root, axis), square_to(pole, axis)
    aside = np.linalg.norm(own, axis=-1, keepdims=True)
    share = np.broadcast_to(np.asarray(free, dtype=np.float64), (len(root),))[:, None]
    share = share * open_limb(root, middle, end)
    out = square_to(guide - root, axis)
    if hinged:
        out += 2 * np.maximum(-np.sum(out * towards, axis=-1, keepdims=True), 0.0) * towards
    out = share * (out + _LEANS * towards) + (1 - share) * own
    length = np.linalg.norm(out, axis=-1, keepdims=True)
    side = out / np.maximum(length, 1e-9)
    sure = np.clip((length[:, 0] / _BENT) ** 2, _STRAIGHT, 1.0) * _STEADY
    side = least_jerk(side, np.where(share[:, 0] > 0, sure, 1e6))
    side = square_to(side, axis)
    certain = np.linalg.norm(side, axis=-1, keepdims=True) > 0.1
    return np.where(certain & (share > 0), middle - own + aside * unit(side), middle)


def open_limb(root: Array, middle: Array, end: Array) -> Array:
    """(…, 1) from 0, where a limb is folded so far that the line between its ends has no direction, to 1."""
    length = np.linalg.norm(middle - root, axis=-1) + np.linalg.norm(end - middle, axis=-1)
    reach = np.linalg.norm(end - root, axis=-1) / np.maximum(length, 1e-9)
    return smoothstep(reach, *_FOLDED)[..., None]


def heel_raised(hip: Array, ankle: Array, toe: Array, leg: Array) -> Array:
    """Places of an ankle, taken up about its toe where a foot behind the hip is out of the leg's reach.

    Args:
        hip, ankle, toe: (T, 3) metres.
        leg: (T, 1) metres that the leg reaches.

    Returns:
        (T, 3) as far from the toe as before; what is in reach, or before the hip, stays.
    """
    short = np.linalg.norm(ankle - hip, axis=-1, keepdims=True) > leg
    if not short.any():
        return ankle
    foot, line = ankle - toe, hip - toe
    length, far = (np.linalg.norm(each, axis=-1, keepdims=True) for each in (foot, line))
    axis = line / np.maximum(far, 1e-9)
    along = np.clip((length**2 + far**2 - leg**2) / np.maximum(2 * far, 1e-9), -length, length)
    out = unit(square_to(foot, axis))
    raised = toe + along * axis + np.sqrt(np.maximum(length**2 - along**2, 0.0)) * out
    ahead = np.sum((hip - ankle) * unit((toe - ankle) * FLAT), axis=-1, keepdims=True)
    turned = ankle + short * smoothstep(ahead / _BEHIND) * (raised - ankle)
    return np.asarray(toe + unit(turned - toe) * length)


def over_planted_feet(own: Array, moved: Array) -> Array:
    """A person whose hips and upper body have moved, on legs that end where they ended before.

    Args:
        own: (T, 22, 3) metres, the person before.
        moved: (T, 22, 3), the same with pelvis, hips and the joints above them elsewhere.

    Returns:
        (T, 22, 3) on bones as long as before; where a leg would not reach, the heel of a foot behind rises, and what
        was moved is lowered, smoothly.
    """
    result = np.array(moved)
    reaches = [_MOST * limb_length(own, leg)[:, None] for leg in LEGS]
    ankles = [
        heel_raised(moved[:, leg[0]], own[:, leg[2]], own[:, leg[3]], reach)
        for leg, reach in zip(LEGS, reaches, strict=True)
    ]
    sunk = scipy.ndimage.gaussian_filter1d(sink([moved[:, leg[0]] for leg in LEGS], ankles, reaches, _SINKS), 2.0)
    result[:, [*UPPER, *HIPS], 1] -= sunk[:, None]
    forward = facing(own)
    for (hip, knee, ankle, toe), goal in zip(LEGS, ankles, strict=True):
        shift = result[:, hip] - own[:, hip]
        bent = own[:, knee] + shift, own[:, ankle] + shift
        result[:, knee], result[:, ankle] = solve_two_bones(result[:, hip], *bent, goal, forward)
        result[:, toe] = result[:, ankle] + own[:, toe] - goal
    return result


def sink(hips: Sequence[Array], ankles: Sequence[Array], reaches: Sequence[Array], most: float) -> Array:
    """(T,) metres, up to ``most``, by which a body goes down so that its legs reach.

    Args:
        hips, ankles: (T, 3) places of each leg's.
        reaches: (T, 1) metres that each leg reaches.
    """
    need = np.zeros(len(hips[0]))
    for hip, ankle, reach in zip(hips, ankles, reaches, strict=True):
        aside = np.linalg.norm((hip - ankle) * FLAT, axis=-1)
        height = np.sqrt(np.maximum(reach[:, 0] ** 2 - aside**2, 0.0))
        need = np.maximum(need, hip[:, 1] - ankle[:, 1] - height)
    return np.minimum(need, most)


def limb_length(person: Array, limb: Sequence[int]) -> Array:
    """(…,) metres of the two bones of a limb of a person (…, J, 3)."""
    root, middle, end = (person[..., joint, :] for joint in limb[:3])
    return np.asarray(np.linalg.norm(middle - root, axis=-1) + np.linalg.norm(end - middle, axis=-1))


def drawn_in(place: Array, root: Array, reach: Array) -> Array:
    """Places (T, 3), drawn in along the line to a limb's root (T, 3) to where the limb reaches, (T,) metres."""
    line = place - root
    far = np.maximum(np.linalg.norm(line, axis=-1), 1e-9)
    return np.asarray(root + line * np.minimum(1.0, reach / far)[:, None])
