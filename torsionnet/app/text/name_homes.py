"""Things that a name in a model stands for: those of the model, of a part that it uses, or of an element."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

from torsionnet.app.text.text_edits import TextLines, TextSpan
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import Renaming, Spec
from torsionnet.base.errors import EntryPath, TorsionnetError
from torsionnet.model.files.located_yaml import LocatedNode, Place

# Mentions of nodes, parameters, elements and other things in the entries of a model.

CHANGED = "changed entry"
"""Kind of a mention that an alternative changes, before it is known whether that is a parameter or an entry."""


class Mention(NamedTuple):
    """Name of something of a kind, as an entry holds it; of a thing in a part with the name of that part."""

    kind: str
    name: str
    part: str = ""


@dataclass(frozen=True)
class Scope:
    """Model or part within which names are unique, by its path in the document and its data."""

    path: EntryPath
    data: Mapping[str, Any]

    def table(self, section: str) -> Mapping[str, Any]:
        """Entries of a section by name, as they are written; empty where there is no such section."""
        table = self.data.get(section)
        return table if isinstance(table, Mapping) else {}

    @cached_property
    def recorder(self) -> Recorder:
        """Recorder of the names that entries of the model or part mention."""
        channels = {*self.table("sensors"), *self.table("inputs")}
        return Recorder("", {}, channels, PortTable(self), {*self.table("excitations")})


@dataclass(frozen=True)
class PortTable(Mapping[str, Mapping[str, str]]):
    """Table of the ports of each element with their nodes, made for an element when it is asked for."""

    scope: Scope

    def __getitem__(self, name: str) -> Mapping[str, str]:
        from torsionnet.model.sections import ELEMENTS

        elements, _ = ELEMENTS.read({name: self.scope.table("elements")[name]})
        return elements[name].ports if name in elements else {}

    def __iter__(self) -> Iterator[str]:
        return iter(self.scope.table("elements"))

    def __len__(self) -> int:
        return len(self.scope.table("elements"))


@dataclass(frozen=True, eq=False)
class Recorder(Renaming):
    """Renaming that leaves all names as they are and keeps a list of them."""

    kept: list[Mention] = field(default_factory=list)

    def _kept(self, kind: str, name: str, part: str = "") -> str:
        self.kept.append(Mention(kind, name, part))
        return name

    def own(self, name: str) -> str:
        return self._kept("parameter", name)

    def element(self, name: str) -> str:
        return self._kept("element", name)

    def parameter(self, name: str) -> str:
        return self._kept("parameter", name)

    def channel(self, name: str) -> str:
        return self._kept("channel", name)

    def excitation(self, name: str) -> str:
        return self._kept("excitation", name)

    def part(self, name: str) -> str:
        return self._kept("part", name)

    def port(self, part: str, name: str) -> str:
        return self._kept("node", name, part)

    def part_parameter(self, part: str, name: str) -> str:
        return self._kept("parameter", name, part)

    def changed_entry(self, name: str) -> str:
        return self._kept(CHANGED, name)

    def configuration(self, name: str) -> str:
        for choice in name.split(","):
            axis, sign, alternative = choice.rpartition("=")
            if sign:
                self._kept("axis", axis.strip())
            self._kept("configuration", alternative.strip(), axis.strip())
        return name

    def node(self, name: str) -> str:
        return self._kept("node", name)

    def mentions(self, spec: Spec[Any], raw: object) -> list[Mention]:
        """Mentions in the value of an entry as a file gives it, in the order of the text; none where it is faulty."""
        self.kept.clear()
        try:
            value, faults = spec.read(raw)
            if value is not None and not faults:
                spec.renamed(value, self)
        except (TorsionnetError, ArithmeticError):  # as of sizes that only the reading of the whole model refuses
            self.kept.clear()
        return list(self.kept)


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
    raw = parts.get(part) if isinstance(parts, Mapping) else None
    return Scope(("parts", part), raw) if isinstance(raw, Mapping) else None


def _thing(kind: str, name: str, scope: Scope, root: LocatedNode) -> Iterator[NameHome]:
    """Thing of a model or part, or pieces of a name as ``left.hub`` and ``damper.ring``."""
    section, kind = _section(kind, name, scope)
    if "." not in name or name in scope.table(section):
        yield NameHome(kind, name, (*scope.path, section, name))
        return
    first, _, rest = name.partition(".")
    # The first piece is a use: the rest is a name within its part.
    use = used_as(first, scope)
    if use is not None:
        yield NameHome("use", use, (*scope.path, "use", use))
        entries = scope.table("use")[use]
        inner = part_scope(str(entries.get("part")), root) if isinstance(entries, Mapping) else None
        for piece in _thing(kind, rest, inner, root) if inner else ():
            yield piece._replace(start=piece.start + len(first) + 1)
        return
    # Else the first pieces are an element, and the last names something within it.
    owner = next((piece for piece in _heads(name) if piece in scope.table("elements")), None)
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
    sections: list[ChangedSection] = []
    for section, table in changeable_sections().items():
        raw = scope.table(section).get(name)
        if raw is not None:
            cls = _class_of(table.of, raw)
            spec = dict(cls.specs()).get(entry) if cls else None
            sections.append(ChangedSection(section[:-1], name, (*scope.path, section, name), spec))
    return next((changed for changed in sections if changed.spec is not None), sections[0] if sections else None)


def _class_of(spec: Any, raw: object) -> type[Declared] | None:
    kind = raw.get(spec.key) if isinstance(raw, Mapping) else None
    cls: type[Declared] | None = spec.kinds().get(kind) if isinstance(kind, str) else None
    return cls


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
    for piece in _changed_entry(rest, inner, root) if inner else ():
        yield piece._replace(start=piece.start + len(first) + 1)


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
    for axis_name, alternatives in table.items():
        if axis in ("", axis_name) and isinstance(alternatives, Mapping) and name in alternatives:
            yield NameHome("configuration", name, (*scope.path, "configurations", axis_name, name))


# Keys of the entries that are read as a whole, as a damping measure; they name nothing in a model.


def properties_of(spec: Spec[Any]) -> Mapping[Any, Any]:
    """JSON Schema of each key of an entry that is read as a whole, empty where it has none."""
    schema: Any = spec.schema()
    definitions: Any = spec.definitions()
    for alternative in (schema, *schema.get("anyOf", ()), *definitions.values()):
        reference = alternative.get("$ref", "")
        schema_of = definitions.get(reference.rpartition("/")[2], {}) if reference else alternative
        for inner in (schema_of, *schema_of.get("anyOf", ())):
            if isinstance(inner.get("properties"), Mapping):
                properties: Mapping[Any, Any] = inner["properties"]
                return properties
    return {}


# Stretches of a text that hold the names in a value.

_WORD = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*")
_ANCHOR = re.compile(r"[&!]\S*\s+")


@dataclass(frozen=True)
class TextStretches:
    """Text of a model with the places of its values.

    Places are counted from ``first``, where the text begins after its byte order mark.
    """

    lines: TextLines
    first: int = 0

    def span(self, place: Place) -> TextSpan:
        """Stretch of the text at a place of a document."""
        line, column, end_line, end_column = place
        start = self.lines.offset(line, column + (self.first if line == 0 else 0))
        end = self.lines.offset(end_line, end_column + (self.first if end_line == 0 else 0))
        return TextSpan(start, max(start, end))

    def whole(self, place: Place) -> TextSpan:
        """Stretch of a key or scalar without quotes and anchor."""
        span = self.span(place)
        written = self.lines.text[span.start : span.end]
        anchor = _ANCHOR.match(written)
        start = span.start + (anchor.end() if anchor else 0)
        written = self.lines.text[start : span.end]
        if len(written) > 1 and written[0] in "'\"" and written[-1] == written[0]:
            return TextSpan(start + 1, span.end - 1)
        return TextSpan(start, span.end)

    def is_alias(self, place: Place) -> bool:
        """Whether a value stands for one that is written elsewhere, as ``*n``."""
        start = self.span(place).start
        return self.lines.text[start : start + 1] == "*"

    def located(self, places: Iterable[Place], names: Sequence[str]) -> list[TextSpan | None]:
        """Stretch of each name among the words at some places, None of one that is not written there.

        Names stand in the order of the text, as far as that is possible.
        """
        words = [word for place in places for word in self._words(place)]
        free = [True] * len(words)
        stretches: list[TextSpan | None] = []
        last = -1
        for name in names:
            fitting = [at for at, (word, _) in enumerate(words) if word == name and free[at]]
            # The next place behind the name before, else the first that is free.
            at = next((at for at in fitting if at > last), fitting[0] if fitting else -1)
            if at < 0:
                stretches.append(None)
                continue
            free[at], last = False, at
            stretches.append(words[at][1])
        return stretches

    def _words(self, place: Place) -> Iterator[tuple[str, TextSpan]]:
        span = self.whole(place)
        text = self.lines.text
        if self.is_alias(place):
            return
        for word in _WORD.finditer(text, span.start, span.end):
            if text[word.end() : word.end() + 1] != "(":  # a function or quantity
                yield word[0], TextSpan(*word.span())


def scalar_places(node: LocatedNode, fixed: Container[object] = ()) -> Iterator[Place]:
    """Places of the keys and scalars in a value, in the order of the text, without those of keys that are fixed."""
    if not node.entries:
        yield node.place
        return
    for key, entry in node.entries.items():
        if entry.key_place and key not in fixed:
            yield entry.key_place
        yield from scalar_places(entry)
