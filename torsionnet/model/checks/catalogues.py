"""Check of catalogue columns that fit no entry, because one is misspelt or of another type of element."""

from __future__ import annotations

from dataclasses import replace

from torsionnet.base.errors import Fault, unfit_word
from torsionnet.base.phrases import phrase
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.element_entries import SIZE
from torsionnet.model.sections import section_class

REMARKS = frozenset({SIZE, "description", "remark", "remarks", "note", "maker", "source"})
"""Names of catalogue columns that are comments and fit no entry."""


def unfit_columns(definition: Definition) -> list[Fault]:
    """Notes on the catalogue columns of each element that neither it nor a limit takes."""
    faults: list[Fault] = []
    for name, element in definition.elements.items():
        if element.catalogue is None:
            continue
        known = {entry for entry, _ in element.specs()}
        names = [cell.column.partition(".")[0] for cell in element.catalogue.cells]
        others = [column for column in dict.fromkeys(names) if column not in known and column.casefold() not in REMARKS]
        limited = _limited() if others else set()
        for column in others:
            if column not in limited:
                said = 'the column "{}" of {} fits no entry of a {} and no limit'
                text = phrase(said, column, element.catalogue.file, element.kind)
                place = ("elements", name, "catalogue")
                faults.append(replace(unfit_word(text, column, [*known, *limited], place), severity="note"))
    return faults


def _limited() -> set[str]:
    return {entry for rule in section_class("limits").values() for entry, _ in rule.specs()}
