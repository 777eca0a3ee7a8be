"""Faults of a model file at their places, each cause once, and checks of a model that could not be read completely.

Needed where a file has faults: one that is sound is read without.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from torsionnet.base.errors import UNKNOWN_NAMES, EntryPath, Fault, ModelError, nearest, question, unreadable_file
from torsionnet.base.phrases import phrase
from torsionnet.base.units import misread
from torsionnet.model.checks import names, values
from torsionnet.model.configurations import DEFAULT_AXIS
from torsionnet.model.definition import Definition
from torsionnet.model.files.library import decode
from torsionnet.model.files.located_yaml import LocatedDocument, compose
from torsionnet.model.parameters import resolve

LONGEST_MESSAGE = 600
"""Length in characters of the longest message on a fault, of a longer one of which the middle is left out."""


def located_faults(faults: Iterable[Fault], document: LocatedDocument) -> list[Fault]:
    """Faults with their positions, in the order of the file, each cause once and each message one printable line."""
    placed = [fault if fault.position else _place(_reworded(fault, document), document) for fault in faults]
    # That a key is missing which is only misspelt follows from that.
    meant = {(fault.path[:-1], fault.meant) for fault in placed if fault.kind == "unknown-entry" and fault.meant}
    return presentable_faults(
        fault for fault in placed if fault.kind != "missing-entry" or (_parent(fault), fault.about) not in meant
    )


def presentable_faults(faults: Iterable[Fault]) -> list[Fault]:
    """Faults without duplicates, in the order of the file, each message one printable line."""
    unique: dict[Any, Fault] = {}
    for fault in faults:
        what = (fault.kind, fault.about) if fault.kind and fault.about else fault.message
        unique.setdefault((what, fault.severity, fault.position), replace(fault, message=_one_line(fault.message)))
    return sorted(unique.values(), key=_reading_order)


def read_document(file: Path) -> LocatedDocument:
    """Content of a YAML file, with the places of its entries.

    Raises
    ------
    ModelError
        With every fault of its syntax.
    UsageError
        There is no such file.
    """
    try:
        return compose(decode(file.read_bytes(), str(file)).removeprefix("\ufeff"), str(file))
    except OSError as error:
        raise unreadable_file(file, error) from None
    except ModelError as error:
        raise ModelError(presentable_faults(error.faults), file.name) from None


def _reading_order(fault: Fault) -> tuple[int, int]:
    return (fault.position.line, fault.position.column) if fault.position else (0, 0)


def _one_line(message: str) -> str:
    half = LONGEST_MESSAGE // 2
    short = message if len(message) <= LONGEST_MESSAGE else f"{message[:half]} ... {message[-half:]}"
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in short)


def _place(fault: Fault, document: LocatedDocument) -> Fault:
    path = _path_in_file(fault, document.data)
    position = document.position(path, on_key=fault.on_key)
    fault = replace(
        fault,
        used_at=tuple(document.position(use, on_key=True) for use in fault.uses),
        defined_at=document.position(fault.defined, on_key=True) if fault.defined else None,
    )
    about_the_whole = not path and fault.severity != "error"
    return fault.at(replace(position, source="") if about_the_whole else position)


def _path_in_file(fault: Fault, data: Any) -> EntryPath:
    """Path of a fault's entry as the file spells it: the name of a single axis may be left out there."""
    path = fault.path
    if fault.configuration and path[:1] != ("configurations",):
        path = _alternative(fault, data) or path
    table = entry_at(data, ("configurations",))
    if path[:2] == ("configurations", DEFAULT_AXIS) and isinstance(table, Mapping) and DEFAULT_AXIS not in table:
        return ("configurations", *path[2:])
    return path


def _alternative(fault: Fault, data: Any) -> EntryPath:
    """Path of the alternative that causes a fault of a configuration, or of the change in it that does."""
    table = entry_at(data, ("configurations",))
    for part in reversed(fault.configuration.split(",")):
        axis, _, name = part.rpartition("=")
        for path in [(axis, name)] if axis else [(name,), *((outer, name) for outer in table)]:
            changes = entry_at(table, path)
            if isinstance(changes, Mapping):
                changed = [key for key in changes if key in fault.causes]
                return ("configurations", *path, *changed[:1])
    return ()


def entry_at(data: Any, path: EntryPath) -> Any:
    """Entry at a path in the plain data of a file, None if there is none."""
    for part in path:
        if isinstance(data, Mapping):
            data = data.get(part)
        elif isinstance(data, list) and isinstance(part, int) and part < len(data):
            data = data[part]
        else:
            return None
    return data


_UNKNOWN_KEYS = ("unknown-entry", "invalid-name")


def _reworded(fault: Fault, document: LocatedDocument) -> Fault:
    """Fault of a comma in a number instead of an unknown key or name, where a flow mapping split the number."""
    if not fault.path or fault.kind not in _UNKNOWN_KEYS or not str(fault.path[-1])[:1].isdigit():
        return fault
    key, entries = str(fault.path[-1]), entry_at(document.data, fault.path[:-1])
    names = list(entries) if isinstance(entries, Mapping) else []
    before = entries[names[names.index(key) - 1]] if key in names[1:] else None
    if not isinstance(before, int) or entries.get(key) is not None:
        return fault
    return replace(misread(f"{before},{key}"), path=fault.path, on_key=True)


def _parent(fault: Fault) -> EntryPath:
    """Path of the entry that lacks the missing key of a fault."""
    return fault.path if fault.path != (fault.about,) else ()


_WORD = re.compile(r"[^\W\d]\w*")


def check_partial_model(definition: Definition, document: LocatedDocument, faults: list[Fault]) -> list[Fault]:
    """Faults of reading, and faults of the checks that do not depend on entries that could not be read."""
    lost = set(_lost_words(document, [fault.path for fault in faults if fault.severity == "error"]))
    findings = list(_sound_checks(definition))
    # A node inside an element is named after it: engine.ring, shaft.1; and what a part holds after its use.
    told = (fault for fault in findings if lost.isdisjoint([fault.about, *fault.about.split(".")]))
    return [*faults, *(_with_hint(fault, lost) for fault in told)]


def _with_hint(fault: Fault, lost: set[str]) -> Fault:
    """Fault with the question whether its name is that of an entry that could not be read, misspelt."""
    meant = "" if fault.kind not in UNKNOWN_NAMES or fault.meant else nearest(fault.about, sorted(lost))
    return replace(fault, message=phrase("{}{}", fault.message, question(meant)), meant=meant) if meant else fault


def _sound_checks(definition: Definition) -> Iterator[Fault]:
    """Faults of names and values in a model that could not be read completely.

    The structure cannot be checked while parts are missing.
    """
    for check, of in names.CHECKS.items():
        if check is not names.dead_ends and (not of or getattr(definition, of)):
            yield from check(definition)
    yield from values.wrong_dimensions(definition)
    yield from values.parameter_dimensions(definition)
    yield from values.passive_tables(definition)
    known, wrong = resolve(definition.parameters)
    yield from wrong
    yield from values.impossible_sizes(definition, known)


def _lost_words(document: LocatedDocument, broken: Iterable[EntryPath]) -> Iterator[str]:
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
