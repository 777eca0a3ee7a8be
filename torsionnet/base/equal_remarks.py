"""Grouping of equal remarks on several limits and configurations, so that each is shown once."""

from __future__ import annotations

import threading
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from torsionnet.base.errors import TorsionnetWarning

MOST_LISTED_CONFIGURATIONS = 3
"""Largest number of configurations that a remark names one by one; beyond, it may name those left out ('all but
...')."""


def grouped_remarks(said: Iterable[tuple[str, str, str]]) -> Iterator[tuple[list[str], list[str], str]]:
    """Yield groups (subjects, configurations, text) of equal remarks, from triples (subject, configuration, text).

    A text occurs once for all subjects that it concerns in the same configurations.

    Examples
    --------
    >>> said = [("tail", "wet", "weak"), ("tail", "dry", "weak"), ("film", "wet", "weak"), ("hub", "wet", "weak")]
    >>> list(grouped_remarks([*said, ("tail", "wet", "worn")]))
    [(['tail'], ['wet', 'dry'], 'weak'), (['film', 'hub'], ['wet'], 'weak'), (['tail'], ['wet'], 'worn')]
    """
    places: dict[str, dict[str, dict[str, None]]] = {}
    for about, configuration, text in said:
        places.setdefault(text, {}).setdefault(about, {})[configuration] = None
    for text, where in places.items():
        by_configurations: dict[frozenset[str], list[str]] = {}
        for about, names in where.items():
            by_configurations.setdefault(frozenset(names), []).append(about)
        for abouts in by_configurations.values():
            yield abouts, list(where[abouts[0]]), text


def configurations_in_words(names: Sequence[str], known: Sequence[str]) -> str:
    """Text that names configurations, such as 'firing=misfire or off', 'all but water=wet', or a list of their names.

    Examples
    --------
    >>> known = [f"water={water},firing={fires}" for water in ("wet", "dry") for fires in ("normal", "misfire", "off")]
    >>> configurations_in_words([name for name in known if "normal" not in name], known)
    'firing=misfire or off'
    >>> configurations_in_words(known[1:], known)
    'all but water=wet,firing=normal'
    >>> configurations_in_words(["misfire", "off"], ["normal", "misfire", "off"])
    'misfire, off'
    """
    rest = [name for name in known if name not in names]
    by_axes = _by_axes(names, known)
    if not by_axes and len(names) > MOST_LISTED_CONFIGURATIONS and 0 < len(rest) < len(names):
        return f"all but {configurations_in_words(rest, known)}"
    return by_axes or ", ".join(names)


def _by_axes(names: Sequence[str], known: Sequence[str]) -> str:
    """Text such as 'firing=misfire or off' if choices on each axis identify the configurations, else an empty text."""
    if not all("=" in part for name in known for part in name.split(",")):
        return ""
    every = _alternatives(known)
    chosen = {axis: kept for axis, kept in _alternatives(names).items() if kept != every[axis]}
    held = [name for name in known if all(_choice(name).get(axis) in kept for axis, kept in chosen.items())]
    return ",".join(f"{axis}={' or '.join(kept)}" for axis, kept in chosen.items()) if set(held) == set(names) else ""


def _alternatives(names: Sequence[str]) -> dict[str, dict[str, None]]:
    """Alternatives that occur in configurations' names, such as misfire, by axis, such as firing, each once."""
    alternatives: dict[str, dict[str, None]] = {}
    for axis, alternative in (pair for name in names for pair in _choice(name).items()):
        alternatives.setdefault(axis, {})[alternative] = None
    return alternatives


def _choice(name: str) -> dict[str, str]:
    pairs = (part.partition("=") for part in name.split(","))
    return {axis: alternative for axis, _, alternative in pairs}


def condition_words(name: str) -> str:
    """Text of a configuration as words, such as 'misfire, wet' for 'firing=misfire,water=wet'.

    Its choices without the names of what is chosen.

    Examples
    --------
    >>> condition_words("water=wet,firing=gas_off"), condition_words("misfire_2")
    ('wet, gas off', 'misfire 2')
    """
    return ", ".join(part.rpartition("=")[2].replace("_", " ") for part in name.split(","))


# Warnings of the package counted instead of shown, whichever thread they come from.

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
def collected_warnings(counts: Counter[str]) -> Iterator[None]:
    """Context manager that counts the texts of the package's own warnings in ``counts``; others are shown as usual.

    >>> texts = Counter()
    >>> with collected_warnings(texts):
    ...     warnings.warn("the response is infinite", TorsionnetWarning)
    >>> texts
    Counter({'the response is infinite': 1})
    """
    _COLLECTORS.enter()
    token = _COLLECTING.set(counts)
    try:
        yield
    finally:
        _COLLECTING.reset(token)
        _COLLECTORS.leave()
