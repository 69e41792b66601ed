"""From a table of the settings to a method."""

from __future__ import annotations

from webdemo.inference.method import Method

from .classes import class_method
from .entries import Entry
from .released import released_method


def method_of(entry: Entry) -> Method:
    """The method that an entry describes.

    Raises:
        InputError: one sentence on why it cannot be used.
    """
    return class_method(entry) if entry.pipeline else released_method(entry)
