"""Base class of excitations that impose a twist in an element, as errors of teeth and universal joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from torsionnet.base.entries.spec import entry
from torsionnet.base.errors import EntryPath
from torsionnet.machinery.excitations.order_excitation import OrderExcitation
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.elements import GROUND, Element


@dataclass(frozen=True, kw_only=True)
class TwistExcitation(OrderExcitation):
    """Base class of excitations by a twist in one element, with the orders of a shaft at one of its ends."""

    element_field: ClassVar[str] = ""
    """Name of the entry that names the twisted element, in the class of an excitation."""

    speed_of: str | None = entry(
        NodeName(
            "the wheel or input shaft whose angles and revolutions are meant; default: the first node of the element",
            allow_ground=False,
        ),
        None,
    )

    common: ClassVar[tuple[str, ...]] = ("enabled", "speed_of")

    @property
    def shaft(self) -> str:
        return str(self.speed_of or "")

    @property
    def quantity(self) -> str:
        return "twist"

    @property
    def element_entry(self) -> tuple[EntryPath, str]:
        return (self.element_field,), getattr(self, self.element_field)

    def with_element_data(self, elements: Mapping[str, Element]) -> Self:
        element = elements.get(self.element_entry[1])
        if self.speed_of or element is None:
            return self
        return replace(self, speed_of=next(iter(shafts_of(element)), None))


def shafts_of(element: Element) -> list[str]:
    """Names of an element's nodes without the ground."""
    return [node for node in element.ports.values() if node != GROUND]
