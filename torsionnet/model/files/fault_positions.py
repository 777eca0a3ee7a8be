"""Positions of faults in a file, and selection of one of several faults with the same cause."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from torsionnet.core.errors import Fault, Path
from torsionnet.model.configurations import DEFAULT_AXIS
from torsionnet.model.files.located_yaml import LocatedDocument

LONGEST_MESSAGE = 600
"""Length in characters of the longest message on a fault, of a longer one of which the middle is left out."""

_PLAIN = {"got None": "got nothing", "got True": "got true", "got False": "got false"}
_PYTHON = re.compile("got (None|True|False)$")
_WORD = re.compile(r"[^\W\d]\w*")


def located_faults(faults: Iterable[Fault], document: LocatedDocument) -> list[Fault]:
    """Faults with their positions, in the order of the file, each cause once and each message one printable line."""
    found = [fault if fault.position else _place(_reworded(fault, document), document) for fault in faults]
    return presentable_faults(_without_consequences(found))


def presentable_faults(faults: Iterable[Fault]) -> list[Fault]:
    """Faults without duplicates, in the order of the file, each message one printable line."""
    unique: dict[Any, Fault] = {}
    for fault in faults:
        what, _, _ = fault.message.partition(";")
        unique.setdefault((what, fault.severity, fault.position), replace(fault, message=_one_line(fault.message)))
    return sorted(unique.values(), key=_reading_order)


def _reading_order(fault: Fault) -> tuple[int, int]:
    return (fault.position.line, fault.position.column) if fault.position else (0, 0)


def _one_line(message: str) -> str:
    half = LONGEST_MESSAGE // 2
    message = _PYTHON.sub(lambda found: _PLAIN[found[0]], message)
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


def _path_in_file(fault: Fault, data: Any) -> Path:
    """Path of a fault's entry as the file spells it: the name of a single axis may be left out there."""
    path = fault.path
    if fault.configuration and path[:1] != ("configurations",):
        path = _alternative(fault.configuration, fault.message, data) or path
    table = entry_at(data, ("configurations",))
    if path[:2] == ("configurations", DEFAULT_AXIS) and isinstance(table, Mapping) and DEFAULT_AXIS not in table:
        return ("configurations", *path[2:])
    return path


def _alternative(label: str, message: str, data: Any) -> Path:
    """Path of the alternative that causes a fault of a configuration, or of the change that the message names."""
    table = entry_at(data, ("configurations",))
    for part in reversed(label.split(",")):
        axis, _, name = part.rpartition("=")
        for path in [(axis, name)] if axis else [(name,), *((outer, name) for outer in table)]:
            changes = entry_at(table, path)
            if isinstance(changes, Mapping):
                named = [word for word in _WORD.findall(message) if word in changes]
                return ("configurations", *path, *named[:1])
    return ()


def entry_at(data: Any, path: Path) -> Any:
    """Entry at a path in the plain data of a file, None if there is none."""
    for part in path:
        if isinstance(data, Mapping):
            data = data.get(part)
        elif isinstance(data, list) and isinstance(part, int) and part < len(data):
            data = data[part]
        else:
            return None
    return data


def _reworded(fault: Fault, document: LocatedDocument) -> Fault:
    """Fault of a decimal comma instead of an unknown key, where a flow mapping split the number."""
    if not fault.path or fault.kind != "unknown key" or not str(fault.path[-1])[:1].isdigit():
        return fault
    key, entries = str(fault.path[-1]), entry_at(document.data, fault.path[:-1])
    names = list(entries) if isinstance(entries, Mapping) else []
    before = entries[names[names.index(key) - 1]] if names.index(key) else None
    if entries.get(key) is not None or not isinstance(before, int):
        return fault
    return replace(fault, message=f'"{before},{key}" has a decimal comma; write {before}.{key}')


def _without_consequences(faults: list[Fault]) -> list[Fault]:
    """Faults without those that a key is missing which is only misspelt."""
    meant = {(fault.path[:-1], fault.meant) for fault in faults if fault.kind == "unknown key"}
    return [fault for fault in faults if fault.kind != "missing key" or (_parent(fault), fault.about) not in meant]


def _parent(fault: Fault) -> Path:
    """Path of the entry that lacks the missing key of a fault."""
    return fault.path if fault.path != (fault.about,) else ()
