"""Renaming of a part's own names to the names that they have in the model using the part."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from torsionnet.core.expressions import Expression


@dataclass(frozen=True, eq=False)
class Renaming:
    """Map from names of a part to names in the model that uses it.

    Attributes
    ----------
    prefix : str
        Comes before every name of the part's own, as ``left.``.
    nodes : mapping
        Nodes that keep or get another name: ports, and the ground.
    channels : collection of str
        Sensors and inputs of the part.
    ports : mapping
        Element of the part -> its ports with their nodes.
    excitations : collection of str
        Excitations of the part.
    """

    prefix: str
    nodes: Mapping[str, str]
    channels: Collection[str] = ()
    ports: Mapping[str, Mapping[str, str]] | None = None
    excitations: Collection[str] = ()

    def own(self, name: str) -> str:
        """Name in the model of an element, parameter, sensor, ... of the part."""
        return self.prefix + name

    def element(self, name: str) -> str:
        """Name in the model of an element of the part."""
        return self.own(name)

    def parameter(self, name: str) -> str:
        """Name in the model of a parameter of the part."""
        return self.own(name)

    def channel(self, name: str) -> str:
        """Name in the model of a sensor or input of the part."""
        return self.own(name)

    def excitation(self, name: str) -> str:
        """Name in the model of an excitation of the part."""
        return self.own(name)

    def part(self, name: str) -> str:
        """Name in the model of a part that the part uses, which is the same."""
        return name

    def port(self, part: str, name: str) -> str:
        """Name of a port of a part that the part uses, which is the same."""
        del part
        return name

    def part_parameter(self, part: str, name: str) -> str:
        """Name of a parameter of a part that the part uses, which is the same."""
        del part
        return name

    def changed_entry(self, name: str) -> str:
        """Name in the model of what an alternative changes, a parameter or an entry as ``engine.misfire``."""
        return self.own(name)

    def configuration(self, name: str) -> str:
        """Name in the model of a choice of alternatives, which is the same."""
        return name

    def node(self, name: str) -> str:
        """Name in the model of a node of the part."""
        return self.nodes.get(name) or self.prefix + name

    def at(self, element: str, place: str | None) -> str | None:
        """Name in the model of a place on an element: the name of a port stays, that of a node changes."""
        named = (self.ports or {}).get(element, {})
        return place if place is None or place in named else self.node(place)

    def expression(self, value: Expression) -> Expression:
        """Expression of the part's parameters with their names in the model."""
        return value.renamed(self.parameter)

    def within(self, value: Any) -> Any:
        """Value of an entry in its stored form, with the names in all its expressions changed.

        The value itself where there are none.
        """
        if isinstance(value, Expression):
            return self.expression(value)
        if type(value) is tuple:
            found = tuple(map(self.within, value))
            return value if all(new is old for new, old in zip(found, value, strict=True)) else found
        if isinstance(value, dict):
            entries = {key: self.within(one) for key, one in value.items()}
            return value if all(entries[key] is value[key] for key in value) else entries
        if hasattr(value, "renamed"):
            return value.renamed(self)
        if is_dataclass(value) and not isinstance(value, type):
            changes = {one.name: self.within(getattr(value, one.name)) for one in fields(value) if one.init}
            changes = {key: new for key, new in changes.items() if new is not getattr(value, key)}
            return replace(value, **changes) if changes else value
        return value
