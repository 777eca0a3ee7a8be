"""Quick fixes for who does not know YAML: equals signs, parentheses, lists without brackets, no indentation."""

from __future__ import annotations

import re
from collections.abc import Iterator

from torsionnet.app.text.entry_edits import STEP
from torsionnet.app.text.fixes.fault_place import FaultPlace
from torsionnet.app.text.text_edits import TextEdit, TextFix, TextSpan
from torsionnet.base.errors import NO_NODE, NO_NODES, NO_TABLE, NO_TYPE, SEPARATE, UNKNOWN_KEY
from torsionnet.model.files.located_yaml import LocatedNode
from torsionnet.model.files.value_editing import node_at

_NAME_AND_VALUE = re.compile(r"(\w+)(\s*[=:]\s*|\s+)(\S.*)")
_EQUALS = re.compile(r"(\w+)\s*=\s*(\S.*)")
_RUN_TOGETHER = re.compile(r"(\w+)(?:\s*:\s*|\s+)(\S.*)")
_TWO_NAMES = re.compile(r"(\w+)\s*(?:\s|[-–/>;]|->|\bto\b)\s*(\w+)")


def colon_for_equals(place: FaultPlace) -> Iterator[TextFix]:
    """A colon and a blank between a name and its value, where an equals sign or nothing stands."""
    path, span = place.fault.path, place.span
    if place.fault.kind == NO_TABLE:
        found = _NAME_AND_VALUE.fullmatch(place.shown)
    elif place.remedy(SEPARATE):
        found = _RUN_TOGETHER.fullmatch(place.shown)
    elif place.fault.kind == UNKNOWN_KEY:
        found = _EQUALS.fullmatch(place.shown)
    elif place.fault.kind == NO_TYPE:
        node = node_at(place.written.document, path)
        key = next((key for key in (node.entries if node else ()) if re.fullmatch(r"type[\s=:]+\w+", str(key))), "")
        if not key or node is None:
            return
        start = place.written.key_start(node.entries[key])
        span = TextSpan(start, start + len(str(key)))
        found = re.fullmatch(r"(type)([\s=:]+)(\w+)", str(key))
    else:
        return
    if found:
        value = found[found.re.groups]
        yield from place.fix(f'write "{found[1]}: "', TextEdit(span, f"{found[1]}: {value}"))


def nodes_in_brackets(place: FaultPlace) -> Iterator[TextFix]:
    """Two nodes as a list in brackets, one node without."""
    text, span = place.written.text, place.value_span
    if span is None:
        return
    shown = text[span.start : span.end]
    if place.fault.kind == NO_NODES:
        several = re.match(r"\(?\s*(\w+)\s*[,;]\s*(\w+)\s*\)?(?=\s*([,}]|$))", text[span.start :], re.MULTILINE)
        named = _TWO_NAMES.fullmatch(shown)
        listed = re.fullmatch(r"\[\s*(\w+)\s*[;/-]\s*(\w+)\s*\]", shown)
        found = listed or several or named
        if found:
            new = f"[{found[1]}, {found[2]}]"
            yield from place.fix(f"write {new}", TextEdit(TextSpan(span.start, span.start + found.end()), new))
    elif place.fault.kind == NO_NODE:
        one = re.fullmatch(r"\[\s*(\w+)\s*\]", shown)
        if one:
            yield from place.fix(f"write {one[1]}", TextEdit(span, one[1]))


def damper_to_ground(place: FaultPlace) -> Iterator[TextFix]:
    """Ground as the second node of a damper that is given one."""
    path, written = place.fault.path, place.written
    node = node_at(written.document, path)
    if place.fault.kind != UNKNOWN_KEY or path[-1:] != ("node",) or place.element_type != "damper":
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
