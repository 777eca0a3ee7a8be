"""Quick fixes of whole entries: missing, given twice, without a value, not used, contradicting another."""

from __future__ import annotations

import re
from collections.abc import Iterator

from torsionnet.core.errors import ModelError
from torsionnet.model.files.located_yaml import compose
from torsionnet.text.entry_edits import WrittenText
from torsionnet.text.fixes.example_values import example_values
from torsionnet.text.fixes.fault_place import FaultPlace
from torsionnet.text.text_edits import TextEdit, TextFix, TextSpan, edited

_SECTIONS_OF_NAMES = ("elements", "parameters", "inputs", "sensors", "excitations", "use", "parts", "scenarios")


def missing_entry(place: FaultPlace) -> Iterator[TextFix]:
    """An entry that is missing, with an example of its value."""
    fault, written = place.fault, place.written
    if fault.kind != "missing key" or not fault.about:
        return
    root = written.node(())
    if fault.about == "torsionnet" and not written.is_flow(root):
        start = written.start(root)
        yield TextFix("insert torsionnet: 1", (TextEdit(TextSpan(start, start), f"torsionnet: 1{written.line_break}"),))
        return
    if fault.about == "torsionnet":
        first = written.key_start(next(iter(root.entries.values())))
        text = f"{written.entry_text('torsionnet', 1)}, "
        yield TextFix("insert torsionnet: 1", (TextEdit(TextSpan(first, first), text),))
        return
    for value in example_values(written.document, fault.path, fault.about):
        fixes = list(
            place.fix(
                f"insert {written.entry_text(fault.about, value)}", written.insertion(fault.path, fault.about, value)
            )
        )
        if fixes:
            yield from fixes
            return


def entry_without_value(place: FaultPlace) -> Iterator[TextFix]:
    """A value for an entry that has none, or the entry left out."""
    found = re.match(r"(\w+) has no value", place.fault.message)
    if not found or place.value_span is None:
        return
    yield from place.without(place.fault.path)
    for value in example_values(place.written.document, place.fault.path[:-1], found[1]):
        edit = place.written.replacement(place.fault.path, value)
        fixes = list(place.fix(f"write {place.written.entry_text(found[1], value)}", edit))
        if fixes:
            yield from fixes
            return


def given_twice(place: FaultPlace) -> Iterator[TextFix]:
    """Another name for the second of two entries with one name, or one of both left out."""
    fault, text = place.fault, place.written.text
    if " was already given at " not in fault.message or not fault.path:
        return
    name, span = str(fault.path[-1]), place.span
    siblings = place.written.node(fault.path[:-1]).entries
    number = next(number for number in range(2, 1000) if f"{name}_{number}" not in siblings)
    new = f'"{name}_{number}"' if text[span.start : span.end].startswith('"') else f"{name}_{number}"
    second = edited(text, [TextEdit(span, new)])
    if len(fault.path) == 2 and fault.path[0] in _SECTIONS_OF_NAMES:
        yield from place.fix(f"rename to {new}", TextEdit(span, new))
    dropped = dict(place.written.document.dropped).get(fault.path)
    if siblings[name].value != dropped and (isinstance(dropped, (dict, list)) or len(fault.path) <= 2):
        return  # what it says would be lost
    try:
        document = compose(second.removeprefix("\ufeff"), place.written.document.file)
    except ModelError:
        return
    grown = WrittenText(second, document, place.written.is_json)
    more = len(new) - (span.end - span.start)
    for edit in grown.removal((*fault.path[:-1], f"{name}_{number}")):
        end = edit.span.end - more if edit.span.start <= span.start < edit.span.end else edit.span.end
        yield from place.fix(f'delete this "{name}"', TextEdit(TextSpan(edit.span.start, end), edit.text))


def unused_parameter(place: FaultPlace) -> Iterator[TextFix]:
    """Parameter deleted that nothing uses; with errors in the text, what cannot be read may be its use."""
    if re.fullmatch(r'parameter "[^"]*" is not used', place.fault.message) and not any(
        one.severity == "error" for one in place.others
    ):
        yield from place.without(place.fault.path)


def left_out(place: FaultPlace) -> Iterator[TextFix]:
    """An entry left out that contradicts another."""
    path, message = place.fault.path, place.fault.message
    both = re.match(r"give (\w+) or (\w+), not both", message)
    if both:
        yield from place.without(*((*path[:-1], key) for key in both.groups()))
    one = re.search(r"leave out (\w+)", message)
    if one and path and path[-1] == one[1]:
        yield from place.without(path)


def spring_for_shaft(place: FaultPlace) -> Iterator[TextFix]:
    """A spring where a shaft is given by its stiffness."""
    if "a shaft of known stiffness is a spring" in place.fault.message:
        edit = place.written.replacement((*place.fault.path[:-1], "type"), "spring")
        yield from place.fix("write type: spring", edit)


def entry_to_add(place: FaultPlace) -> Iterator[TextFix]:
    """An entry that the message says to add, with the value it names."""
    found = re.search(r"; add (\w+): ([^;:]+)$", place.fault.message)
    if found:
        edit = place.written.insertion(place.fault.path, found[1], found[2])
        yield from place.fix(f"insert {found[1]}: {found[2]}", edit)
