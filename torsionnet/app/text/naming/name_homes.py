"""Things that a name in a model stands for: those of the model, of a part that it uses, or of an element."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from torsionnet.app.text.naming.mentions import CHANGED, Mention, Scope
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import Spec
from torsionnet.base.errors import EntryPath
from torsionnet.model.files.located_yaml import LocatedNode

_TABLES = {"element": "elements", "parameter": "parameters", "excitation": "excitations"}


class NameHome(NamedTuple):
    """Thing that a name, or a piece of it from ``start`` on, stands for."""

    kind: str
    name: str
    home: EntryPath
    start: int = 0


def homes(mention: Mention, scope: Scope, root: LocatedNode) -> Iterator[NameHome]:
    """Things that a name stands for: one, or with dots those that its pieces name."""
    kind, name, part = mention
    if kind == "part":
        yield NameHome(kind, name, ("parts", name))
    elif kind == "axis":
        yield from _axis(name, scope)
    elif kind == "configuration":
        yield from _alternative(name, part, scope)
    elif part:
        inner = part_scope(part, root)
        if inner is not None:
            yield from homes(Mention(kind, name), inner, root)
    elif kind == CHANGED:
        yield from _changed_entry(name, scope, root)
    elif kind != "node" or name != "ground":
        yield from _thing(kind, name, scope, root)


def part_scope(part: str, root: LocatedNode) -> Scope | None:
    """Scope of a part that the document itself holds, else None."""
    parts = root.value.get("parts")
    found = parts.get(part) if isinstance(parts, Mapping) else None
    return Scope(("parts", part), found) if isinstance(found, Mapping) else None


def _thing(kind: str, name: str, scope: Scope, root: LocatedNode) -> Iterator[NameHome]:
    """Thing of a model or part, or pieces of a name as ``left.hub`` and ``damper.ring``."""
    section, kind = _section(kind, name, scope)
    if "." not in name or name in scope.table(section):
        yield NameHome(kind, name, (*scope.path, section, name))
        return
    first, _, rest = name.partition(".")
    use = used_as(first, scope)
    if use is not None:
        yield NameHome("use", use, (*scope.path, "use", use))
        entries = scope.table("use")[use]
        inner = part_scope(str(entries.get("part")), root) if isinstance(entries, Mapping) else None
        for one in _thing(kind, rest, inner, root) if inner else ():
            yield one._replace(start=one.start + len(first) + 1)
        return
    owner = next((one for one in _heads(name) if one in scope.table("elements")), None)
    if owner is None or kind not in ("node", "element", "parameter"):
        yield NameHome(kind, name, (*scope.path, section, name))
    else:
        yield NameHome("element", owner, (*scope.path, "elements", owner))


def _section(kind: str, name: str, scope: Scope) -> tuple[str, str]:
    """Section of a model that holds a thing, and its kind where that depends on the section."""
    if kind != "channel":
        return _TABLES.get(kind, f"{kind}s"), kind
    if name in scope.table("sensors"):
        return "sensors", "sensor"
    return ("inputs", "input") if name in scope.table("inputs") else ("channels", "channel")


def _heads(name: str) -> Iterator[str]:
    """Name up to each of its dots, the longest first."""
    head, dot, _ = name.rpartition(".")
    while dot:
        yield head
        head, dot, _ = head.rpartition(".")


def used_as(prefix: str, scope: Scope) -> str | None:
    """Name of the use whose copies have a prefix, as ``cyl`` of ``cyl3``; None where there is none."""
    for name, use in scope.table("use").items():
        repeat = use.get("repeat") if isinstance(use, Mapping) else None
        if prefix == name and repeat is None:
            return name
        number = prefix.removeprefix(name)
        if isinstance(repeat, int) and prefix.startswith(name) and number.isdigit() and 1 <= int(number) <= repeat:
            return name
    return None


class ChangedSection(NamedTuple):
    """Section of a model of which an alternative changes an entry, as ``engine`` in ``engine.misfire``."""

    kind: str
    name: str
    home: EntryPath
    spec: Spec[Any] | None


def changeable_sections() -> dict[str, Any]:
    """Specifications of the sections of which an alternative of a configuration may change entries, by name."""
    import torsionnet.model.sections as sections

    return {"excitations": sections.EXCITATIONS, "elements": sections.ELEMENTS, "scenarios": sections.SCENARIOS}


def changed_section(key: str, scope: Scope) -> ChangedSection | None:
    """Excitation, element or scenario whose entry a key as ``box.engaged`` names; None for another key."""
    name, _, entry = key.rpartition(".")
    if key in scope.table("parameters"):
        return None
    found: list[ChangedSection] = []
    for section, table in changeable_sections().items():
        raw = scope.table(section).get(name)
        if raw is not None:
            cls = _class_of(table.of, raw)
            spec = dict(cls.specs()).get(entry) if cls else None
            found.append(ChangedSection(section[:-1], name, (*scope.path, section, name), spec))
    return next((one for one in found if one.spec is not None), found[0] if found else None)


def _class_of(spec: Any, raw: object) -> type[Declared] | None:
    kind = raw.get(spec.key) if isinstance(raw, Mapping) else None
    found: type[Declared] | None = spec.kinds().get(kind) if isinstance(kind, str) else None
    return found


def _changed_entry(name: str, scope: Scope, root: LocatedNode) -> Iterator[NameHome]:
    """Things named by the key of a change in an alternative."""
    section = changed_section(name, scope) if "." in name else None
    if section is not None:
        yield NameHome(section.kind, section.name, section.home)
        return
    first, _, rest = name.partition(".")
    use = used_as(first, scope) if rest and name not in scope.table("parameters") else None
    if use is None:
        if not name.startswith("load."):
            yield from _thing("parameter", name, scope, root)
        return
    yield NameHome("use", use, (*scope.path, "use", use))
    entries = scope.table("use")[use]
    inner = part_scope(str(entries.get("part")), root) if isinstance(entries, Mapping) else None
    for one in _changed_entry(rest, inner, root) if inner else ():
        yield one._replace(start=one.start + len(first) + 1)


def _axis(name: str, scope: Scope) -> Iterator[NameHome]:
    first = name.partition(".")[0]
    if name not in scope.table("configurations"):
        use = used_as(first, scope)
        if use is not None:
            yield NameHome("use", use, (*scope.path, "use", use))
            return
    yield NameHome("axis", name, (*scope.path, "configurations", name))


def _alternative(name: str, axis: str, scope: Scope) -> Iterator[NameHome]:
    """Alternative of that name on its axis, or on the only axis that has it."""
    from torsionnet.model.configurations import DEFAULT_AXIS, has_axes

    table = scope.table("configurations")
    if not has_axes(table):
        if name in table:
            yield NameHome("configuration", name, (*scope.path, "configurations", DEFAULT_AXIS, name))
        return
    for one, alternatives in table.items():
        if axis in ("", one) and isinstance(alternatives, Mapping) and name in alternatives:
            yield NameHome("configuration", name, (*scope.path, "configurations", one, name))
