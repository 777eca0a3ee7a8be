"""Edits of the elements and values of a model text, whose comments, order and spacing stay."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from yaml.events import AliasEvent, StreamEndEvent

from torsionnet.app.text.text_edits import STEP, TextEdit, TextSpan, WrittenText, edited
from torsionnet.app.text.text_faults import LocatedFault, text_faults
from torsionnet.base.entries.spec import Json
from torsionnet.base.errors import EntryPath, ModelError, UsageError, did_you_mean
from torsionnet.model.files.located_yaml import compose, fastest_parser
from torsionnet.model.files.value_editing import node_at


@dataclass(frozen=True)
class Removal:
    """Edits that remove an element from a model text, and the faults that the text only has without it."""

    edits: tuple[TextEdit, ...]
    faults: tuple[LocatedFault, ...]


def value_edit(text: str, path: EntryPath, value: Json, file: str = "") -> list[TextEdit]:
    """Edits that give an entry of a model text another value, or a table of entries a new one.

    Raises UsageError for a text that is broken, a path that leads nowhere, and a value that others share by an anchor.

    Examples
    --------
    >>> text = "elements:\\n  disc: {type: inertia, inertia: 2}  # cast iron\\n"
    >>> print(edited(text, value_edit(text, ("elements", "disc", "inertia"), "3 kg*m^2")), end="")
    elements:
      disc: {type: inertia, inertia: 3 kg*m^2}  # cast iron
    """
    written = _written(text, file)
    if node_at(written.document, path) is not None and path:
        edit = written.replacement(path, value)
        _refuse_shared(written, edit.span, ".".join(map(str, path)))
    elif path:
        edit = written.insertion(path[:-1], str(path[-1]), value)
    else:
        raise UsageError("name the entry whose value changes")
    return _certain(written, [edit], _with_value(written.document.data, path, value))


def inserted_element(
    text: str, name: str, entries: Mapping[str, Json], after: str | None = None, file: str = ""
) -> list[TextEdit]:
    """Edits that insert an element into a model text, behind the element ``after`` or as the last.

    Raises UsageError where the text is broken, the name is taken or no element is named ``after``.

    Examples
    --------
    >>> text = "elements:\\n  disc: {type: inertia, node: a, inertia: 2}\\n"
    >>> print(edited(text, inserted_element(text, "stop", {"type": "lock", "node": "a"})), end="")
    elements:
      disc: {type: inertia, node: a, inertia: 2}
      stop: {type: lock, node: a}
    """
    written = _written(text, file)
    data = written.document.data
    if data is not None and not isinstance(data, dict):
        raise UsageError("this text is no model; a model is made of entries: torsionnet: 1, name: ..., elements: ...")
    elements = (data or {}).get("elements")
    known = elements if isinstance(elements, dict) else {}
    if name in known:
        raise UsageError(f'an element is already named "{name}"; each name stands once')
    if after is not None and after not in known:
        raise UsageError(f'no element is named "{after}"{did_you_mean(after, known)}')
    new = {**(data or {}), "elements": _put_in(known, name, dict(entries), after)}
    if isinstance(elements, dict) or (data and "elements" in data):
        edit = written.insertion(("elements",), name, dict(entries), after)
    elif data is not None and written.is_flow(written.node(())):
        edit = written.insertion((), "elements", {name: dict(entries)})
    else:
        edit = _new_section(written, name, entries)
    return _certain(written, [edit], new)


def without_element(text: str, name: str, file: str = "", folder: Path | None = None) -> Removal:
    """Edits that remove an element with its comments, and what still names it as faults of the new text.

    Raises UsageError where the text is broken, has no such element, or uses an anchor (&) of it elsewhere.

    Examples
    --------
    >>> text = "elements: {disc: {type: inertia, node: a, inertia: 2}, stop: {type: lock, node: a}}"
    >>> edited(text, without_element(text, "stop").edits)
    'elements: {disc: {type: inertia, node: a, inertia: 2}}'
    """
    written = _written(text, file)
    elements = node_at(written.document, ("elements",))
    known = elements.entries if elements else {}
    if name not in known:
        raise UsageError(f'no element is named "{name}"{did_you_mean(name, map(str, known))}')
    edits = written.removal(("elements", name))
    for edit in edits:
        _refuse_shared(written, edit.span, name)
    data = written.document.data
    left = {key: value for key, value in data["elements"].items() if key != name}
    _certain(written, edits, {**data, "elements": left})
    before = {(one.fault.message, one.fault.path) for one in text_faults(text, file, folder)}
    faults = text_faults(edited(text, edits), file, folder)
    new = (one for one in faults if (one.fault.message, one.fault.path) not in before)
    return Removal(tuple(edits), tuple(new))


def _written(text: str, file: str) -> WrittenText:
    try:
        document = compose(text.removeprefix("\ufeff"), file)
    except ModelError as error:
        fault = error.faults[0]
        place = f" (line {fault.position.line})" if fault.position else ""
        raise UsageError(f"the text is broken; mend it first: {fault.message}{place}") from None
    if document.faults:
        raise UsageError(f"the text is broken; mend it first: {document.faults[0].message}")
    return WrittenText(text, document, file.lower().endswith(".json"))


def _new_section(written: WrittenText, name: str, entries: Mapping[str, Json]) -> TextEdit:
    """Edit that adds the section of elements with its first element at the end of a text."""
    if written.is_json:
        return TextEdit(TextSpan(0, len(written.text)), written.written({"elements": {name: dict(entries)}}))
    start = "" if not written.text or written.text.endswith(("\n", "\r")) else written.line_break
    lines = ("elements:", f"{STEP}{written.entry_text(name, dict(entries))}", "")
    place = len(written.text)
    return TextEdit(TextSpan(place, place), start + written.line_break.join(lines))


def _certain(written: WrittenText, edits: list[TextEdit], data: Any) -> list[TextEdit]:
    """Edits after which the text holds certain data; UsageError where its layout does not allow that."""
    try:
        found = compose(edited(written.text, edits).removeprefix("\ufeff"), written.document.file).data
    except ModelError:
        found = None
    if found != data:
        raise UsageError("the layout of this place does not allow the change; write it by hand")
    return edits


def _put_in(known: Mapping[str, Any], name: str, value: Json, after: str | None) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, one in known.items():
        found[key] = one
        if key == after:
            found[name] = value
    return found if after is not None else {**found, name: value}


def _with_value(data: Any, path: EntryPath, value: Json) -> Any:
    """Plain data in which the entry at a path has another value."""
    if not path:
        return value
    if isinstance(data, list):
        return [_with_value(one, path[1:], value) if place == path[0] else one for place, one in enumerate(data)]
    known = data if isinstance(data, dict) else {}
    return {**known, path[0]: _with_value(known.get(path[0]), path[1:], value)}


def _refuse_shared(written: WrittenText, span: TextSpan, what: str) -> None:
    """Refuse to change a stretch with an anchor that is used behind it."""
    text = written.text
    if "&" not in text[span.start : span.end]:
        return
    for name, place in _used_elsewhere(written, span):
        line = written.lines.place(place)[0] + 1
        raise UsageError(f'{what} holds the anchor "&{name}", which line {line} uses as "*{name}"; write it out there')


def _used_elsewhere(written: WrittenText, span: TextSpan) -> Iterable[tuple[str, int]]:
    """Name and offset of every alias outside a stretch whose anchor is in it."""
    events = fastest_parser()(written.text.removeprefix("\ufeff"))
    home: dict[str, bool] = {}  # by name, whether the last anchor of it stands in the stretch
    while not isinstance(event := events.get_event(), StreamEndEvent):
        name = getattr(event, "anchor", None)
        if name is None:
            continue
        place = written.offset(event.start_mark.line, event.start_mark.column)
        inside = span.start <= place < span.end
        if not isinstance(event, AliasEvent):
            home[name] = inside
        elif home.get(name) and not inside:
            yield name, place
