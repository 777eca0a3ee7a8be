"""Warnings of the package counted instead of shown, whichever thread they come from."""

from __future__ import annotations

import threading
import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from torsionnet.base.errors import TorsionnetWarning

_COLLECTING: ContextVar[Counter[str] | None] = ContextVar("collecting", default=None)
"""Counter of warning texts in the current context, None where warnings are shown as usual."""


class _Collectors:
    """Replacement of ``warnings.showwarning`` while at least one caller collects warnings.

    That way is one for all threads: the first who collects puts the replacement in, the last takes it out.
    """

    def __init__(self) -> None:
        self.lock, self.count = threading.Lock(), 0
        self.before: Any = None

    def enter(self) -> None:
        """Count one more caller that collects warnings; the first one replaces the way they are shown."""
        with self.lock:
            self.count += 1
            if self.count == 1:
                self.before = warnings.catch_warnings()
                self.before.__enter__()
                shown = warnings.showwarning

                def kept(message: Any, category: Any, *where: Any, **more: Any) -> None:
                    collected = _COLLECTING.get()
                    if collected is None or not issubclass(category, TorsionnetWarning):
                        shown(message, category, *where, **more)
                    else:
                        collected[str(message)] += 1

                warnings.showwarning = kept
                warnings.simplefilter("always", TorsionnetWarning)

    def leave(self) -> None:
        """End the collection of one caller; the last caller restores Python's own function for warnings."""
        with self.lock:
            self.count -= 1
            if self.count == 0:
                self.before.__exit__(None, None, None)


_COLLECTORS = _Collectors()


@contextmanager
def collected_warnings(found: Counter[str]) -> Iterator[None]:
    """Context manager that counts the texts of the package's own warnings in ``found``; others are shown as usual.

    >>> texts = Counter()
    >>> with collected_warnings(texts):
    ...     warnings.warn("the response is infinite", TorsionnetWarning)
    >>> texts
    Counter({'the response is infinite': 1})
    """
    _COLLECTORS.enter()
    token = _COLLECTING.set(found)
    try:
        yield
    finally:
        _COLLECTING.reset(token)
        _COLLECTORS.leave()
