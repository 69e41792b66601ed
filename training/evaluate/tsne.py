"""t-SNE (van der Maaten and Hinton 2008) of a few thousand things of which only the distances are known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]

EXAGGERATION, EXAGGERATED = 12.0, 250
"""Factor on the attraction, and the steps for which it holds, in which clusters form."""


def neighbours(squares: Array, perplexity: float) -> Array:
    """(N, N) probabilities p_ij (eq. 1 and section 3.1) from squared distances (N, N).

    The width of each point's Gaussian is halved towards the one whose perplexity is the given one.
    """
    count = len(squares)
    rest = squares[~np.eye(count, dtype=bool)].reshape(count, count - 1)
    rest = rest - rest.min(1, keepdims=True)
    low, high, beta = (
        np.zeros(count),
        np.full(count, np.inf),
        np.ones(count) / np.maximum(rest.mean(1), 1e-12),
    )
    for _ in range(60):
        shares = np.exp(-rest * beta[:, None])
        total = shares.sum(1)
        entropy = np.log(total) + beta * (rest * shares).sum(1) / total
        wide = entropy > np.log(perplexity)
        low, high = np.where(wide, beta, low), np.where(wide, high, beta)
        beta = np.where(np.isinf(high), 2 * beta, (low + np.minimum(high, 1e300)) / 2)
    found = np.zeros((count, count))
    found[~np.eye(count, dtype=bool)] = (shares / total[:, None]).ravel()
    return (found + found.T) / (2 * count)


def embedded(squares: Array, *, perplexity: float = 30.0, steps: int = 1000, seed: int = 0) -> Array:
    """(N, 2) places whose neighbours are those of the squared distances (N, N).

    Args:
        squares: symmetric; of more points than three times the perplexity.
        perplexity: about the number of neighbours that a point keeps.
        steps: of gradient descent with momentum and gains, as in the paper.
        seed: of the first places.
    """
    wanted = np.maximum(neighbours(squares, perplexity), 1e-12)
    places = 1e-4 * np.random.default_rng(seed).standard_normal((len(squares), 2))
    moved, gains, rate = np.zeros_like(places), np.ones_like(places), max(len(squares) / EXAGGERATION, 50.0)
    for step in range(steps):
        pull = EXAGGERATION if step < EXAGGERATED else 1.0
        norms = np.square(places).sum(1)
        near = 1 / (1 + norms[:, None] + norms - 2 * places @ places.T)
        np.fill_diagonal(near, 0.0)
        forces = (pull * wanted - near / near.sum()) * near
        gradient = 4 * (forces.sum(1)[:, None] * places - forces @ places)
        gains = np.maximum(np.where(gradient * moved < 0, gains + 0.2, 0.8 * gains), 0.01)
        moved = (0.5 if step < EXAGGERATED else 0.8) * moved - rate * gains * gradient
        places = places + moved
    return places - places.mean(0)
