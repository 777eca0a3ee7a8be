"""Quick fixes of values: units, decimal commas, forms of numbers and words."""

from __future__ import annotations

import re
from collections.abc import Iterator

from torsionnet.model.files.value_editing import node_at
from torsionnet.text.fixes.example_values import example_values
from torsionnet.text.fixes.fault_place import MEANT, NUMBER, QUOTED, FaultPlace
from torsionnet.text.text_edits import TextEdit, TextFix, TextSpan

_TO_WRITE = re.compile(r"write (?:the ratio as a number \()?([^;)]+)")
_UNIT = re.compile(r'^"([^"]*)" (?:is not a value of .*expected a unit such as|has the dimension of .* is in) ([^ ;]+)')


def number_meant(place: FaultPlace) -> Iterator[TextFix]:
    """Another number where the message asks whether that was meant."""
    found = MEANT.search(place.fault.message)
    if found and NUMBER.match(found[1]) and NUMBER.match(place.shown.strip("'\"")):
        yield from place.written_as(place.span, found[1])


def sign_of_product(place: FaultPlace) -> Iterator[TextFix]:
    """A sign of multiplication before a parameter that was read as a unit."""
    found = re.search(r'"([^"]*)" is not a known unit', place.fault.message)
    if not found or place.value_span is None:
        return
    name, text = found[1], place.written.text[place.value_span.start : place.value_span.end]
    known = node_at(place.written.document, ("parameters",))
    factor = re.search(rf"(\d)\s+{re.escape(name)}(?!\w)", text)
    if factor and known is not None and name in known.entries:
        start = place.value_span.start + factor.end(1)
        yield from place.fix(
            f"write {factor[1]}*{name}", TextEdit(TextSpan(start, start + factor.end() - factor.end(1)), f"*{name}")
        )


def point_for_comma(place: FaultPlace) -> Iterator[TextFix]:
    """A decimal point, also where a comma in brackets split the number."""
    if "has a decimal comma" not in place.fault.message:
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
    """Fix that writes what the message says one should write."""
    message = place.fault.message
    found, quoted = _TO_WRITE.search(message), QUOTED.search(message)
    if not found or not quoted or "decimal comma" in message or "it is a parameter" in message or '"' in found[1]:
        return
    span = place.span
    if "thousands separators" in message:  # the message gives the number without its unit
        digits = re.match(r"[-+\d_' .,]*\d", quoted[1])
        start = place.written.text.find(digits[0], span.start, span.end) if digits else -1
        if digits and start >= 0:
            span = TextSpan(start, start + len(digits[0]))
            yield from place.fix(f"write {found[1]}", TextEdit(span, found[1]))
        return
    if place.shown.strip("'\"") == quoted[1]:
        yield from place.written_as(span, found[1].strip())


def without_zeros(place: FaultPlace) -> Iterator[TextFix]:
    if "leave the 0 out" in place.fault.message:
        zeros = re.match(r"(['\"]?[-+]?)(0+)(?=\d)", place.shown)
        if zeros:
            start = place.span.start
            span = TextSpan(start + zeros.start(2), start + zeros.end(2))
            yield from place.fix("leave the 0 out", TextEdit(span, ""))


def expected_unit_written(place: FaultPlace) -> Iterator[TextFix]:
    """The unit that the message expects, with the number as it is; Hz of a speed become revolutions per minute."""
    found = _UNIT.match(place.fault.message)
    number = NUMBER.match(found[1]) if found else None
    if not found or number is None or place.shown.strip("'\"") != found[1]:
        return
    if "a share is a damping ratio" in place.fault.message:  # the number of a share is none of that unit
        return
    if "Hz counts cycles" in place.fault.message and found[1][number.end() :].strip() == "Hz":
        yield from place.written_as(place.span, f"{60 * float(number[0]):.15g} rpm")
        return
    symbol = re.match(r"[A-Za-z]+", found[2])
    prefix = re.match(rf"[kMGmµ](?={symbol[0]}(?![a-z]))", found[1][number.end() :].strip()) if symbol else None
    # The expected unit alone would be smaller or larger by a power of ten.
    yield from place.written_as(place.span, f"{number[0]} {prefix[0] if prefix else ''}{found[2]}")


def other_form(place: FaultPlace) -> Iterator[TextFix]:
    """A value in the form that the message expects: true or false, text, a list, the number of the format."""
    message, shown, span = place.fault.message, place.shown, place.span
    word = shown.strip("'\"").lower()
    if message.startswith("expected true or false") and word in ("yes", "on", "y", "no", "off", "n"):
        yield from place.fix(
            "write true" if word in ("yes", "on", "y") else "write false",
            TextEdit(span, "true" if word in ("yes", "on", "y") else "false"),
        )
    if message.startswith("expected text, got") and shown and '"' not in shown and place.value_span == span:
        yield from place.fix("put it in quotes", TextEdit(span, f'"{shown}"'))
    if re.match("expected a list of .*got '", message) and place.value_span == span:
        yield from place.fix("make it a list", TextEdit(span, f"[{shown}]"))
    if message.startswith("torsionnet: is the version of the format, 1") and word in ("1", "1.0"):
        yield from place.fix("write 1", TextEdit(span, "1"))


def value_missing(place: FaultPlace) -> Iterator[TextFix]:
    """An example of a value that is missing behind its name."""
    path, message = place.fault.path, place.fault.message
    if len(path) < 2 or not (message.startswith("a value is missing") or message.endswith("got nothing")):
        return
    parent, key = (path, "value") if path[-2] == "parameters" else (path[:-1], str(path[-1]))
    for value in example_values(place.written.document, parent, key):
        fixes = list(place.fix(f"write {place.written.written(value)}", place.written.replacement(path, value)))
        if fixes:
            yield from fixes
            return
