"""Options for a key: the entries that may stand at a place, or the names that a table is by."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from torsionnet.app.text.completing.completion_option import CompletionOption, Writing, summary, unit_text
from torsionnet.app.text.completing.completion_places import EntryPlace, class_at, holds_entries
from torsionnet.app.text.naming.fixed_keys import properties_of
from torsionnet.app.text.naming.name_homes import changeable_sections
from torsionnet.base.entries.composite import Typed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import Spec
from torsionnet.model.channels import ChannelEntry
from torsionnet.model.configurations import ChangedEntry
from torsionnet.model.damping import MEASURES, DampingQuantity, LossFactor
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.element_base.laws import GROUND
from torsionnet.model.element_base.quantity_table import TableByNode

_NEW = "name of a new entry"
"""Key that stands for any name in a table by name."""
USUAL_TYPES = (
    "inertia",
    "spring",
    "damper",
    "shaft",
    "gear",
    "flexible_coupling",
    "propeller",
    "planetary",
    "hysteretic_spring",
)
"""Element types that most models are made of, which are offered before the others."""
_USUAL_ENTRIES = {"spring": ("stiffness",), "flexible_coupling": ("stiffness",), "gear": ("ratio",)}
"""Entries that nearly every element of a type has though another one can take their place, by type."""
_COLON = re.compile(r"\w*\s*:(\s|$)")


def key_options(writing: Writing) -> Iterator[CompletionOption]:
    """Options for the key that is being written, those that have to be given first."""
    spec, data = writing.place.spec, writing.place.data
    given: Mapping[Any, Any] = data if isinstance(data, Mapping) else {}
    if spec is None:
        return
    cls = class_at(writing.place)
    if isinstance(spec, Typed) and spec.key not in given:
        yield _key(writing, spec.key, spec, "required")
        if not given:
            yield from typed_options(writing, spec)
    if cls is not None:
        yield from _entries(writing, cls, given)
    yield from _name_options(writing, spec, given)
    if cls is None and not holds_entries(spec):  # of a table by name the keys are free
        yield from _keys_of_whole(writing, spec, given)


def _entries(writing: Writing, cls: type[Declared], given: Mapping[Any, Any]) -> Iterator[CompletionOption]:
    specs, required = dict(cls.specs()), cls.required()
    for name in cls.head:
        if name not in given:
            yield CompletionOption(name, "entry", _with_colon(writing, name), "required", "version of the file format")
    order = sorted(specs, key=lambda name: name not in required)
    for name in order:
        if name not in given:
            yield _key(writing, name, specs[name], "required" if name in required else "")


def _key(writing: Writing, name: str, spec: Spec[Any], note: str = "") -> CompletionOption:
    unit = unit_text(spec)
    detail = ", ".join(one for one in (unit, note) if one)
    return CompletionOption(name, "entry", _with_colon(writing, name, spec), detail, spec.description)


def _with_colon(writing: Writing, name: str, spec: Spec[Any] | None = None) -> str:
    if _COLON.match(writing.after):
        return name
    if not writing.is_flow and holds_entries(spec):
        return f"{name}:\n{' ' * (writing.context.indent + 2)}"
    return f"{name}: "


def _name_options(writing: Writing, spec: Spec[Any], given: Mapping[Any, Any]) -> Iterator[CompletionOption]:
    """Names of nodes or other things that are keys of a table."""
    named = NodeName("a node") if isinstance(spec, TableByNode) else spec.key_names({**given, _NEW: None}).get(_NEW)
    if isinstance(named, ChangedEntry):
        yield from _changed(writing, given)
    elif named is not None:
        for kind, name in writing.names.for_spec(named):
            if name not in given and name != GROUND:
                yield CompletionOption(name, kind, _with_colon(writing, name), kind)


def _changed(writing: Writing, given: Mapping[Any, Any]) -> Iterator[CompletionOption]:
    """Options for what an alternative of a configuration changes: parameters, and entries as ``box.engaged``."""
    for name in writing.names.names("parameters"):
        if name not in given:
            yield CompletionOption(name, "parameter", _with_colon(writing, name), "parameter")
    owner = writing.word.rpartition(".")[0]
    for section, table in changeable_sections().items():
        kind = section[:-1]
        if not owner:
            yield from (CompletionOption(f"{one}.", kind, f"{one}.", kind) for one in writing.names.table(section))
            continue
        cls = class_at(EntryPlace(table.of, writing.names.table(section).get(owner)))
        for name, spec in cls.specs() if cls else ():
            full = f"{owner}.{name}"
            if full not in given:
                yield CompletionOption(full, "entry", _with_colon(writing, full), unit_text(spec), spec.description)


def _keys_of_whole(writing: Writing, spec: Spec[Any], given: Mapping[Any, Any]) -> Iterator[CompletionOption]:
    """Keys of an entry that is read as a whole, as a damping measure; of those that exclude each other only one."""
    one_of: tuple[str, ...] = ()
    if isinstance(spec, ChannelEntry):
        one_of = spec.quantities
    elif isinstance(spec, DampingQuantity | LossFactor):
        one_of = tuple(MEASURES)
    is_chosen = any(name in given for name in one_of)
    for name, schema in properties_of(spec).items():
        if name not in given and not (is_chosen and name in one_of):
            text = schema.get("description", "") if isinstance(schema, Mapping) else ""
            yield CompletionOption(str(name), "entry", _with_colon(writing, str(name)), "", str(text))


def typed_options(writing: Writing, spec: Typed[Any], *, opens: bool = False) -> Iterator[CompletionOption]:
    """Options for a whole entry of each type with the entries that it needs, in the layout of its neighbours.

    ``opens`` says that the entry stands behind its key, so that it begins with a bracket or on a line of its own.
    """
    for kind, cls in usual_first(spec):
        needed = (*cls.required(), *(_USUAL_ENTRIES.get(kind, ()) if kind_of(spec) == "element type" else ()))
        lines = [f"{spec.key}: {kind}", *(f"{name}: " for name in needed)]
        label = f"{kind} with {', '.join(needed)}" if needed else kind
        if writing.is_flow or (opens and _neighbours_are_flow(writing)):
            insert = ", ".join(lines)
            insert = f"{{{insert}}}" if opens else insert
        else:
            indent = writing.context.indent + (2 if opens else 0)
            insert = f"\n{' ' * indent}".join(["", *lines] if opens else lines)
        yield CompletionOption(label, kind_of(spec), insert, spec.what, summary(cls))


def usual_first(spec: Typed[Any]) -> list[tuple[str, type[Declared]]]:
    """Types with their names, those that most models are made of first."""
    ranks = {name: rank for rank, name in enumerate(USUAL_TYPES)}
    return sorted(spec.kinds().items(), key=lambda one: ranks.get(one[0], len(ranks)))


def kind_of(spec: Typed[Any]) -> str:
    """Kind of the options for a type: an element type, or a word."""
    return "element type" if spec.what == "element" else "word"


def _neighbours_are_flow(writing: Writing) -> bool:
    """Whether the entries beside one are written in brackets on one line, as most models write elements."""
    indent = " " * writing.context.indent
    own = writing.text.rfind("\n", 0, writing.offset) + 1
    beside = re.compile(rf"^{indent}[^\s#].*?:[ \t]*(\S?)", re.MULTILINE)
    found = [one[1] for one in beside.finditer(writing.text) if one.start() != own]
    return "" not in found or "{" in found
