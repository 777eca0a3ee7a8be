"""Quick fixes of faults in a model text that is sound YAML: edits after which a fault is gone and no other has come."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator

from torsionnet.app.text.fixes import value_fixes
from torsionnet.app.text.fixes.value_fixes import FaultPlace, example_values
from torsionnet.app.text.text_edits import STEP, TextEdit, TextFix, TextSpan, WrittenText, edited
from torsionnet.base.errors import (
    INSERT,
    LEAVE_OUT,
    SEPARATE,
    ModelError,
    UsageError,
)
from torsionnet.model.files.located_yaml import LocatedNode, compose
from torsionnet.model.files.value_editing import node_at

# Quick fixes of whole entries: missing, given twice, without a value, not used, contradicting another.

_SECTIONS_OF_NAMES = ("elements", "parameters", "inputs", "sensors", "excitations", "use", "parts", "scenarios")


def missing_entry(place: FaultPlace) -> Iterator[TextFix]:
    """An entry that is missing, with an example of its value."""
    fault, written = place.fault, place.written
    if fault.kind != "missing-entry" or not fault.about:
        return
    root = written.node(())
    if fault.about in root.entries and not fault.path:  # the version, without a value
        yield TextFix("write torsionnet: 1", (written.replacement((fault.about,), 1),))
        return
    # The version stands first in a file.
    if fault.about == "torsionnet" and not written.is_flow(root):
        start = written.start(root)
        yield TextFix("insert torsionnet: 1", (TextEdit(TextSpan(start, start), f"torsionnet: 1{written.line_break}"),))
        return
    if fault.about == "torsionnet":
        first = written.key_start(next(iter(root.entries.values())))
        text = f"{written.entry_text('torsionnet', 1)}, "
        yield TextFix("insert torsionnet: 1", (TextEdit(TextSpan(first, first), text),))
        return
    # The first example that leaves no new fault.
    for value in example_values(written.document, fault.path, fault.about):
        edit = written.insertion(fault.path, fault.about, value)
        fixes = list(place.fix(f"insert {written.entry_text(fault.about, value)}", edit))
        if fixes:
            yield from fixes
            return


def entry_without_value(place: FaultPlace) -> Iterator[TextFix]:
    """A value for an entry that has none, or the entry left out."""
    fault = place.fault
    if fault.kind != "empty-entry" or not fault.about or place.value_span is None:
        return
    yield from place.without(fault.path)
    yield from place.with_value(fault.about)


def given_twice(place: FaultPlace) -> Iterator[TextFix]:
    """Another name for the second of two entries with one name, or one of both left out."""
    fault, text = place.fault, place.written.text
    entries_dropped = dict(place.written.document.dropped)
    if fault.kind != "repeated-name" or fault.path not in entries_dropped:
        return
    name, span = str(fault.path[-1]), place.span
    siblings = place.written.node(fault.path[:-1]).entries
    number = next(number for number in range(2, 1000) if f"{name}_{number}" not in siblings)
    new = f'"{name}_{number}"' if text[span.start : span.end].startswith('"') else f"{name}_{number}"
    second = edited(text, [TextEdit(span, new)])
    if len(fault.path) == 2 and fault.path[0] in _SECTIONS_OF_NAMES:
        yield from place.fix(f"rename to {new}", TextEdit(span, new))
    dropped = entries_dropped[fault.path]
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
    if place.fault.kind == "unused-name" and not any(fault.severity == "error" for fault in place.others):
        yield from place.without(place.fault.path)


def left_out(place: FaultPlace) -> Iterator[TextFix]:
    """An entry left out that contradicts another."""
    path, remedy = place.fault.path, place.remedy(LEAVE_OUT)
    if remedy is not None:
        yield from place.without(*((*path[:-1], key) for key in remedy.keys or path[-1:]))


def spring_for_shaft(place: FaultPlace) -> Iterator[TextFix]:
    """A spring where a shaft is given by its stiffness."""
    path = place.fault.path
    if place.fault.kind == "unknown-entry" and path[-1:] == ("stiffness",) and place.element_type == "shaft":
        edit = place.written.replacement((*path[:-1], "type"), "spring")
        yield from place.fix("write type: spring", edit)


def entry_to_add(place: FaultPlace) -> Iterator[TextFix]:
    """Entries that the remedy says to add, with the value it names."""
    remedy = place.remedy(INSERT)
    if remedy is not None:
        for key in remedy.keys:
            edit = place.written.insertion(place.fault.path, key, remedy.new)
            yield from place.fix(f"insert {key}: {remedy.new}", edit)


# Quick fixes for who does not know YAML: equals signs, parentheses, lists without brackets, no indentation.

_NAME_AND_VALUE = re.compile(r"(\w+)(\s*[=:]\s*|\s+)(\S.*)")
_EQUALS = re.compile(r"(\w+)\s*=\s*(\S.*)")
_RUN_TOGETHER = re.compile(r"(\w+)(?:\s*:\s*|\s+)(\S.*)")
_TWO_NAMES = re.compile(r"(\w+)\s*(?:\s|[-–/>;]|->|\bto\b)\s*(\w+)")


def colon_for_equals(place: FaultPlace) -> Iterator[TextFix]:
    """A colon and a blank between a name and its value, where an equals sign or nothing stands."""
    path, span = place.fault.path, place.span
    if place.remedy(SEPARATE):
        pair = _RUN_TOGETHER.fullmatch(place.shown)
    elif place.fault.kind == "wrong-form":
        pair = _NAME_AND_VALUE.fullmatch(place.shown)
    elif place.fault.kind == "unknown-entry":
        pair = _EQUALS.fullmatch(place.shown)
    elif place.fault.kind == "missing-entry":
        node = node_at(place.written.document, path)
        key = next((key for key in (node.entries if node else ()) if re.fullmatch(r"type[\s=:]+\w+", str(key))), "")
        if not key or node is None:
            return
        start = place.written.key_start(node.entries[key])
        span = TextSpan(start, start + len(str(key)))
        pair = re.fullmatch(r"(type)([\s=:]+)(\w+)", str(key))
    else:
        return
    if pair:
        value = pair[pair.re.groups]
        yield from place.fix(f'write "{pair[1]}: "', TextEdit(span, f"{pair[1]}: {value}"))


def nodes_in_brackets(place: FaultPlace) -> Iterator[TextFix]:
    """Two nodes as a list in brackets, one node without."""
    text, span = place.written.text, place.value_span
    if span is None:
        return
    shown = text[span.start : span.end]
    if place.fault.kind != "not-a-node":
        return
    alone = re.fullmatch(r"\[\s*(\w+)\s*\]", shown)
    if alone:
        yield from place.fix(f"write {alone[1]}", TextEdit(span, alone[1]))
    else:
        several = re.match(r"\(?\s*(\w+)\s*[,;]\s*(\w+)\s*\)?(?=\s*([,}]|$))", text[span.start :], re.MULTILINE)
        named = _TWO_NAMES.fullmatch(shown)
        listed = re.fullmatch(r"\[\s*(\w+)\s*[;/-]\s*(\w+)\s*\]", shown)
        nodes = listed or several or named
        if nodes:
            new = f"[{nodes[1]}, {nodes[2]}]"
            yield from place.fix(f"write {new}", TextEdit(TextSpan(span.start, span.start + nodes.end()), new))


def damper_to_ground(place: FaultPlace) -> Iterator[TextFix]:
    """Ground as the second node of a damper that is given one."""
    path, written = place.fault.path, place.written
    node = node_at(written.document, path)
    if place.fault.kind != "unknown-entry" or path[-1:] != ("node",) or place.element_type != "damper":
        return
    if node is None or not isinstance(node.value, str):
        return
    new = f"[{node.value}, ground]"
    edits = (TextEdit(place.span, "nodes"), TextEdit(written.value_span(node), new))
    yield from place.fix(f"write nodes: {new}", *edits)


def entries_indented(place: FaultPlace) -> Iterator[TextFix]:
    """Entries of an element indented that stand in one column with its name."""
    path, written = place.fault.path, place.written
    if len(path) < 2 or path[-2] != "elements" or not place.is_empty:
        return
    siblings = written.node(path[:-1])
    if written.is_flow(siblings):
        return
    keys = list(siblings.entries)
    own: list[LocatedNode] = []
    # Entries that follow up to the next element: a value that is no mapping is none of an element's.
    for key in keys[keys.index(path[-1]) + 1 :]:
        node = siblings.entries[key]
        if node.value is None or isinstance(node.value, dict):
            break
        own.append(node)
    if own:
        first, last = written.lines.place(written.key_start(own[0]))[0], written.lines.place(written.end(own[-1]))[0]
        starts = written.lines.starts[first : last + 1]
        edits = [TextEdit(TextSpan(start, start), STEP) for start in starts]
        yield from place.fix(f'indent the entries of "{path[-1]}"', *edits)


_RULES: tuple[Callable[[FaultPlace], Iterable[TextFix]], ...] = (
    colon_for_equals,
    nodes_in_brackets,
    damper_to_ground,
    entries_indented,
    value_fixes.name_meant,
    value_fixes.sign_of_product,
    value_fixes.number_meant,
    value_fixes.point_for_comma,
    value_fixes.as_said,
    value_fixes.without_zeros,
    value_fixes.expected_unit_written,
    value_fixes.value_missing,
    missing_entry,
    entry_to_add,
    spring_for_shaft,
    entry_without_value,
    given_twice,
    value_fixes.text_with_comma,
    value_fixes.other_form,
    left_out,
    value_fixes.valid_name,
    unused_parameter,
)


def quick_fixes(place: FaultPlace) -> tuple[TextFix, ...]:
    """Fixes of a fault in a text that is sound YAML, the likeliest first; none where nobody can know what was meant.

    Each one names what it writes.
    """
    fixes: dict[tuple[TextEdit, ...], TextFix] = {}
    for rule in _RULES:
        try:
            for fix in rule(place):
                fixes.setdefault(fix.edits, fix)
        except UsageError:  # the text has no such entry, as where a part or another file has it
            continue
    return tuple(fixes.values())
