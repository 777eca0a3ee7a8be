"""Faults of a model text with their places, as the rules of quick fixes look at them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from torsionnet.app.text.entry_edits import WrittenText
from torsionnet.app.text.text_edits import TextEdit, TextFix, TextSpan, edited
from torsionnet.base.entries.composite import Named
from torsionnet.base.errors import GIVEN_TWICE, Fault, ModelError, Remedy
from torsionnet.model.definition import Definition
from torsionnet.model.files.located_yaml import LocatedDocument, compose
from torsionnet.model.files.value_editing import node_at

NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
"""Expression of a decimal number."""


@dataclass(frozen=True)
class FaultPlace:
    """Fault of a model text with its stretch, as the rules of fixes look at it."""

    fault: Fault
    span: TextSpan
    written: WrittenText
    others: Sequence[Fault] = ()

    @property
    def shown(self) -> str:
        """Text that the fault marks."""
        return self.written.text[self.span.start : self.span.end]

    def remedy(self, how: str) -> Remedy | None:
        """Remedy of the fault if it is of that kind, else None."""
        remedy = self.fault.remedy
        return remedy if remedy is not None and remedy.how == how else None

    @cached_property
    def value_span(self) -> TextSpan | None:
        """Stretch of the value at the path of the fault, None where there is none."""
        node = node_at(self.written.document, self.fault.path)
        return self.written.value_span(node) if node is not None and self.fault.path else None

    @property
    def element_type(self) -> object:
        """Value of the entry ``type`` beside the one of the fault, None where there is none."""
        return getattr(node_at(self.written.document, (*self.fault.path[:-1], "type")), "value", None)

    @property
    def is_empty(self) -> bool:
        """Whether the fault is that the entry at its path has no value."""
        node = node_at(self.written.document, self.fault.path)
        return node is not None and node.value is None and not self.fault.on_key and self.fault.kind != GIVEN_TWICE

    def fix(self, title: str, *edits: TextEdit) -> Iterator[TextFix]:
        """Fix by some edits, if reading the changed entry finds nothing new."""
        if edits and self._mends(edits):
            yield TextFix(title, edits)

    def written_as(self, span: TextSpan, new: str) -> Iterator[TextFix]:
        """Fix that writes another value, in the quotes of the one there."""
        old = self.written.text[span.start : span.end]
        if old[:1] in ("'", '"') and old[:1] == old[-1:] and not new.startswith(old[0]):
            new = f"{old[0]}{new}{old[0]}"
        elif self.written.is_json and not NUMBER.fullmatch(new) and new not in ("true", "false"):
            new = self.written.written(new)
        yield from self.fix(f"write {new}", TextEdit(span, new))

    def without(self, *paths: tuple[str | int, ...]) -> Iterator[TextFix]:
        """Fixes that delete entries, one for each path."""
        for path in paths:
            if node_at(self.written.document, path) is not None and path:
                yield from self.fix(f'delete "{path[-1]}"', *self.written.removal(path))

    def _mends(self, edits: tuple[TextEdit, ...]) -> bool:
        try:
            document = compose(edited(self.written.text, edits).removeprefix("\ufeff"), self.written.document.file)
        except (ModelError, ValueError):
            return False
        before, after = self._faults_read, section_faults(document, self.fault)
        return after <= before and (after < before or _bare(self.fault) not in before)

    @cached_property
    def _faults_read(self) -> set[Fault]:
        return section_faults(self.written.document, self.fault)


def section_faults(document: LocatedDocument, fault: Fault) -> set[Fault]:
    """Faults, without their places, in reading the section of a fault, or the one entry of it that it is about."""
    data = document.data
    section = fault.path[0] if fault.path else ""
    specs = dict(Definition.specs())
    found = {_bare(one) for one in document.faults}
    if isinstance(data, dict) and (section not in specs or section not in data):
        return found | {_bare(one) for one in Definition.key_faults(data)}
    if not isinstance(data, dict):
        return found
    raw, spec = data[section], specs[str(section)]
    if isinstance(spec, Named) and isinstance(raw, dict) and len(fault.path) > 1:
        name = fault.path[1]
        raw = {name: raw[name]} if name in raw else {}
        if not raw:
            return found
    return found | {_bare(one) for one in spec.read(raw)[1]}


def _bare(fault: Fault) -> Fault:
    """Fault without its place, which an edit before it moves."""
    return replace(fault, path=(), position=None)


def word_edits(word: str, text: str, start: int, new: str) -> Iterator[TextEdit]:
    """Edits that replace a word where it stands alone."""
    for one in re.finditer(rf"(?<![\w.]){re.escape(word)}(?![\w])", text):
        yield TextEdit(TextSpan(start + one.start(), start + one.end()), new)
