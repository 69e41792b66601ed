"""Measures of a set of generated motions, from features of motions and of their sentences.

The protocol of Guo et al., "Generating Diverse and Natural 3D Human Motions from Text" (CVPR 2022), which
InterGen follows (section 5, evaluation metrics). Features come from a contrastive extractor in which the
features of a motion and of its sentence are near each other; distances are Euclidean.

Shapes: N motions, D numbers a feature.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # its parts are loaded with their first use

from motion.vectors import Array


def r_precision(motion: Array, text: Array, *, rng: np.random.Generator, pool: int = 32) -> Array:
    """Motion-to-text retrieval: how often the motion's own sentence is among the nearest of a pool.

    Args:
        motion, text: (N, D), row by row of one pair; N at least ``pool``.
        rng: draws the pools; what does not fill the last pool is left out.
        pool: sentences a motion is compared with, its own among them.

    Returns:
        (3,) share of motions whose sentence ranks at most 1, 2 and 3.

    Raises:
        ValueError: if there are fewer pairs than a pool holds.
    """
    if len(motion) < pool or len(motion) != len(text):
        raise ValueError(f"{len(motion)} motions and {len(text)} sentences do not fill a pool of {pool}.")
    order = rng.permutation(len(motion))
    ranks = []
    for start in range(0, len(order) - pool + 1, pool):
        rows = order[start : start + pool]
        distance = np.linalg.norm(motion[rows, None] - text[None, rows], axis=-1)
        own = np.diagonal(distance)[:, None]
        # A tie counts against the motion, so that constant features score what chance would.
        ranks.append((distance <= own).sum(axis=1) - 1)
    place = np.concatenate(ranks)
    return np.array([(place < k).mean() for k in (1, 2, 3)])


def frechet_distance(first: Array, second: Array) -> float:
    """Fréchet distance of two feature sets (N, D) and (M, D) as Gaussians (FID; Heusel et al. 2017).

    ‖μ₁ − μ₂‖² + Tr(Σ₁ + Σ₂ − 2(Σ₁Σ₂)^½), where the trace of the root is that of the symmetric
    (Σ₁^½ Σ₂ Σ₁^½)^½, which stays real where a covariance is singular.
    """
    first, second = (np.asarray(x, dtype=np.float64) for x in (first, second))
    gap = first.mean(axis=0) - second.mean(axis=0)
    one, two = (np.atleast_2d(np.cov(x, rowvar=False)) for x in (first, second))
    root = _root(one)
    mixed = np.linalg.eigvalsh(root @ two @ root).clip(0)
    return float(gap @ gap + np.trace(one) + np.trace(two) - 2 * np.sqrt(mixed).sum())


def _root(matrix: Array) -> Array:
    values, vectors = np.linalg.eigh(matrix)
    return (vectors * np.sqrt(values.clip(0))) @ vectors.T


def multimodal_distance(motion: Array, text: Array) -> float:
    """Mean distance of each motion's feature to its sentence's, both (N, D)."""
    return float(np.linalg.norm(motion - text, axis=-1).mean())


def diversity(motion: Array, *, rng: np.random.Generator) -> float:
    """Mean distance between the features of 300 random pairs of different motions (N, D)."""
    if len(motion) < 2:
        raise ValueError("Diversity needs two motions or more.")
    first = rng.integers(len(motion), size=300)
    second = (first + rng.integers(1, len(motion), size=300)) % len(motion)
    return float(np.linalg.norm(motion[first] - motion[second], axis=-1).mean())


def multimodality(motion: Array) -> float:
    """Mean distance between motions of one sentence: (sentences, samples, D), samples even, in pairs."""
    half = motion.shape[1] // 2
    if half < 1:
        raise ValueError("Multimodality needs two motions or more of each sentence.")
    return float(np.linalg.norm(motion[:, :half] - motion[:, half : 2 * half], axis=-1).mean())


def interval(values: Sequence[float]) -> tuple[float, float]:
    """Mean of repeats and half the width of its 95 % confidence interval (Student's t); 0 for one repeat."""
    sample = np.asarray(values, dtype=np.float64)
    if len(sample) < 2:
        return float(sample.mean()), 0.0
    width = scipy.stats.t.ppf(0.975, len(sample) - 1) * sample.std(ddof=1) / np.sqrt(len(sample))
    return float(sample.mean()), float(width)


def share(passed: int, count: int) -> str:
    """A share with its 95 % score interval (Wilson, 1927) as text, such as "50 % (1/2; 9–91 %)"; "–" of nothing."""
    if not count:
        return "–"
    bounds = scipy.stats.binomtest(passed, count).proportion_ci(method="wilson")
    return f"{100 * passed / count:.0f} % ({passed}/{count}; {100 * bounds.low:.0f}–{100 * bounds.high:.0f} %)"
