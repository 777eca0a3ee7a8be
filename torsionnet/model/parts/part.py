"""Part as its author wrote it, with ports, parameters and elements, before a model uses it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Self

import torsionnet.model.sections as sections
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.configurations import Overlay
from torsionnet.model.elements import Element
from torsionnet.model.parameters import Parameter
from torsionnet.model.parts.use import Use

if TYPE_CHECKING:
    from torsionnet.machinery.excitations.order_excitation import OrderExcitation
    from torsionnet.machinery.limits.limit import Limit


@dataclass(frozen=True, kw_only=True)
class Part(Declared):
    """A model with ports, to be put into others."""

    kind: ClassVar[str] = "part"
    article: ClassVar[str] = "a part"
    form: ClassVar[str] = "{ports: [inner, outer], parameters: {k: 9 kN*m/rad}, elements: {...}}"

    ports: tuple[str, ...] = entry(sections.PORTS)
    source: str = entry(Text("where the numbers come from"), "")
    description: str = entry(Text("what the part is"), "")
    parameters: Mapping[str, Parameter] = entry(sections.PARAMETERS, None)
    elements: Mapping[str, Element] = entry(sections.ELEMENTS, None)
    use: Mapping[str, Use] = entry(sections.USE, None)
    inputs: Mapping[str, Input] = entry(sections.INPUTS, None)
    sensors: Mapping[str, Sensor] = entry(sections.SENSORS, None)
    configurations: Mapping[str, Mapping[str, Overlay]] = entry(sections.CONFIGURATIONS, None)
    excitations: Mapping[str, OrderExcitation] = entry(sections.EXCITATIONS, None)
    limits: Mapping[str, Limit] = entry(sections.LIMITS, None)

    def __post_init__(self) -> None:
        """Accept the typed values of the part as they are, without checks."""
        self.settle_absent()

    @classmethod
    def read(cls, raw: object) -> tuple[Self | None, list[Fault]]:
        """Part of a model as far as it could be read, and every fault."""
        if isinstance(raw, cls) or not isinstance(raw, Mapping):
            return super().read(raw)
        values, faults = cls.read_entries(raw)
        if "elements" not in raw and "use" not in raw:
            faults.append(cls.missing("elements"))
        return cls(**{"ports": (), **values}), faults
