"""Pauses of Python's garbage collector of reference cycles.

Reading and checking a large model makes a million small objects that all stay, none in a cycle. The collector goes
through all of them again and again as they become more, which takes a third of the time.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

OBJECTS_BETWEEN_COLLECTIONS = 20_000
"""New objects after which the collector looks for cycles: Python's own 700 cost a document a twentieth of its time, and
this many take a few megabytes."""


@contextmanager
def gc_paused() -> Iterator[None]:
    """Context manager or decorator that pauses the garbage collector of reference cycles.

    >>> with gc_paused():
    ...     gc.isenabled()
    False
    """
    if not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


@contextmanager
def rare_collections() -> Iterator[None]:
    """Context manager in which the garbage collector of reference cycles runs less often, for long calculations.

    >>> with rare_collections():
    ...     gc.get_threshold()[0]
    20000
    """
    before = gc.get_threshold()
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)
