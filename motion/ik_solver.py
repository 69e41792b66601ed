"""The solver behind :mod:`motion.ik`: cost, derivatives, pose prior, banded Gauss–Newton."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts are loaded with their first use

from .kinematics import forward_kinematics, global_rotations
from .skeleton import SMPL22, Layout, Skeleton
from .vectors import Array, rotation_vectors, rotations_by

_TURNING = [joint for joint, children in enumerate(SMPL22.children) if children]  # leaves turn nothing
_FREE = np.array(_TURNING[1:])  # turning joints other than the root
_N = 3 * len(_TURNING) + 3  # unknowns a frame: rotations, then the root's translation
_HUBER = 2.5  # residual norm, in units of the noise, from which a joint counts less
MIN_NOISE = 0.0007  # metres
_ROTATION_SPEED = 6.0  # rad/s, the spread of joint rotation speeds; only decides what positions leave open
# m/s², the spread of accelerations in lively motion: of the trunk, of elbows and knees, of hands and feet.
_ACCELERATION = np.full(SMPL22.num_joints, 5.0)
_ACCELERATION[[SMPL22.index(f"{side}_{part}") for side in ("left", "right") for part in ("elbow", "knee")]] = 10.0
_ACCELERATION[[SMPL22.index(f"{side}_{part}") for side in ("left", "right") for part in ("wrist", "ankle", "foot")]] = (
    20.0
)
_HARD = 0.06  # radians, how sharply a joint limit stops


def _pose_prior() -> tuple[Array, Array, Array, Array]:
    """(F, 3) mean, softness, lower and upper limit in radians of the rotation vector of each free joint.

    Hinges in the rest frame: knees flex about +X, the left elbow about −Y and the right about +Y. The means
    are those of a person who stands with hanging arms.
    """
    mean = np.zeros((SMPL22.num_joints, 3))
    soft = np.full((SMPL22.num_joints, 3), 1.5)
    lower = np.full((SMPL22.num_joints, 3), -10.0)
    upper = np.full((SMPL22.num_joints, 3), 10.0)

    def put(name: str, softness: Sequence[float], low: Sequence[float], high: Sequence[float]) -> None:
        soft[SMPL22.index(name)], lower[SMPL22.index(name)], upper[SMPL22.index(name)] = softness, low, high

    for name in ("spine1", "spine2", "spine3"):
        put(name, (0.25, 0.12, 0.12), (-0.35, -0.3, -0.3), (0.7, 0.3, 0.3))
    put("neck", (0.4, 0.3, 0.25), (-0.9, -1.2, -0.7), (0.9, 1.2, 0.7))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        put(f"{side}_collar", (0.2, 0.2, 0.2), (-0.4, -0.5, -0.5), (0.4, 0.5, 0.5))
        put(f"{side}_shoulder", (0.8, 0.8, 0.8), (-1.9, -10, -10), (1.9, 10, 10))
        mean[SMPL22.index(f"{side}_shoulder")] = (0.0, -0.3 * sign, -1.2 * sign)
        bend = sorted((0.05 * sign, -2.7 * sign))
        put(f"{side}_elbow", (0.15, 3.0, 0.15), (-0.3, bend[0], -0.3), (0.3, bend[1], 0.3))
        put(f"{side}_hip", (1.5, 0.6, 0.6), (-2.4, -1.0, -1.2), (0.9, 1.0, 1.2))
        put(f"{side}_knee", (3.0, 0.12, 0.12), (-0.05, -0.3, -0.3), (2.6, 0.3, 0.3))
        put(f"{side}_ankle", (0.4, 0.15, 0.15), (-0.7, -0.4, -0.4), (1.0, 0.4, 0.4))
    return mean[_FREE], soft[_FREE], lower[_FREE], upper[_FREE]


def solve(
    rotations: Array,
    root: Array,
    target: Array,
    trust: Array,
    layout: Layout,
    body: Skeleton,
    noise: float,
    fps: float,
    iterations: int,
) -> tuple[Array, Array]:
    """Gauss–Newton with a damping that grows when a step fails and shrinks when it succeeds."""
    problem = _Problem(target, trust, layout, body, noise, fps)
    state = problem.evaluate(rotations, root)
    damping = 1e-3
    for _ in range(iterations):
        bands, gradient = problem.normal_equations(state)
        for _ in range(4):
            damped = bands.copy()
            damped[0] *= 1 + damping
            try:
                step = -scipy.linalg.solveh_banded(
                    damped, gradient.ravel(), lower=True, overwrite_ab=True, check_finite=False
                )
            except scipy.linalg.LinAlgError:
                damping *= 100
                continue
            tried = problem.step(state, step.reshape(len(target), _N))
            if tried.cost < state.cost:
                break
            damping *= 10
        else:
            break
        gain, state, damping = 1 - tried.cost / state.cost, tried, max(damping / 10, 1e-6)
        if gain < 1e-3 and problem.tolerant:
            break
        if gain < 1e-7:
            break
    return state.rotations, state.root


class _State(NamedTuple):
    rotations: Array  # (T, 22, 3, 3) local
    root: Array  # (T, 3)
    world: Array  # (T, 22, 3, 3)
    positions: Array  # (T, 22, 3)
    cost: float


class _Problem:
    """The terms of the fit and their derivatives for increments exp(δ) R of each local rotation."""

    def __init__(self, target: Array, trust: Array, layout: Layout, body: Skeleton, noise: float, fps: float) -> None:
        self.target, self.seen, self.body = target, layout.observed, body
        self.weights = trust / noise**2
        # A thousandth of the cost is below a millimetre when the noise is centimetres.
        self.tolerant = noise > 3 * MIN_NOISE
        self.mean, self.soft, self.lower, self.upper = _pose_prior()
        frames = len(target)
        second = np.diff(np.eye(frames), n=2, axis=0) if frames > 2 else np.zeros((0, frames))
        penalty = second.T @ second * fps**4
        self.acceleration = [np.diagonal(penalty, -k).copy() for k in range(min(3, frames))]
        self.speed = (fps / _ROTATION_SPEED) ** 2 * 0.05
        self.ankles = [SMPL22.index(f"{side}_ankle") for side in ("left", "right")]
        self.toes = [SMPL22.index(f"{side}_foot") for side in ("left", "right")]
        self.level = self._level_weights() if not set(self.toes) & set(self.seen) else None
        self.pairs = np.array(
            [(turn, joint) for turn in range(len(_TURNING)) for joint in SMPL22.below(_TURNING[turn])]
        )

    def _level_weights(self) -> Array:
        """(T, 2) weights of keeping an unseen foot level: strong while its ankle is low."""
        columns = [self.seen.index(ankle) for ankle in self.ankles if ankle in self.seen]
        if len(columns) < 2:
            return np.full((len(self.target), 2), (1 / 0.1) ** 2)
        height = self.target[:, columns, 1]
        lift = np.maximum(height - np.percentile(height, 10, axis=0), 0)
        return (1 / (0.02 + 0.5 * lift)) ** 2

    def evaluate(self, rotations: Array, root: Array) -> _State:
        world = global_rotations(rotations, self.body.bones)
        positions = forward_kinematics(rotations, root, self.body)
        state = _State(rotations, root, world, positions, 0.0)
        return state._replace(cost=self._cost(state))

    def step(self, state: _State, step: Array) -> _State:
        rotations = state.rotations.copy()
        rotations[:, _TURNING] = rotations_by(step[:, :-3].reshape(len(step), -1, 3)) @ rotations[:, _TURNING]
        return self.evaluate(rotations, state.root + step[:, -3:])

    def _residuals(self, state: _State) -> tuple[Array, Array]:
        """(T, O, 3) data residuals and (T, O) their norms in units of the noise."""
        residual = state.positions[:, self.seen] - self.target
        return residual, np.sqrt(np.sum(self.weights * residual**2, axis=-1))

    def _bends(self, state: _State) -> tuple[Array, Array, Array]:
        """(T, F, 3) rotation vectors of the free joints, how far beyond their limits, and |vector|."""
        bend = rotation_vectors(state.rotations[:, _FREE])
        beyond = np.where(bend < self.lower, bend - self.lower, np.where(bend > self.upper, bend - self.upper, 0))
        return bend, beyond, np.linalg.norm(bend, axis=-1)

    def _turning(self, state: _State) -> Array:
        """(T − 1, F, 3) rotation from each frame to the next of the free joints."""
        local = state.rotations[:, _FREE]
        return rotation_vectors(local[1:] @ np.swapaxes(local[:-1], -1, -2))

    def _curvature(self, state: _State) -> Array:
        """(T, 22, 3) the acceleration penalty's matrix applied to the positions."""
        x = state.positions / _ACCELERATION[:, None] ** 2
        out = self.acceleration[0][:, None, None] * x
        for k, band in enumerate(self.acceleration[1:], start=1):
            out[k:] += band[:, None, None] * x[:-k]
            out[:-k] += band[:, None, None] * x[k:]
        return out

    def _tilt(self, state: _State) -> Array:
        """(T, 2) how far the toes stand above where a level foot has them."""
        drop = self.body.offsets[self.toes, 1]
        return state.positions[:, self.toes, 1] - state.positions[:, self.ankles, 1] - drop

    def _cost(self, state: _State) -> float:
        _, norms = self._residuals(state)
        cost = np.sum(np.where(norms < _HUBER, norms**2, 2 * _HUBER * norms - _HUBER**2))
        bend, beyond, _ = self._bends(state)
        cost += np.sum(((bend - self.mean) / self.soft) ** 2) + np.sum((beyond / _HARD) ** 2)
        cost += self.speed * np.sum(self._turning(state) ** 2)
        cost += np.sum(state.positions * self._curvature(state))
        if self.level is not None:
            cost += np.sum(self.level * self._tilt(state) ** 2)
        return float(cost)

    def _jacobian(self, state: _State) -> Array:
        """(T, 22, 3, N) derivative of every joint by the increments."""
        frames = len(state.root)
        parents = [SMPL22.parents[joint] for joint in _TURNING[1:]]
        frame = np.concatenate([np.broadcast_to(np.eye(3), (frames, 1, 3, 3)), state.world[:, parents]], axis=1)
        turn, joint = self.pairs.T
        arms = state.positions[:, joint] - state.positions[:, np.array(_TURNING)[turn]]
        jacobian = np.zeros((frames, SMPL22.num_joints, 3, _N // 3, 3))
        jacobian[:, joint, :, turn] = np.moveaxis(-_skew(arms) @ frame[:, turn], 1, 0)
        jacobian[..., -1, :] = np.eye(3)
        return jacobian.reshape(frames, SMPL22.num_joints, 3, _N)

    def normal_equations(self, state: _State) -> tuple[Array, Array]:
        """The banded normal matrix (3N, T·N) in LAPACK's lower form, and the gradient (T, N)."""
        frames = len(state.root)
        jacobian = self._jacobian(state)
        flat = jacobian.reshape(frames, -1, _N)
        turned = np.swapaxes(flat, -1, -2)
        spread = np.repeat(1 / _ACCELERATION**2, 3)

        residual, norms = self._residuals(state)
        weights = self.weights * np.minimum(1, _HUBER / np.maximum(norms, 1e-9))[..., None]
        rows = jacobian[:, self.seen].reshape(frames, -1, _N)
        weighted = np.swapaxes(rows, -1, -2) * weights.reshape(frames, 1, -1)
        blocks = np.zeros((frames, 3, _N, _N))
        blocks[:, 0] = weighted @ rows
        gradient = (weighted @ residual.reshape(frames, -1, 1))[..., 0]

        for k, band in enumerate(self.acceleration):
            blocks[: frames - k, k] += band[:, None, None] * ((turned[k:] * spread) @ flat[: frames - k])
        gradient += (turned @ self._curvature(state).reshape(frames, -1, 1))[..., 0]

        bend, beyond, angle = self._bends(state)
        pull = (bend - self.mean) / self.soft**2 + beyond / _HARD**2
        stiff = 1 / self.soft**2 + (beyond != 0) / _HARD**2
        inverse = _left_jacobian_inverse(bend, angle)
        local = np.swapaxes(inverse, -1, -2) @ (stiff[..., None] * inverse)
        index = 3 + 3 * np.arange(len(_FREE))[:, None] + np.arange(3)
        blocks[:, 0, index[:, :, None], index[:, None, :]] += local
        gradient[:, 3:-3] += (np.swapaxes(inverse, -1, -2) @ pull[..., None]).reshape(frames, -1)

        diagonal = np.arange(3, _N - 3)
        turning = self.speed * self._turning(state).reshape(frames - 1, 3 * len(_FREE))
        neighbours = np.full(frames, 2.0) if frames > 1 else np.zeros(frames)
        neighbours[[0, -1]] /= 2
        blocks[:, 0, diagonal, diagonal] += self.speed * neighbours[:, None]
        blocks[:-1, 1, diagonal, diagonal] -= self.speed
        gradient[1:, 3:-3] += turning
        gradient[:-1, 3:-3] -= turning

        if self.level is not None:
            rows = jacobian[:, self.toes, 1] - jacobian[:, self.ankles, 1]
            weighted = np.swapaxes(rows, -1, -2) * self.level[:, None]
            blocks[:, 0] += weighted @ rows
            gradient += (weighted @ self._tilt(state)[..., None])[..., 0]
        return _to_bands(blocks), gradient


def _to_bands(blocks: Array) -> Array:
    """(T, 3, N, N) blocks on and below the diagonal to LAPACK's lower banded form (3N, T·N)."""
    frames, _, size, _ = blocks.shape
    tall = blocks.reshape(frames, 3 * size, size)
    rows = np.arange(3 * size)[:, None] + np.arange(size)[None]
    inside = rows < 3 * size
    bands = tall[:, np.minimum(rows, 3 * size - 1), np.arange(size)[None]] * inside
    return np.ascontiguousarray(bands.transpose(1, 0, 2)).reshape(3 * size, frames * size)


def _skew(vectors: Array) -> Array:
    """(…, 3, 3) cross-product matrices."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*vectors.shape, 3)


def _left_jacobian_inverse(vectors: Array, angle: Array) -> Array:
    """(…, 3, 3) derivative of log(exp(δ) exp(v)) by δ (Solà et al. 2018, "A micro Lie theory", eq. 146)."""
    safe = np.clip(angle, 1e-4, np.pi - 1e-3)
    factor = 1 / safe**2 - (1 + np.cos(safe)) / (2 * safe * np.sin(safe))
    skew = _skew(vectors)
    return np.eye(3) - skew / 2 + factor[..., None, None] * (skew @ skew)
