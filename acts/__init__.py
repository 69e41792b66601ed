"""The acts of two people: the plan of a scene, the lexicon of acts, and the reading of sentences into plans.

Importing this package imports no torch and no parser; the parser loads with the first sentence that is read.
"""

from .lexicon import Entry, Lexicon, lexicon
from .plan import Act, Person, Plan, Relation, Span, Unread
from .reading import read

__all__ = ["Act", "Entry", "Lexicon", "Person", "Plan", "Relation", "Span", "Unread", "lexicon", "read"]
