"""Wilson intervals and agreement between raters."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence
from itertools import combinations

CONFIDENCE = 0.95


def wilson_interval(wins: int, decided: int) -> tuple[float, float]:
    """The Wilson score interval of a share at 95 %; (0, 1) where nothing was decided."""
    if not decided:
        return 0.0, 1.0
    from scipy.stats import binomtest

    interval = binomtest(wins, decided).proportion_ci(CONFIDENCE, method="wilson")
    return float(interval.low), float(interval.high)


def sign_test(wins: int, decided: int) -> float:
    """The p-value of the exact two-sided binomial test against one half; 1 where nothing was decided."""
    if not decided:
        return 1.0
    from scipy.stats import binomtest

    return float(binomtest(wins, decided).pvalue)


def krippendorff_alpha(units: Sequence[Sequence[Hashable]]) -> float | None:
    """Krippendorff's alpha for nominal data: 1 for full agreement, 0 for that of chance.

    Args:
        units: the values that raters gave to each unit, in any order; missing values are left out.

    Returns:
        None where it is not defined: no unit has two values, or all values are the same.
    """
    paired = [Counter(unit) for unit in units if len(unit) > 1]
    totals = sum(paired, Counter[Hashable]())
    count = sum(totals.values())
    expected = count**2 - sum(n**2 for n in totals.values())
    if not expected:
        return None
    observed = sum(
        (sum(unit.values()) ** 2 - sum(n**2 for n in unit.values())) / (sum(unit.values()) - 1)
        for unit in paired
    )
    return 1.0 - (count - 1) * observed / expected


def pairwise_agreement(units: Sequence[Sequence[Hashable]]) -> float | None:
    """The share of pairs of raters that gave a unit the same value; None where no unit has two values."""
    same = [a == b for unit in units for a, b in combinations(unit, 2)]
    return sum(same) / len(same) if same else None
