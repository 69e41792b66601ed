"""Models of a lab's own, named in the settings: released checkpoints of the papers, and Python classes.

:mod:`.entries` reads the tables ``[models.NAME]``, :mod:`.released` and :mod:`.classes` turn each into a
:class:`~webdemo.inference.method.Method`. No module here imports torch when it is imported.
"""

from webdemo.inference.method import Method

from .classes import class_method
from .entries import Entry, read_entries
from .released import released_method

__all__ = ["Entry", "method_of", "read_entries"]


def method_of(entry: Entry) -> Method:
    """The method that an entry describes.

    Raises:
        InputError: one sentence on why it cannot be used.
    """
    return class_method(entry) if entry.pipeline else released_method(entry)
