"""Quick fixes of whole entries: missing, given twice, without a value, not used, contradicting another."""

from __future__ import annotations

from collections.abc import Iterator

from torsionnet.app.text.entry_edits import WrittenText
from torsionnet.app.text.fixes.example_values import example_values
from torsionnet.app.text.fixes.fault_place import FaultPlace
from torsionnet.app.text.text_edits import TextEdit, TextFix, TextSpan, edited
from torsionnet.base.errors import (
    GIVEN_TWICE,
    INSERT,
    LEAVE_OUT,
    MISSING_KEY,
    NO_VALUE,
    UNKNOWN_KEY,
    UNUSED,
    ModelError,
)
from torsionnet.model.files.located_yaml import compose

_SECTIONS_OF_NAMES = ("elements", "parameters", "inputs", "sensors", "excitations", "use", "parts", "scenarios")


def missing_entry(place: FaultPlace) -> Iterator[TextFix]:
    """An entry that is missing, with an example of its value."""
    fault, written = place.fault, place.written
    if fault.kind != MISSING_KEY or not fault.about:
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
        edit = written.insertion(fault.path, fault.about, value)
        fixes = list(place.fix(f"insert {written.entry_text(fault.about, value)}", edit))
        if fixes:
            yield from fixes
            return


def entry_without_value(place: FaultPlace) -> Iterator[TextFix]:
    """A value for an entry that has none, or the entry left out."""
    fault = place.fault
    if fault.kind != NO_VALUE or place.value_span is None:
        return
    yield from place.without(fault.path)
    for value in example_values(place.written.document, fault.path[:-1], fault.about):
        edit = place.written.replacement(fault.path, value)
        fixes = list(place.fix(f"write {place.written.entry_text(fault.about, value)}", edit))
        if fixes:
            yield from fixes
            return


def given_twice(place: FaultPlace) -> Iterator[TextFix]:
    """Another name for the second of two entries with one name, or one of both left out."""
    fault, text = place.fault, place.written.text
    if fault.kind != GIVEN_TWICE:
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
    if place.fault.kind == UNUSED and not any(one.severity == "error" for one in place.others):
        yield from place.without(place.fault.path)


def left_out(place: FaultPlace) -> Iterator[TextFix]:
    """An entry left out that contradicts another."""
    path, remedy = place.fault.path, place.remedy(LEAVE_OUT)
    if remedy is not None:
        yield from place.without(*((*path[:-1], key) for key in remedy.keys or path[-1:]))


def spring_for_shaft(place: FaultPlace) -> Iterator[TextFix]:
    """A spring where a shaft is given by its stiffness."""
    path = place.fault.path
    if place.fault.kind == UNKNOWN_KEY and path[-1:] == ("stiffness",) and place.element_type == "shaft":
        edit = place.written.replacement((*path[:-1], "type"), "spring")
        yield from place.fix("write type: spring", edit)


def entry_to_add(place: FaultPlace) -> Iterator[TextFix]:
    """Entries that the remedy says to add, with the value it names."""
    remedy = place.remedy(INSERT)
    if remedy is not None:
        for key in remedy.keys:
            edit = place.written.insertion(place.fault.path, key, remedy.new)
            yield from place.fix(f"insert {key}: {remedy.new}", edit)
