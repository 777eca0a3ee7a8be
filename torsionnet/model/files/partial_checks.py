"""Checks of a model that could not be read completely, without faults that only follow from the missing parts."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

from torsionnet.core.errors import Fault, Path, nearest
from torsionnet.model.checks import check_definition, has_errors, names, values
from torsionnet.model.definition import Definition
from torsionnet.model.files.fault_positions import entry_at
from torsionnet.model.files.located_yaml import LocatedDocument
from torsionnet.model.parameters import resolve

_WORD = re.compile(r"[^\W\d]\w*")
_CHECKS = tuple(check for check in names.CHECKS if check is not names.dead_ends)


def check_partial_model(definition: Definition, document: LocatedDocument, faults: list[Fault]) -> list[Fault]:
    """Faults of reading, and faults of the checks that do not depend on entries that could not be read."""
    lost: set[str] = set()
    if has_errors(faults) or document.dropped:
        lost = set(_lost_words(document, [fault.path for fault in faults if fault.severity == "error"]))
        found = list(_sound_checks(definition))
    else:
        found = check_definition(definition)
    # A node inside an element is named after it: engine.ring, shaft.1; and what a part holds after its use.
    told = (fault for fault in found if lost.isdisjoint([fault.about, *fault.about.split(".")]))
    return [*faults, *(_with_hint(fault, lost) for fault in told)]


def _with_hint(fault: Fault, lost: set[str]) -> Fault:
    """Fault with the question whether its name is that of an entry that could not be read, misspelt."""
    meant = "" if fault.kind != "unknown name" or fault.meant else nearest(fault.about, sorted(lost))
    return replace(fault, message=f'{fault.message}; did you mean "{meant}"?', meant=meant) if meant else fault


def _sound_checks(definition: Definition) -> Iterator[Fault]:
    """Faults of names and values in a model that could not be read completely.

    The structure cannot be checked while parts are missing.
    """
    for check in _CHECKS:
        yield from check(definition)
    yield from values.wrong_dimensions(definition)
    yield from values.overlay_dimensions(definition)
    yield from values.bound_dimensions(definition)
    yield from values.passive_tables(definition)
    known, found = resolve(definition.parameters)
    yield from found
    yield from values.impossible_sizes(definition, known)


def _lost_words(document: LocatedDocument, broken: Iterable[Path]) -> Iterator[str]:
    """Names in the entries of a file that could not be read, which may be defined or used there."""
    for path in dict.fromkeys(path[:2] for path in broken):
        yield from _words([*path, entry_at(document.data, path)])
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
            yield entry
            yield from _WORD.findall(entry)
