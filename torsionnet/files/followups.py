"""The checks of a model of which a part could not be read, without the faults that only follow from that."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any

from torsionnet.checks import check_definition, has_errors, names, values
from torsionnet.definition import KEYS, Definition
from torsionnet.errors import Fault, Path
from torsionnet.files.located import Document
from torsionnet.parameters import resolve

_WORD = re.compile(r"[^\W\d]\w*")
_QUOTED = re.compile(r'"([^"]*)"')
_CHECKS = tuple(check for check in names.CHECKS if check is not names.dead_ends)


def check_what_was_read(definition: Definition, document: Document, faults: list[Fault]) -> list[Fault]:
    """The faults of reading and those of the checks that still mean something."""
    if not has_errors(faults) and not document.dropped:
        return [*faults, *check_definition(definition)]
    broken = [fault.path for fault in faults if fault.severity == "error"]
    misspelt = any(path and path[0] not in KEYS for path in broken)
    if misspelt:
        faults = [fault for fault in faults if fault.path != ("elements",) or "elements" in document.data]
    lost = set(_lost_words(document, broken))
    return [
        *faults,
        *(fault for fault in _sound_checks(definition) if not lost & set(_QUOTED.findall(fault.message)[:1])),
    ]


def _sound_checks(definition: Definition) -> Iterator[Fault]:
    """Names and values one by one; whether the parts hang together cannot be told while some are missing."""
    for check in _CHECKS:
        yield from check(definition)
    yield from values.wrong_dimensions(definition)
    yield from values.passive_tables(definition)
    known, found = resolve(definition.parameters)
    yield from found
    yield from values.sizes(definition, known)


def _lost_words(document: Document, broken: Iterable[Path]) -> Iterator[str]:
    """Every name in the entries that could not be read: it may well be defined or used there."""
    for path in broken:
        entry = document.data
        for part in path[:2]:
            entry = entry.get(part) if isinstance(entry, dict) else None
        yield from _words([*path[:2], entry])
    for path, value in document.dropped:
        yield from _words([*path[:2], value])


def _words(value: Any) -> Iterator[str]:
    stack = [value]
    while stack:
        entry = stack.pop()
        if isinstance(entry, dict):
            stack += [*entry, *entry.values()]
        elif isinstance(entry, (list, tuple)):
            stack += entry
        elif isinstance(entry, str):
            yield from _WORD.findall(entry)
