"""Faults of the rest of a model text that is no sound YAML, without those that only follow from the break."""

from __future__ import annotations

import re
from pathlib import Path

from torsionnet.app.text.tolerant_reading import tolerant_document
from torsionnet.base.entries.declared import files_beside
from torsionnet.base.errors import UNKNOWN_NAME, EntryPath, Fault
from torsionnet.base.packages import gc_paused
from torsionnet.model.checks import names
from torsionnet.model.defining import define
from torsionnet.model.files.located_yaml import INDENTATION, NO_COLON, OUTSIDE, STRAY_COLON, LocatedDocument
from torsionnet.model.files.part_includes import include_parts
from torsionnet.model.files.reader import located_faults

_MISPLACED = (INDENTATION, STRAY_COLON, OUTSIDE)
"""Kinds of breaks that leave it open to which section the entries around belong."""


@gc_paused()
def partial_faults(text: str, file: str, folder: Path | None, broken: Fault) -> list[Fault]:
    """Errors in the entries that a break of the YAML does not touch, in the order of the text.

    What may follow from the break is left out: missing sections, whatever its own entry lacks, and names that the
    text has more than once, as one of them may be their definition.
    """
    document = tolerant_document(text, file)
    if not isinstance(document.data, dict) or broken.position is None or "vary" in document.data:
        return []
    line = broken.position.line - 1
    home = _entry_at_line(document, line)
    if broken.kind == NO_COLON:  # it may be the name of a section, which then holds all that follows
        home = home[:1]
    lines = {line, _line_with_text(document, line, -1), _line_with_text(document, line, 1)}
    lost = _lost_sections(document, home) if broken.kind in _MISPLACED else set()
    return [
        fault
        for fault in located_faults(_certain_faults(document, text, folder), document)
        if fault.severity == "error"
        and fault.position is not None
        and fault.position.file == file
        and fault.position.line - 1 not in lines
        and len(fault.path) > 1
        and fault.path[: max(1, len(home))] != home
        and fault.path[0] not in lost
    ]


def _certain_faults(document: LocatedDocument, text: str, folder: Path | None) -> list[Fault]:
    """Faults that an entry has by itself, and those of names that the text has nowhere else."""
    with files_beside(folder):
        include_parts(document)
        definition, faults = define(document.data)
    for fault in (one for check in names.CHECKS for one in check(definition)):
        # The copies that a use makes have names with dots that no text has.
        if fault.kind == UNKNOWN_NAME and "." not in fault.about and _times(fault.about, text) < 2:
            faults.append(fault)
    if definition.authored is not None:
        from torsionnet.model.parts.written_places import at_written_places

        faults = at_written_places(definition, faults)
    return faults


def _times(name: str, text: str) -> int:
    return len(re.findall(rf"(?<!\w){re.escape(name)}(?!\w)", text))


def _lost_sections(document: LocatedDocument, home: EntryPath) -> set[str | int]:
    """Sections into which entries of unclear indentation may have slipped, that of the break and those around it."""
    keys = list(document.root.entries) if document.root else []
    place = keys.index(home[0]) if home else 0
    return set(keys[max(0, place - 1) : place + 2])


def _entry_at_line(document: LocatedDocument, line: int) -> EntryPath:
    """Path of the entry of a section, or of the section, in which a line lies."""
    found: EntryPath = ()
    node = document.root
    while node is not None and len(found) < 2:
        before = [(key, one) for key, one in node.entries.items() if one.key_place and one.key_place[0] <= line]
        if not before:
            return found
        key, node = max(before, key=lambda one: one[1].key_place or ())
        found = (*found, key)
    return found


def _line_with_text(document: LocatedDocument, line: int, step: int) -> int:
    """Number of the next line that is neither empty nor a comment."""
    line += step
    while 0 <= line < len(document.lines) and not document.lines[line].partition("#")[0].strip():
        line += step
    return line
