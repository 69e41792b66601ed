"""Square-root velocity functions: motions as points of a hypersphere (thesis of Chopin, section 2.3.1).

A curve is (…, N, D): N points in D dimensions at times 0, 1/N, 2/N, …. Its SRVF is q = α̇ / √‖α̇‖ (eq. 2.2)
by central differences. Scaled to a curve of length 1 it lies on the unit hypersphere of ⟨p, q⟩ = ∫ p·q dt,
here the mean over the N times of the dot product. A curve that stands still has the SRVF 0, on no sphere.
"""

from __future__ import annotations

from functools import lru_cache

import torch
from torch import Tensor

_TINY = 1e-12
_NEAR_POLE = 1e-4


@lru_cache(maxsize=32)
def _integral(points: int) -> Tensor:
    """(N, N) float64 that turns velocities into positions relative to the first point.

    Central differences of N points hold N − 1 unknowns in N equations; the least-squares solution gives every
    curve back exactly, and spreads the contradictions of velocities that belong to none.
    """
    if points < 2:
        raise ValueError(f"A curve needs two points or more, not {points}.")
    (differences,) = torch.gradient(torch.eye(points, dtype=torch.float64), spacing=1 / points, dim=0)
    first = torch.zeros(1, points, dtype=torch.float64)
    return torch.cat([first, torch.linalg.pinv(differences[:, 1:])])


def velocity(curve: Tensor) -> Tensor:
    """(…, N, D) central differences with time step 1/N; one-sided at the ends."""
    return torch.gradient(curve, spacing=1 / curve.shape[-2], dim=-2)[0]


def inner(p: Tensor, q: Tensor) -> Tensor:
    """(…) inner product ⟨p, q⟩ = ∫ p·q dt of functions (…, N, D)."""
    return (p * q).sum(-1).mean(-1)


def norm(q: Tensor) -> Tensor:
    """(…) norm of functions (…, N, D); its gradient at 0 is 0."""
    return inner(q, q).clamp_min(_TINY**2).sqrt()


def to_srvf(curve: Tensor) -> tuple[Tensor, Tensor]:
    """A curve's point on the hypersphere (eq. 2.2) and the curve's length.

    Args:
        curve: (…, N, D).

    Returns:
        (…, N, D) of norm 1, or 0 if nothing moves; and the length (…), in the curve's unit.
    """
    speed_vector = velocity(curve)
    speed = speed_vector.norm(dim=-1, keepdim=True)
    length = speed.mean(dim=(-2, -1))
    q = speed_vector / speed.clamp_min(_TINY).sqrt()
    scale = length.clamp_min(_TINY).sqrt()[..., None, None]
    return torch.where((length > 1e-9)[..., None, None], q / scale, torch.zeros_like(q)), length


def to_curve(q: Tensor, length: Tensor, start: Tensor) -> Tensor:
    """The curve of an SRVF (eq. 2.3): α(t) = ∫ ‖q‖ q ds + α(0), scaled to a length.

    Args:
        q: (…, N, D) of norm 1.
        length: (…) of the curve.
        start: (…, D), its first point.

    Returns:
        (…, N, D), whose first point is ``start`` exactly.
    """
    speed_vector = q * q.norm(dim=-1, keepdim=True) * length[..., None, None]
    return start[..., None, :] + _integral(q.shape[-2]).to(q) @ speed_vector


def to_tangent(mean: Tensor, s: Tensor) -> Tensor:
    """The part of ``s`` (…, N, D) that is tangent to the sphere at ``mean``."""
    return s - inner(mean, s)[..., None, None] * mean


def exp_map(mean: Tensor, s: Tensor) -> Tensor:
    """exp_μ(s) = cos‖s‖ μ + sin‖s‖ s/‖s‖ (section 2.4.2): tangent vectors (…, N, D) → the sphere."""
    size = norm(s)[..., None, None]
    return torch.cos(size) * mean + torch.sinc(size / torch.pi) * s


def log_map(mean: Tensor, q: Tensor) -> Tensor:
    """log_μ(q) = θ / sin θ · (q − cos θ μ) (section 2.4.2): the inverse of :func:`exp_map`.

    Args:
        mean: (…, N, D) of norm 1.
        q: (…, N, D) of norm 1; opposite to the mean, where no direction is the shortest, any may come out.

    Returns:
        (…, N, D) tangent vectors of norm θ ≤ π.
    """
    cos = inner(mean, q).clamp(-1, 1)
    across = q - cos[..., None, None] * mean
    sin = norm(across)
    angle = torch.atan2(sin, cos)
    ratio = torch.where(sin > _NEAR_POLE, angle / sin, torch.ones_like(sin))
    return ratio[..., None, None] * across


def karcher_mean(q: Tensor, *, tolerance: float = 1e-5) -> Tensor:
    """The point whose summed squared arcs to all others are least (eq. 2.6), by Algorithm 1.

    Args:
        q: (M, N, D) points of the sphere, within a half-sphere.
        tolerance: the algorithm ends where the mean direction is shorter.

    Returns:
        (N, D) of norm 1.
    """
    start = q.mean(dim=0)
    size = norm(start)
    mean = start / size if float(size) > _NEAR_POLE else q[0]
    for _ in range(200):
        direction = to_tangent(mean, log_map(mean, q).mean(dim=0))
        mean = exp_map(mean, 0.9 * direction)
        mean = mean / norm(mean)
        if float(norm(direction)) < tolerance:
            break
    return mean
