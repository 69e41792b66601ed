"""Blind studies: which motions are compared, how people's answers are counted, and how far they agree."""

from .pairs import Pair, Stimulus, matched_pairs
from .results import Comparison, StudyResult, Vote, tally

__all__ = ["Comparison", "Pair", "Stimulus", "StudyResult", "Vote", "matched_pairs", "tally"]
