"""Copies of a part that one use puts into a model, with their names, nodes and values."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

from torsionnet.base.errors import EntryPath, Fault, unknown_name
from torsionnet.base.expressions import Expression
from torsionnet.model.parts.use import Use

MOST_LISTED = 12
"""Largest number of names that a message lists, so that it stays readable."""


@dataclass(frozen=True)
class Copy:
    """Copy of a part with the prefix of its names, the node of each port, and its values."""

    name: str
    nodes: Mapping[str, str]
    values: Mapping[str, Expression]


def copies(name: str, use: Use) -> tuple[Copy, ...]:
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
        yield Fault(f"{text}; give the node in at: {{{nodes}}}", path, on_key=True, defined=_ports_of(use))
    for table in ("at", "parameters"):
        for key, value in getattr(use, table).items():
            yield from _wrong_length(use, table, key, value)


def _ports_of(use: Use) -> EntryPath:
    return ("parts", use.part, "ports")


def listing(what: str, names: Collection[str]) -> str:
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
            rest = listing("ports", ports)
            fault = unknown_name(f"port of {use.part}", port, ports, path, on_key=path[0] == "at", rest=rest)
            yield replace(fault, defined=_ports_of(use))
    for key in use.parameters:
        if key not in parameters:
            path, rest = ("parameters", key), listing("parameters", parameters)
            yield unknown_name(f"parameter of {use.part}", key, parameters, path, on_key=True, rest=rest)


def _wrong_length(use: Use, table: str, key: str, value: Any) -> Iterator[Fault]:
    if not isinstance(value, tuple):
        return
    path = (table, key)
    if use.repeat is None:
        yield Fault(f"a list for {key} needs repeat: {len(value)}; without, there is one copy and one value", path)
    elif use.chain and table == "at" and key == use.chain[1]:
        yield Fault(f"{key} is the end of a chain, one node; a list of nodes names those of {use.chain[0]}", path)
    elif len(value) != use.repeat:
        text = f"{key} has {len(value)} values for {use.repeat} copies"
        yield Fault(f"{text}; give {use.repeat}, or one for all", path)
