"""Planetary sets that a model builds from single gears, recognised by their planets and drawn as one box."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from torsionnet.model.elements import GROUND, Element, Gear

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain

MESHES_OF_PLANET = 2  # with the sun and with the ring


@dataclass(frozen=True)
class EpicyclicSet:
    """Planetary set of gears on one moving housing, the carrier, whose planets mesh with a sun and with a ring.

    ``planets`` are the nodes of the planets, ``bodies`` the elements on these nodes alone.
    """

    kind: ClassVar[str] = "epicyclic"
    glyph: ClassVar[str] = "planetary"

    name: str
    ports: Mapping[str, str]
    sun_meshes: tuple[Element, ...]
    ring_meshes: tuple[Element, ...]
    planets: tuple[str, ...]
    bodies: tuple[Element, ...]

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        """Names of the nodes inside the box of a planetary set, which the schematic does not draw: the planets."""
        return self.planets

    @property
    def elements(self) -> tuple[Element, ...]:
        """Elements inside the schematic's box of a planetary set, its meshes and the inertias of its planets."""
        return (*self.sun_meshes, *self.ring_meshes, *self.bodies)


BoxElement: TypeAlias = Element | EpicyclicSet
"""Element, or planetary set of several elements, that a schematic draws as a box with three or more ports."""


def epicyclic_sets(drivetrain: Drivetrain) -> list[EpicyclicSet]:
    """List of the planetary sets of a drivetrain in the order of their planets.

    Planets between the same members are one set.
    """
    found: dict[tuple[str, str, str], list[tuple[str, Element, Element]]] = {}
    at = _at_nodes(drivetrain.elements.values())
    for node, elements in at.items():
        meshes = _meshes(node, elements, drivetrain.exact_values)
        if meshes is not None:
            sun, ring = meshes
            key = (_mate(sun, node), _mate(ring, node), sun.ports["housing"])
            found.setdefault(key, []).append((node, sun, ring))
    # A planet that is also the sun of another set cannot be hidden in a box.
    inner = {node for planets in found.values() for node, _, _ in planets}
    return [_set(key, planets, at) for key, planets in found.items() if not inner & set(key)]


def _set(
    key: tuple[str, str, str], planets: list[tuple[str, Element, Element]], at: Mapping[str, list[Element]]
) -> EpicyclicSet:
    nodes, suns, rings = zip(*planets, strict=True)
    meshes = {*suns, *rings}
    bodies = tuple(element for node in nodes for element in at[node] if element not in meshes)
    return EpicyclicSet(
        suns[0].name, dict(zip(("sun", "ring", "carrier"), key, strict=True)), suns, rings, nodes, bodies
    )


def _at_nodes(elements: Iterable[Element]) -> dict[str, list[Element]]:
    at: dict[str, list[Element]] = {}
    for element in elements:
        for node in dict.fromkeys(element.ports.values()):
            if node != GROUND:
                at.setdefault(node, []).append(element)
    return at


def _meshes(node: str, elements: list[Element], values: Mapping[str, Any]) -> tuple[Element, Element] | None:
    """Two gear pairs of a planet, with its sun (external) and its ring (internal); None if the node is no planet."""
    gears = [element for element in elements if isinstance(element, Gear)]
    alone = all(element in gears or _is_alone(element) for element in elements)
    if len(gears) != MESHES_OF_PLANET or not alone or len({gear.housing for gear in gears}) > 1:
        return None
    if gears[0].housing in (None, GROUND, node) or any(node not in gear.nodes for gear in gears):
        return None
    external = [gear for gear in gears if float(gear.ratio_value(dict(values))) < 0]
    internal = [gear for gear in gears if gear not in external]
    if len(external) != 1 or _mate(external[0], node) in (_mate(internal[0], node), GROUND):
        return None
    return external[0], internal[0]


def _is_alone(element: Element) -> bool:
    """Whether an element acts on a single node, not counting ground."""
    return len([node for node in dict.fromkeys(element.ports.values()) if node != GROUND]) == 1


def _mate(gear: Element, node: str) -> str:
    first, second = list(gear.ports.values())[:2]
    return second if first == node else first
