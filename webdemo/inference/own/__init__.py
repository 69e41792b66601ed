"""Models of a lab's own, named in the settings: released checkpoints of the papers, and Python classes.

:mod:`.entries` reads the tables ``[models.NAME]``, :mod:`.released` and :mod:`.classes` turn each into a
:class:`~webdemo.inference.method.Method`, :mod:`.cost` says what a checkpoint takes before it is loaded. No module
here imports torch when it is imported.
"""

from .entries import Entry, read_entries
from .making import method_of

__all__ = ["Entry", "method_of", "read_entries"]
