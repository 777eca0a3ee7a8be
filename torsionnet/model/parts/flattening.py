"""Flattening of a model that uses parts to one model without parts, with dots in its names."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import Any

from torsionnet.base.entries.declared import names_a_file
from torsionnet.base.entries.spec import Renaming
from torsionnet.base.errors import EntryPath, Fault, ModelError, UsageError, unknown_name
from torsionnet.base.expressions import Expression
from torsionnet.model.configurations import DEFAULT_AXIS, Overlay
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.elements import GROUND, Element
from torsionnet.model.parts.part import Part, Use

# Copies of a part that one use puts into a model, with their names, nodes and values.

MOST_LISTED = 12
"""Largest number of names that a message lists, so that it stays readable."""


@dataclass(frozen=True)
class Copy:
    """Copy of a part with the prefix of its names, the node of each port, and its values."""

    name: str
    nodes: Mapping[str, str]
    values: Mapping[str, Expression]


def copies_of_part(name: str, use: Use) -> tuple[Copy, ...]:
    """Copies of the part that a use without faults puts into a model."""
    prefixes = use.prefixes(name)
    return tuple(
        Copy(
            prefix,
            {port: _node(prefixes, use, port, index) for port in _joined(use)},
            {key: _one(value, index) for key, value in use.parameters.items()},
        )
        for index, prefix in enumerate(prefixes)
    )


def _joined(use: Use) -> tuple[str, ...]:
    return tuple(dict.fromkeys([*use.at, *(use.chain or ())]))


def _node(prefixes: tuple[str, ...], use: Use, port: str, index: int) -> str:
    """Name of the node to which a port of one copy is attached.

    Within a chain the rear of a copy is the front of the next one.
    """
    if use.chain is not None:
        front, rear = use.chain
        if port == rear and index < len(prefixes) - 1:
            port, index = front, index + 1
        if port == front and index > 0 and not isinstance(use.at[front], tuple):
            return f"{prefixes[index]}.{front}"
    node: str = _one(use.at[port], index)
    return node


def _one(value: Any, index: int) -> Any:
    return value[index] if isinstance(value, tuple) else value


def use_faults(use: Use, ports: Collection[str], parameters: Collection[str]) -> Iterator[Fault]:
    """Faults of a use that contradict the ports and parameters of the part it names."""
    yield from _unknown(use, ports, parameters)
    missing = [port for port in ports if port not in _joined(use)]
    missing += [port for port in use.chain or () if port in ports and port not in use.at]
    if missing:
        nodes = ", ".join(f"{port}: ..." for port in missing)
        text = f"port{'s' if len(missing) > 1 else ''} {', '.join(missing)} of {use.part} not connected"
        path: EntryPath = ("at",) if use.at else ()
        yield Fault(
            f"{text}; give the node in at: {{{nodes}}}", path, on_key=True, defined=_ports_of(use), kind="missing-entry"
        )
    for table in ("at", "parameters"):
        for key, value in getattr(use, table).items():
            yield from _wrong_length(use, table, key, value)


def _ports_of(use: Use) -> EntryPath:
    return ("parts", use.part, "ports")


def shortened_listing(what: str, names: Collection[str]) -> str:
    """Text that lists names of one kind, shortened to the first of them where there are many.

    ``the nodes are a, b``.
    """
    shown = [*islice(names, MOST_LISTED), *(["..."] if len(names) > MOST_LISTED else [])]
    return f"the {what} are {', '.join(shown)}" if names else f"there are no {what}"


def _unknown(use: Use, ports: Collection[str], parameters: Collection[str]) -> Iterator[Fault]:
    named: list[tuple[str, EntryPath]] = [(port, ("at", port)) for port in use.at]
    named += [(port, ("chain", index)) for index, port in enumerate(use.chain or ())]
    for port, path in named:
        if port not in ports:
            rest = shortened_listing("ports", ports)
            fault = unknown_name(f"port of {use.part}", port, ports, path, on_key=path[0] == "at", rest=rest)
            yield replace(fault, defined=_ports_of(use))
    for key in use.parameters:
        if key not in parameters:
            path, rest = ("parameters", key), shortened_listing("parameters", parameters)
            yield unknown_name(f"parameter of {use.part}", key, parameters, path, on_key=True, rest=rest)


def _wrong_length(use: Use, table: str, key: str, value: Any) -> Iterator[Fault]:
    if not isinstance(value, tuple):
        return
    path = (table, key)
    if use.repeat is None:
        yield Fault(
            f"a list for {key} needs repeat: {len(value)}; without, there is one copy and one value",
            path,
            kind="wrong-form",
        )
    elif use.chain and table == "at" and key == use.chain[1]:
        yield Fault(
            f"{key} is the end of a chain, one node; a list of nodes names those of {use.chain[0]}",
            path,
            kind="wrong-form",
        )
    elif len(value) != use.repeat:
        text = f"{key} has {len(value)} values for {use.repeat} copies"
        yield Fault(f"{text}; give {use.repeat}, or one for all", path, kind="wrong-count")


SECTIONS = ("parameters", "elements", "inputs", "sensors", "configurations", "excitations", "limits")
"""Names of the sections of a model that a part may have too."""
MOST_ENTRIES = 10_000
"""Largest number of entries of a flat model, as parts that hold each other could be more than memory holds."""
MOST_LEVELS = 20
"""Deepest nesting of parts in parts, far beyond any drivetrain, to bound the recursion."""


@dataclass
class PartContent:
    """Elements, parameters and other contents of a model or a part, by section."""

    parameters: dict[str, Any] = field(default_factory=dict)
    elements: dict[str, Any] = field(default_factory=dict)
    inputs: dict[str, Any] = field(default_factory=dict)
    sensors: dict[str, Any] = field(default_factory=dict)
    configurations: dict[str, Any] = field(default_factory=dict)
    excitations: dict[str, Any] = field(default_factory=dict)
    limits: dict[str, Any] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Number of entries in all sections of the part."""
        return sum(len(getattr(self, section)) for section in SECTIONS)


def flatten_parts(definition: Definition, *, whole: bool = True) -> tuple[Definition, list[Fault]]:
    """Definition of a model whose parts are put in, and the faults of parts that could not be.

    Faults have the paths of the definition as it was written.
    """
    if definition.is_flat:
        return definition, []
    reader = _Flattening(definition.parts, whole)
    content = reader.content(definition, (), ())
    if whole:  # a use that could not be read may be of any part
        reader.unused(definition.parts)
    flat = replace(definition, **{name: getattr(content, name) for name in SECTIONS}, parts={}, use={})
    return flat, reader.faults


class _Flattening:
    """Flattening of one model, in which each part is put together once, whatever the number of its uses."""

    def __init__(self, parts: Mapping[str, Part], whole: bool) -> None:
        self.parts = parts
        self.whole = whole
        self.done: dict[str, PartContent] = {}
        self.without_ports: set[str] = set()
        self.faults: list[Fault] = []
        self.uses: tuple[EntryPath, ...] = ()

    def tell(self, *faults: Fault) -> None:
        """Add faults of a part, each with the uses that led to it, outermost first."""
        self.faults += [replace(fault, uses=self.uses) for fault in faults]

    def unused(self, parts: Mapping[str, Part]) -> None:
        for name in parts:
            if name not in self.done:
                text = f'part "{name}" is not used'
                self.faults.append(Fault(text, ("parts", name), "warning", on_key=True, about=name, kind="unused-name"))

    def content(self, owner: Definition | Part, path: EntryPath, within: tuple[str, ...]) -> PartContent:
        """Elements, parameters and other contents of a model or a part with everything it uses."""
        content = PartContent(**{name: dict(getattr(owner, name)) for name in SECTIONS})
        _expand(content)
        for name, use in owner.use.items():
            place = (*path, "use", name)
            if self.is_known(use, place, within):
                outer, self.uses = self.uses, (*self.uses, place)
                part = self.part(use.part, (*within, use.part))
                self.uses = outer
                if self.is_joined(use, place):
                    self.put(content, name, use, part, place)
        return content

    def is_known(self, use: Use, place: EntryPath, within: tuple[str, ...]) -> bool:
        if use.part not in self.parts:
            rest = "a file goes into include:, its part then has the name of the file" if names_a_file(use.part) else ""
            self.tell(unknown_name("part", use.part, self.parts, (*place, "part"), rest=rest))
            return False
        if use.part in within:
            circle = " -> ".join([*within[within.index(use.part) :], use.part])
            self.tell(
                Fault(
                    f"a part cannot contain itself: {circle}; leave out one of these uses",
                    (*place, "part"),
                    kind="circular-definition",
                )
            )
            return False
        if len(within) == MOST_LEVELS:
            text = f"parts are nested more than {MOST_LEVELS} levels deep; put some of them together"
            self.tell(Fault(text, (*place, "part"), kind="too-large"))
            return False
        return True

    def is_joined(self, use: Use, place: EntryPath) -> bool:
        part = self.parts[use.part]
        wrong = [fault.under(*place) for fault in use_faults(use, part.ports, self.done[use.part].parameters)]
        if self.whole and use.part not in self.without_ports:
            self.tell(*wrong)
        return not wrong and use.part not in self.without_ports

    def part(self, name: str, within: tuple[str, ...]) -> PartContent:
        if name not in self.done:
            part, before = self.parts[name], len(self.faults)
            self.done[name] = self.content(part, ("parts", name), within)
            nodes = all_nodes(self.done[name].elements.values())
            if len(self.faults) > before:
                # Something is missing in it, and perhaps its ports with that.
                nodes = (*nodes, *part.ports)
                self.without_ports.add(name)
            rest = shortened_listing(f"nodes of {name}", nodes)
            shafts = {*_quoting_shafts(self.done[name])}
            wrong = [
                unknown_name("node", port, nodes, ("parts", name, "ports", index), rest=rest)
                for index, port in enumerate(part.ports)
                if port not in nodes and port not in shafts
            ]
            if wrong:
                self.without_ports.add(name)
                # A part that is not joined is not read any further, where this would be found.
                wrong += [
                    unknown_name("node", quoted.referred_to, {*nodes, *part.ports}, (*path, "referred_to"), rest=rest)
                    for path, quoted in _referred(part, name)
                    if quoted.referred_to not in nodes and quoted.referred_to not in part.ports
                ]
            self.tell(*(wrong if self.whole else []))
        return self.done[name]

    def put(self, whole: PartContent, name: str, use: Use, part: PartContent, place: EntryPath) -> None:
        count = whole.size + part.size * (use.repeat or 1)
        if count > MOST_ENTRIES:
            text = f"this makes {count} entries (elements, parameters, sensors, ...); a model may have {MOST_ENTRIES}"
            self.tell(Fault(text, place, on_key=True, kind="too-large"))
            return
        for copy in copies_of_part(name, use):
            if copy.name in whole.elements:
                text = f'"{copy.name}" is an element; what is used needs another name'
                self.tell(Fault(text, place, on_key=True, about=copy.name, kind="repeated-name"))
                return
            for section, entries in self.renamed(copy, part).items():
                table = getattr(whole, section)
                twice = next((key for key in entries if key in table), None)
                if twice is not None:
                    text = f'"{twice}" is already there among the {section}; use the part under another name'
                    self.tell(Fault(text, place, on_key=True, about=twice, kind="repeated-name"))
                    return
                table.update(entries)

    def renamed(self, copy: Copy, part: PartContent) -> dict[str, dict[str, Any]]:
        names = Renaming(
            f"{copy.name}.",
            {**copy.nodes, GROUND: GROUND},
            {*part.sensors, *part.inputs},
            {name: element.ports for name, element in part.elements.items()},
        )
        renamed: dict[str, dict[str, Any]] = {section: {} for section in SECTIONS}
        for section in SECTIONS:
            for name, value in getattr(part, section).items():
                own = names.own(name)
                try:
                    if section == "configurations":
                        axis = copy.name if name == DEFAULT_AXIS else own
                        renamed[section][axis] = {
                            label: _overlay(overlay, names, part) for label, overlay in value.items()
                        }
                    else:
                        renamed[section][own] = value.renamed(names)
                except ModelError as error:
                    paths = [(section, own, *_below(fault.path, section)) for fault in error.faults]
                    self.faults += [replace(fault, path=path) for fault, path in zip(error.faults, paths, strict=True)]
                except UsageError as error:
                    self.faults.append(error.fault.under(section, own))
        for name, value in copy.values.items():
            own = names.own(name)
            renamed["parameters"][own] = renamed["parameters"][own].given(value)
        return renamed


def _quoting_shafts(content: PartContent) -> Iterator[str]:
    """Names of nodes at whose speed values of a part are quoted, or to which its readings are referred."""
    for quoted in (*content.elements.values(), *content.sensors.values()):
        if quoted.referred_to is not None:
            yield quoted.referred_to


def _referred(part: Part, name: str) -> Iterator[tuple[EntryPath, Any]]:
    """Path and object of elements and sensors of a part whose values are quoted at the speed of a shaft."""
    for section in ("elements", "sensors"):
        for key, quoted in getattr(part, section).items():
            if quoted.referred_to is not None:
                yield ("parts", name, section, key), quoted


def _below(path: EntryPath, section: str) -> EntryPath:
    """Path within an entry of a part, without the section and the name with which faults of elements begin."""
    return path[2:] if path[:1] == (section,) else path


def _overlay(overlay: Overlay, names: Renaming, part: PartContent) -> Overlay:
    """Changes by an alternative of a part, with the names of the whole model.

    Entries of excitations are read, renamed and written.
    """
    entries = {}
    for key, raw in overlay.entries.items():
        name, _, own = key.rpartition(".")
        spec = dict(part.excitations[name].specs()).get(own) if name in part.excitations else None
        value, faults = spec.read(raw) if spec is not None else (None, [])
        entries[key] = raw if spec is None or faults else spec.plain(spec.renamed(value, names))
    return replace(overlay, entries=entries).renamed(names)


def _expand(content: PartContent) -> None:
    """Replace elements that stand for several by these, also where configurations switch them."""
    groups: dict[str, tuple[Element, ...]] = {}
    elements: dict[str, Element] = {}
    for name, element in content.elements.items():
        group = element.expanded()
        if group != (element,):
            groups[name] = group
        elements.update({member.name: member for member in group})
    if groups:
        content.elements = elements
        content.configurations = {
            axis: {label: _switched(overlay, groups) for label, overlay in alternatives.items()}
            for axis, alternatives in content.configurations.items()
        }


def _switched(overlay: Overlay, groups: Mapping[str, tuple[Element, ...]]) -> Overlay:
    return replace(overlay, on=tuple(_members(overlay.on, groups)), off=tuple(_members(overlay.off, groups)))


def _members(names: tuple[str, ...], groups: Mapping[str, tuple[Element, ...]]) -> Iterator[str]:
    for name in names:
        yield from (member.name for member in groups[name]) if name in groups else (name,)
