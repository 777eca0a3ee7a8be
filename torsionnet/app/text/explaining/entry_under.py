"""Entry of a model text that stands at an offset, with the specification by which it is read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.app.text.named_places import NamesInText
from torsionnet.app.text.naming.mentions import Scope
from torsionnet.app.text.naming.name_homes import changed_section
from torsionnet.app.text.text_edits import TextSpan
from torsionnet.base.entries.spec import Spec
from torsionnet.base.errors import EntryPath
from torsionnet.model.files.located_yaml import LocatedNode


@dataclass(frozen=True)
class EntryUnder:
    """Entry at an offset: its path, its value and specification, and those of what it stands in.

    ``span`` is the stretch of its key, ``on_key``, or else of its value. ``scope`` is the model or part that holds it,
    and ``owner`` the specification of the entry around it.
    """

    path: EntryPath
    node: LocatedNode
    spec: Spec[Any] | None
    owner: Spec[Any] | None
    beside: Mapping[str, Any]
    span: TextSpan
    on_key: bool
    scope: Scope


def entry_under(names: NamesInText, offset: int) -> EntryUnder | None:
    """Innermost entry whose key or value stands at an offset or ends there, None where there is none."""
    from torsionnet.model.definition import Definition

    if names.root is None or not isinstance(names.root.value, Mapping):
        return None
    scope = Scope((), names.root.value)
    specs: Mapping[Any, Spec[Any]] = Definition.entry_specs(names.root.value)
    node, owner = names.root, None
    path: EntryPath = ()
    found: EntryUnder | None = None
    while True:
        hit = _child_at(names, node, offset)
        if hit is None:
            return found
        key, child, span, on_key = hit
        beside = node.value if isinstance(node.value, Mapping) else {}
        spec = specs.get(key) or _changed(str(key), scope)
        path = (*path, key)
        found = EntryUnder(path, child, spec, owner, beside, span, on_key, scope)
        if on_key:
            return found
        if len(path) == 2 and path[0] == "parts" and isinstance(child.value, Mapping):
            scope = Scope(path, child.value)
        node, owner = child, spec
        specs = spec.entry_specs(child.value) if spec is not None else {}


def _child_at(
    names: NamesInText, node: LocatedNode, offset: int
) -> tuple[str | int, LocatedNode, TextSpan, bool] | None:
    """Key, value and stretch of the entry in a value that stands at an offset, and whether that is on the key."""
    for key, child in node.entries.items():
        if child.key_place:
            span = names.stretches.whole(child.key_place)
            if span.start <= offset <= span.end:
                return key, child, span, True
    for key, child in node.entries.items():
        span = names.stretches.span(child.place)
        if span.start <= offset <= span.end:
            return key, child, span, False
    return None


def _changed(key: str, scope: Scope) -> Spec[Any] | None:
    section = changed_section(key, scope) if "." in key else None
    return section and section.spec
