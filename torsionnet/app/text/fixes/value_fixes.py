"""Quick fixes of values: units, decimal commas, forms of numbers and words."""

from __future__ import annotations

import re
from collections.abc import Iterator

from torsionnet.app.text.fixes.example_values import example_values
from torsionnet.app.text.fixes.fault_place import NUMBER, FaultPlace
from torsionnet.app.text.text_edits import TextEdit, TextFix, TextSpan
from torsionnet.base.errors import BRACKET, DECIMAL_COMMA, IN_UNIT, LEADING_ZERO, QUOTE, UNKNOWN_UNIT, WRITE
from torsionnet.model.files.value_editing import node_at


def number_meant(place: FaultPlace) -> Iterator[TextFix]:
    """Another number where that was probably meant."""
    meant = place.fault.meant
    if NUMBER.match(meant) and NUMBER.match(place.shown.strip("'\"")):
        yield from place.written_as(place.span, meant)


def sign_of_product(place: FaultPlace) -> Iterator[TextFix]:
    """A sign of multiplication before a parameter that was read as a unit."""
    if place.fault.kind != UNKNOWN_UNIT or place.value_span is None:
        return
    name, text = place.fault.about, place.written.text[place.value_span.start : place.value_span.end]
    known = node_at(place.written.document, ("parameters",))
    factor = re.search(rf"(\d)\s+{re.escape(name)}(?!\w)", text)
    if factor and known is not None and name in known.entries:
        start = place.value_span.start + factor.end(1)
        yield from place.fix(
            f"write {factor[1]}*{name}", TextEdit(TextSpan(start, start + factor.end() - factor.end(1)), f"*{name}")
        )


def point_for_comma(place: FaultPlace) -> Iterator[TextFix]:
    """A decimal point, also where a comma in brackets split the number."""
    if place.fault.kind != DECIMAL_COMMA:
        return
    start, text = place.span.start, place.written.text
    found = re.search(r"(\d),(\d)", place.shown)
    before = re.search(r"\d(\s*,\s*)$", text[:start])
    if found:
        comma = start + found.end(1)
        yield from place.fix("write a decimal point", TextEdit(TextSpan(comma, comma + 1), "."))
    elif before:
        yield from place.fix("write a decimal point", TextEdit(TextSpan(before.start(1), start), "."))


def as_said(place: FaultPlace) -> Iterator[TextFix]:
    """Fix that writes what the remedy says, for the whole value or a part of it."""
    remedy = place.remedy(WRITE)
    if remedy is None:
        return
    start = place.written.text.find(remedy.old, place.span.start, place.span.end)
    if not remedy.old:
        yield from place.fix(f"write {remedy.new}", TextEdit(place.span, remedy.new))
    elif remedy.old == place.shown.strip("'\""):
        yield from place.written_as(place.span, remedy.new)
    elif start >= 0:
        span = TextSpan(start, start + len(remedy.old))
        yield from place.fix(f"write {remedy.new}", TextEdit(span, remedy.new))


def without_zeros(place: FaultPlace) -> Iterator[TextFix]:
    if place.fault.kind == LEADING_ZERO:
        zeros = re.match(r"(['\"]?[-+]?)(0+)(?=\d)", place.shown)
        if zeros:
            start = place.span.start
            span = TextSpan(start + zeros.start(2), start + zeros.end(2))
            yield from place.fix("leave the 0 out", TextEdit(span, ""))


def expected_unit_written(place: FaultPlace) -> Iterator[TextFix]:
    """The unit that the remedy expects, with the number as it is."""
    remedy, shown = place.remedy(IN_UNIT), place.shown.strip("'\"")
    number = NUMBER.match(shown)
    if remedy is None or number is None or shown != remedy.old:
        return
    symbol = re.match(r"[A-Za-z]+", remedy.new)
    prefix = re.match(rf"[kMGmµ](?={symbol[0]}(?![a-z]))", shown[number.end() :].strip()) if symbol else None
    # The expected unit alone would be smaller or larger by a power of ten.
    yield from place.written_as(place.span, f"{number[0]} {prefix[0] if prefix else ''}{remedy.new}")


def other_form(place: FaultPlace) -> Iterator[TextFix]:
    """Quotes around a value that is to be text, brackets around one that is to be a list."""
    shown, span = place.shown, place.span
    if place.value_span != span:
        return
    if place.remedy(QUOTE) and shown and '"' not in shown:
        yield from place.fix("put it in quotes", TextEdit(span, f'"{shown}"'))
    if place.remedy(BRACKET):
        yield from place.fix("make it a list", TextEdit(span, f"[{shown}]"))


def value_missing(place: FaultPlace) -> Iterator[TextFix]:
    """An example of a value that is missing behind its name."""
    path = place.fault.path
    if len(path) < 2 or not place.is_empty:
        return
    parent, key = (path, "value") if path[-2] == "parameters" else (path[:-1], str(path[-1]))
    for value in example_values(place.written.document, parent, key):
        fixes = list(place.fix(f"write {place.written.written(value)}", place.written.replacement(path, value)))
        if fixes:
            yield from fixes
            return
