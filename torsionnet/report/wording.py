"""Words of a report replaced by others: a company's own out of its template folder, or another language.

The words that may be replaced are listed once, in ``texts.yaml`` beside this module, those of elements by their types;
the sections know nothing of it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import ClassVar

from torsionnet.base.entries.composite import Named, Nested, Typed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import QuantityKind, Value
from torsionnet.base.entries.spec import Count, EntryError, OneOf, Spec, Text, entry
from torsionnet.base.errors import Fault, ModelError, Position, suggestion_or
from torsionnet.base.number_text import UNBROKEN_PERCENT
from torsionnet.base.phrases import PLACEHOLDER, Phrase
from torsionnet.model.element_base.control_entries import ControlLawEntry
from torsionnet.model.element_base.curves import Characteristic, LookupCurve
from torsionnet.model.element_base.element_entries import MultipleValues, Teeth
from torsionnet.model.element_base.spring_stages import QuantityRows, SpringStages
from torsionnet.model.element_base.stiffness_table import TableEntry
from torsionnet.model.elements import ELEMENT_TYPES
from torsionnet.model.files.located_yaml import compose
from torsionnet.model.overview import has_own_column

# Replacement of a report's texts by other words: a company's own, or another language.

REPORTED_ENTRIES = (QuantityKind, Value, Teeth, Count, OneOf, TableEntry, Characteristic, QuantityRows, LookupCurve)
"""Kinds of entries that a report on a model has a row for; an entry of several values has a row for each."""
LIST_OF_TEXTS = 'the page "A report in your own words" lists them'
"""Words in error messages that say where all replaceable texts are listed."""


@cache
def replaceable_texts() -> Mapping[str, tuple[str, ...]]:
    """Texts of a report that may be replaced, by section."""
    listed = files("torsionnet.report").joinpath("texts.yaml").read_text(encoding="utf-8")
    texts = {section: tuple(map(str, texts)) for section, texts in compose(listed, "texts.yaml").data.items()}
    own = {name for cls in ELEMENT_TYPES.values() for spec in cls.specs() for name in _properties(*spec)}
    return {
        **texts,
        "types of elements": _words(ELEMENT_TYPES),
        "properties of elements": _words(own - set(ELEMENT_TYPES)),
    }


def _properties(name: str, spec: Spec[object]) -> Iterator[str]:
    """Names under which a report shows the values of an entry of the model."""
    if has_own_column(name, spec):
        return
    if isinstance(spec, Nested):
        yield from _nested(name, spec.of())
        return
    if isinstance(spec, Typed):
        for cls in spec.kinds().values():
            yield from _nested(name, cls)
    if isinstance(spec, MultipleValues | SpringStages | ControlLawEntry):
        yield f"{name} {{key}}"
    if not isinstance(spec, MultipleValues | SpringStages):
        yield name


def _nested(name: str, cls: type[Declared]) -> Iterator[str]:
    for inner, of in cls.specs():
        yield from _properties(f"{name}.{inner}", of)


def _words(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(sorted(name.replace("_", " ") for name in names))


@dataclass(frozen=True)
class Wording:
    """Mapping from texts of a report to the words that replace them.

    Examples
    --------
    >>> from torsionnet.base.phrases import phrase
    >>> wording = Wording({"Elements{where}; values": "Teile{where}", " in configuration {name}": " bei {name}"})
    >>> where = phrase(" in configuration {name}", name="V")
    >>> [wording(phrase("Elements{where}; values", where=text)) for text in (where, "")], wording("else")
    (['Teile bei V', 'Teile'], 'else')
    """

    texts: Mapping[str, str] = field(default_factory=dict)
    names: AbstractSet[str] = frozenset()
    """Names of a model, which stay as they are in headings and where they are inserted into a text."""

    def __call__(self, text: str) -> str:
        """Text in the words of the mapping, or as it is where the mapping has no other words.

        What is inserted into a phrase stays as it is, but for phrases of the report.
        """
        if text in self.texts:
            return self.texts[text]
        if not isinstance(text, Phrase):
            return self._said(text) or text
        said = self._said(text.template.replace(UNBROKEN_PERCENT, " %")) or text.template
        return PLACEHOLDER.sub(lambda place: self._inserted(text.values[place[1]]), said)

    def _said(self, text: str) -> str:
        """Words for a text or a template, with a capital letter where it begins a cell; empty where it stays."""
        said = self.texts.get(text[:1].lower() + text[1:], "")
        return self.texts.get(text, said[:1].upper() + said[1:])

    def _inserted(self, value: object) -> str:
        return self(value) if isinstance(value, Phrase) else str(value)


def _unknown(text: str) -> str | None:
    known = [shown for texts in replaceable_texts().values() for shown in texts]
    if text in known:
        return None
    return f'no text of a report is "{text}"{suggestion_or(text, known, LIST_OF_TEXTS)}'


class Language(Text):
    """Language of a report's page by its code, as ``de``."""

    def coerce(self, raw: object) -> str:
        text = super().coerce(raw)
        if not re.fullmatch(r"[A-Za-z]{2,3}(-[A-Za-z0-9]{1,8})*", text):
            raise EntryError(f'a language is a code such as de or pt-BR, got "{text}"', kind="wrong-form")
        return text


@dataclass(frozen=True, eq=False, repr=False)
class Words(Declared):
    """Language and texts that ``words.yaml`` of a template folder gives."""

    kind: ClassVar[str] = "words"
    form: ClassVar[str] = "the entries language, texts"

    language: str = entry(Language("language of the page, such as de or pt-BR"), "en")
    texts: Mapping[str, str] = entry(
        Named("what is said instead of a text", Text("the other words"), _unknown, form="texts by the English ones"),
        None,
    )

    def contradictions(self) -> list[Fault]:
        return [
            Fault(fault, ("texts", text), kind="wrong-form")
            for text, said in (self.texts or {}).items()
            if (fault := _places_fault(set(PLACEHOLDER.findall(text)), set(PLACEHOLDER.findall(said))))
        ]


def _places_fault(needed: set[str], given: set[str]) -> str:
    """Message that the placeholders of the English text and of the other text differ; empty where they agree."""
    if more := sorted(given - needed):
        rest = f"this text has {_braced(needed)}" if needed else "nothing is inserted into this text"
        return f"nothing is inserted at {{{more[0]}}}{suggestion_or(more[0], needed, rest)}"
    return f"{_braced(needed - given)} is missing: the report inserts something there" if needed - given else ""


def _braced(names: set[str]) -> str:
    return ", ".join(f"{{{name}}}" for name in sorted(names))


# Content of a template folder, which holds the letterhead, style and wording of a company.

STYLE = "style.css"
"""Name of the file with the style sheet in a template folder."""


class TemplateFolderError(ModelError):
    """Error that a file in a template folder cannot be used."""

    outcome = "Nothing was written."


@dataclass(frozen=True)
class TemplateFolder:
    """Texts, images, wording and language that a template folder holds.

    Attributes
    ----------
    path : Path
    texts : mapping
        ``page.html``, ``page.tex``, ``page.md`` and ``style.css``, those that are there.
    images : mapping
        Name -> bytes.
    wording : Wording
    language : str
    """

    path: Path = field(default_factory=Path)
    texts: Mapping[str, str] = field(default_factory=dict)
    images: Mapping[str, bytes] = field(default_factory=dict)
    wording: Wording = field(default_factory=Wording)
    language: str = "en"

    def file(self, name: str) -> str:
        """Path of a file of the template folder as messages name it."""
        return str(self.path / name)

    def position(self, name: str, line: int, column: int = 1) -> Position:
        """Position of a fault in one of the template folder's texts, by line and column from 1."""
        lines = self.texts[name].splitlines()
        source = lines[line - 1] if 0 < line <= len(lines) else ""
        first = column if column > 1 else len(source) - len(source.lstrip()) + 1
        return Position(self.file(name), line, first, len(source) + 1 if column == 1 else column + 1, source)
