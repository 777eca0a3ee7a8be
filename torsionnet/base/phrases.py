"""Sentences with values inserted, which keep their template, so that a report may say them in other words."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache
from typing import Any, Protocol, TypeAlias, cast

PLACEHOLDER = re.compile(r"\{(\w+)\}")
"""Regular expression of the place in a text at which something is inserted, such as ``{name}``."""

FORMATTED = re.compile(r"\{(\w*)(?::([^{}]*))?\}")
"""Regular expression of a place that may have a format, such as ``{share:.3g}``, or no name."""
_split = lru_cache(maxsize=1024)(FORMATTED.split)


class ModelName(str):
    """Name of the model in a message, which the author of a part knows without the prefix of a use."""

    __slots__ = ()

    def in_names(self, own: Callable[[str], str]) -> str:
        """Name as the author of the part knows it."""
        return own(self)


class WithNames(Protocol):
    """Value with names of the model in it, such as an expression."""

    def in_names(self, own: Callable[[str], str], /) -> str:
        """Text of the value with other names."""


Inserted: TypeAlias = str | WithNames
"""Value of a phrase: a text, or something that can be told in other names."""


class Phrase(str):
    """Text of a template with its values inserted, which keeps both; in all else it is a plain ``str``.

    So a report says it in other words, and a part in its own names. Values that are phrases themselves may be said in
    other words too; names and numbers, which are texts, stay.
    """

    __slots__ = ("template", "values")
    template: str
    values: Mapping[str, Inserted]

    def __new__(cls, template: str, values: Mapping[str, Inserted], text: str | None = None) -> Phrase:
        text = PLACEHOLDER.sub(lambda place: str(values[place[1]]), template) if text is None else text
        self = super().__new__(cls, text)
        self.template, self.values = template, values
        return self

    def __str__(self) -> str:
        return self  # so that it passes through what makes a text of any value

    def __getnewargs__(self) -> tuple[str, Mapping[str, Inserted]]:  # type: ignore[override]  # those of a plain str
        return self.template, self.values

    def in_names(self, own: Callable[[str], str]) -> str:
        """Text with other names of the model.

        >>> text = phrase('no {} is named "{}"', "node", ModelName("left.hub"))
        >>> print(text, text.in_names(lambda name: name.removeprefix("left.")), sep="; ")
        no node is named "left.hub"; no node is named "hub"
        """
        return Phrase(self.template, {place: in_names(value, own) for place, value in self.values.items()})


def in_names(text: Inserted, own: Callable[[str], str]) -> str:
    """Text with other names of the model, where it keeps those that are in it."""
    return cast("WithNames", text).in_names(own) if hasattr(text, "in_names") else str(text)


def phrase(template: str, /, *ordered: Any, **named: Any) -> str:
    """Phrase of a template and what is inserted at its places, which may have formats, as those of ``str.format``.

    >>> text = phrase("mode {mode}: {share:.0%} of the energy", mode=3, share=0.9)
    >>> text, text.template, text.values
    ('mode 3: 90% of the energy', 'mode {mode}: {share} of the energy', {'mode': '3', 'share': '90%'})
    """
    values = {**{str(number): value for number, value in enumerate(ordered)}, **named}
    inserted: dict[str, Inserted] = {}
    # Texts, names of places and formats in turn; places without a name are counted from 0.
    plain, *pieces = _split(template)
    text = plain
    for name, form, behind in zip(pieces[::3], pieces[1::3], pieces[2::3], strict=True):
        place = name or str(len(inserted))
        value = values[place]
        # Texts stay as they are, so that phrases among them keep their templates.
        keeps = isinstance(value, str) or hasattr(value, "in_names")
        inserted[place] = value if keeps else format(value, form or "")
        plain += f"{{{place}}}{behind}"
        text += f"{inserted[place]}{behind}"
    return Phrase(plain, inserted, text)


def joined(separator: str, texts: Iterable[str]) -> str:
    """Texts joined as by ``str.join``, of which those that are phrases stay so.

    >>> joined("; ", [phrase("mode {mode}", mode=3), "shaft"]).values
    {'text0': 'mode 3', 'text1': 'shaft'}
    """
    values = {f"text{number}": text for number, text in enumerate(texts)}
    return Phrase(separator.join(f"{{{place}}}" for place in values), values, separator.join(values.values()))


def with_values(text: str, changed: Callable[[str], str]) -> str:
    """Text changed by a function; of a phrase its values are changed, and its template stays.

    >>> with_values(phrase("lead of input_shaft: {name}", name="input_shaft"), str.upper)
    'lead of input_shaft: INPUT_SHAFT'
    """
    if not isinstance(text, Phrase):
        return changed(text)
    return Phrase(text.template, {place: with_values(str(value), changed) for place, value in text.values.items()})


def extended(text: str, end: str) -> str:
    """Text with fixed words behind it, which in a phrase belong to the template.

    >>> extended(phrase("at most {speed} rpm", speed=90), ", reduce power").template
    'at most {speed} rpm, reduce power'
    """
    return Phrase(text.template + end, text.values) if isinstance(text, Phrase) else text + end
