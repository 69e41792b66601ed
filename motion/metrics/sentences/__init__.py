"""Eighty free-form sentences, each with its own geometric rule, held out of all training.

The sentences and their rules are data (``sentences.json``); :mod:`.language` reads the rules,
and its conditions join the predicates of :mod:`.paths`, :mod:`.poses`, :mod:`.shapes` and :mod:`.touches`.
:mod:`.catalogue` judges a motion and keeps the sentences out of the training captions.
"""

from .catalogue import Judgement, Sentence, kept_out, load_sentences, read_sentences

__all__ = ["Judgement", "Sentence", "kept_out", "load_sentences", "read_sentences"]
