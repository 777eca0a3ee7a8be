"""Copy of a drivetrain for a schematic that draws each copy of a part as one box."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

from torsionnet.model.definition import all_nodes
from torsionnet.model.element_base.laws import Part as LawOrConstraint
from torsionnet.model.elements import GROUND, Element, Values
from torsionnet.model.parts.copies import copies

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain


@dataclass(frozen=True, eq=False, repr=False)
class PartBox(Element):
    """Box in a schematic that stands for all elements of one copy of a part; it has no laws."""

    glyph: ClassVar[str] = "part"

    joined: tuple[tuple[str, str], ...] = ()
    inner: tuple[str, ...] = ()

    @property
    def ports(self) -> dict[str, str]:
        return dict(self.joined)

    def own_parts(self, value: Values) -> tuple[LawOrConstraint, ...]:
        del value
        return ()

    @property
    def internal_nodes(self) -> tuple[str, ...]:
        return self.inner


def with_part_boxes(drivetrain: Drivetrain) -> Drivetrain:
    """Copy of a drivetrain with one box as element in place of each copy of a part; itself if it uses no parts.

    Sensors on elements within a part are not drawn; motions of its nodes stand at its first port.
    """
    definition = drivetrain.definition
    if definition.authored is None or not definition.authored.authored.use:
        return drivetrain
    elements = dict(definition.elements)
    for use_name, use in definition.authored.authored.use.items():
        for copy in copies(use_name, use):
            prefix = f"{copy.name}."
            inside = [one for name, one in definition.elements.items() if name.startswith(prefix)]
            outer = {*copy.nodes.values(), GROUND}
            inner = tuple(node for node in all_nodes(inside) if node not in outer)
            elements = {name: one for name, one in elements.items() if not name.startswith(prefix)}
            elements[copy.name] = PartBox(
                copy.name, description=use.part, joined=tuple(copy.nodes.items()), inner=inner
            )
    sensors = {name: one for name, one in definition.sensors.items() if not one.is_on_element or one.of in elements}
    drawn = replace(definition, elements=elements, sensors=sensors, excitations={}, limits={}, load=None, authored=None)
    return drivetrain.with_definition(drawn)
