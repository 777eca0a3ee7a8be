"""Typed content of a model file, a model's definition, before its sections are checked against each other.

Here as well: definitions with values and tangents at an operating point.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import torsionnet.model.sections as sections
from torsionnet.base.entries.declared import FORMAT_VERSION, KEY, Declared
from torsionnet.base.entries.spec import Json, Schema, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.base.packages import imported
from torsionnet.base.registers import settle
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.configurations import Overlay
from torsionnet.model.elements import GROUND, Element
from torsionnet.model.operating_point import OPERATING_POINT, OperatingPoint
from torsionnet.model.parameters import Parameter, resolve

if TYPE_CHECKING:
    from torsionnet.bench.plan import Plan
    from torsionnet.machinery.excitations import OrderExcitation
    from torsionnet.machinery.excitations.speed_range import SpeedRange
    from torsionnet.machinery.limits import Limit
    from torsionnet.model.balanced_state import BalancedState
    from torsionnet.model.load.load_section import Load
    from torsionnet.model.parts.part import Part, Use
    from torsionnet.motion.scenarios.scenario import Scenario
    from torsionnet.report.plan.report_plan import ReportPlan

LOAD = "load"
"""Prefix of the load's entries in a configuration, as in ``load.power``; no excitation can have this name."""
SPEEDS = "speeds"
"""Prefix of the entries of ``speeds:`` in a configuration, as in ``speeds.range``."""
EXCITATIONS = "excitations"
ELEMENTS = "elements"
SCENARIOS = "scenarios"
SINGLE_SECTIONS = (LOAD, SPEEDS)
"""Sections that a configuration names by their key, as they stand once in a model."""


class Tangents(Protocol):
    """Interface of an operating point about which the laws of motion of a model are linear."""

    def linear(self, elements: Sequence[Element]) -> tuple[Element, ...]:
        """Elements with the tangents of their laws of motion at the operating point."""

    @property
    def state(self) -> BalancedState:
        """State of all laws of motion about which they are linear."""

    @property
    def states(self) -> tuple[BalancedState, ...]:
        """States of all laws of motion that are in balance, of which one is chosen."""

    @property
    def is_loaded(self) -> bool:
        """Whether torques or speeds are given."""

    @property
    def given_speeds(self) -> Mapping[str, float]:
        """Mean speed in rad/s by node of those that are given."""

    def depends_on(self, names: frozenset[str]) -> bool:
        """Whether the state may change with some parameters."""

    def of(self, definition: Definition) -> Tangents:
        """Operating point of the model with other entries, asked for in the same way."""

    def with_values(self, values: Mapping[str, float]) -> Tangents:
        """Operating point of the model with some parameters at other values in SI units."""


class Authored(Protocol):
    """Interface of a model as written, with parts, from which a flat definition was made."""

    @property
    def authored(self) -> Definition:
        """Definition of the model as written, before its parts are put in."""

    def data(self, flat: Definition) -> dict[str, Any]:
        """Entries of a model file that give the flat definition ``flat``, written with parts as far as possible."""


@dataclass(frozen=True)
class Definition(Declared):
    """A lumped-parameter torsional model of a drivetrain, as typed values."""

    kind: ClassVar[str] = "model"
    article: ClassVar[str] = "a model"
    head: ClassVar[tuple[str, ...]] = (KEY,)

    name: str = entry(Text("title of the model"), "unnamed")
    source: str = entry(Text("where the numbers come from"), "")
    description: str = entry(Text("what the model is"), "")
    parameters: Mapping[str, Parameter] = entry(sections.PARAMETERS, None)
    elements: Mapping[str, Element] = entry(sections.ELEMENTS, None)
    include: tuple[str, ...] = entry(sections.INCLUDE, ())
    parts: Mapping[str, Part] = entry(sections.PARTS, None)
    use: Mapping[str, Use] = entry(sections.USE, None)
    ports: tuple[str, ...] = entry(sections.PORTS, ())
    inputs: Mapping[str, Input] = entry(sections.INPUTS, None)
    sensors: Mapping[str, Sensor] = entry(sections.SENSORS, None)
    configurations: Mapping[str, Mapping[str, Overlay]] = entry(sections.CONFIGURATIONS, None)
    operating_point: OperatingPoint = entry(OPERATING_POINT, OperatingPoint())
    speeds: SpeedRange | None = entry(sections.SPEEDS, None)
    load: Load | None = entry(sections.LOAD, None)
    excitations: Mapping[str, OrderExcitation] = entry(sections.EXCITATIONS, None)
    limits: Mapping[str, Limit] = entry(sections.LIMITS, None)
    scenarios: Mapping[str, Scenario] = entry(sections.SCENARIOS, None)
    bench: Plan | None = entry(sections.BENCH, None)
    report: ReportPlan | None = entry(sections.REPORT, None)
    authored: Authored | None = field(default=None, compare=False, repr=False)
    """Model as written, if this is the definition with all parts put in, else None."""
    tangents: Tangents | None = field(default=None, compare=False, repr=False)
    """Operating point about which laws of motion are linear; None: at rest without twist."""
    written: Definition | None = field(default=None, compare=False, repr=False)
    """Model as written, if this is the definition with alternatives of its configurations, else None."""
    is_asked: bool = field(default=False, compare=False, repr=False)
    """Whether a call has given the operating point, which then holds against working points of elements."""

    def __post_init__(self) -> None:
        """Accept the typed values of the definition as they are, without checks.

        Reading them again would cost as much as reading the file.
        """
        self.settle_absent()
        if self.excitations:
            fitted = {name: source.with_element_data(self.elements) for name, source in self.excitations.items()}
            settle(self, excitations=fitted)

    @property
    def is_flat(self) -> bool:
        """Whether the definition of the model has no parts, and no element that stands for several elements."""
        if self.use or self.parts:
            return False
        return all(element.expanded() == (element,) for element in self.elements.values())

    @cached_property
    def active(self) -> tuple[Element, ...]:
        """Elements that are switched on, with values at their own shafts and tangents of their laws of motion."""
        return self.switched_on if self.tangents is None else self.tangents.linear(self.switched_on)

    @cached_property
    def switched_on(self) -> tuple[Element, ...]:
        """Elements that are switched on, with values quoted at another shaft converted to their own shaft.

        Laws of motion are linear at rest without twist.
        """
        on = tuple(element for element in self.elements.values() if element.enabled)
        if all(element.referred_to is None for element in on):
            return on
        from torsionnet.model.referral import at_own_speeds

        return at_own_speeds(on, resolve(self.parameters)[0])

    @property
    def following(self) -> dict[str, Parameter]:
        """Parameters that follow the operating point, by name."""
        return {name: parameter for name, parameter in self.parameters.items() if parameter.by is not None}

    @property
    def has_overrides(self) -> bool:
        """Whether alternatives of configurations change entries of elements or sections, as ``box.engaged``."""
        return any(overlay.entries for axis in self.configurations.values() for overlay in axis.values())

    @property
    def follows_speed(self) -> bool:
        """Whether parameters, or tangents of laws of motion under a load, differ from speed to speed."""
        return bool(self.following) or (self.load is not None and self.tangents is not None)

    def with_overlay(self, overlay: Overlay) -> Definition:
        """Definition of the model with the changes of an alternative."""
        parameters = dict(self.parameters)
        for name, value in overlay.parameters.items():
            parameters[name] = parameters[name].given(value)
        switched = dict.fromkeys(overlay.on, True) | dict.fromkeys(overlay.off, False)
        elements = {
            name: replace(element, enabled=switched[name]) if name in switched else element
            for name, element in self.elements.items()
        }
        point = self.operating_point.with_overlay(overlay.operating_point)
        changed = replace(
            self,
            parameters=parameters,
            operating_point=point,
            written=self.written or self,
            **self._overridden(overlay.entries, elements),
        )
        return changed if overlay.at is None else changed.at(overlay.at)

    def at(self, point: OperatingPoint) -> Definition:
        """Definition of the model at an operating point whose torques, if there are any, replace the load."""
        if not point.torque:
            return replace(self, operating_point=replace(self.operating_point, speed=point.speed), is_asked=True)
        speed = point.speed or self.operating_point.speed
        return replace(self, operating_point=OperatingPoint(speed, point.torque), load=None, is_asked=True)

    def _overridden(self, changes: Mapping[str, Any], elements: Mapping[str, Element]) -> dict[str, Any]:
        """Sections of the definition, by key, with changed entries put in.

        Changes are written as ``box.engaged: II``, ``engine.misfire: [3]``, ``fault.phases: 3``, ``load.power: 1 MW``,
        ``speeds.range: 250..700 rpm``.
        """
        changed: dict[str, Any] = {ELEMENTS: dict(elements), LOAD: self.load, SPEEDS: self.speeds}
        changed |= {table: dict(getattr(self, table)) for table in (EXCITATIONS, SCENARIOS)}
        # All entries of one section at once: each alone may contradict what the others change.
        for (table, name), fields in by_section(self, changes).items():
            if table in SINGLE_SECTIONS:
                changed[table] = replace(changed[table], **fields)
            else:
                changed[table][name] = replace(changed[table][name], **fields)
        return changed

    @classmethod
    def key_faults(cls, raw: Mapping[Any, Any], name: str = "") -> list[Fault]:
        """Faults of missing or unknown keys; a model needs elements, or parts with elements."""
        lacks = [] if "elements" in raw or "use" in raw else [cls.missing("elements", name)]
        return [*super().key_faults(raw, name), *lacks]

    @classmethod
    def schema(cls, *, type_key: str = "") -> Schema:
        return super().schema(type_key=type_key) | {"anyOf": [{"required": ["elements"]}, {"required": ["use"]}]}

    def to_data(self) -> dict[str, Json]:
        """Entries of the model as its file has them; reading them again gives an equal definition."""
        return self.flat_data() if self.authored is None else self.authored.data(self)

    def flat_data(self) -> dict[str, Json]:
        """Entries of a model file without parts, with dots in the names of what parts contain."""
        return {KEY: FORMAT_VERSION, "name": self.name, **self.written_entries()}


def section_of(definition: Definition, key: str) -> tuple[str, str, Declared] | None:
    """Table, name and section of the model to which a key as ``box.engaged`` belongs; None if no section has that name.

    Of an excitation, an element and a scenario of one name it is the first of these that has such an entry.
    """
    name, _, entry = key.rpartition(".")
    single = getattr(definition, name) if name in SINGLE_SECTIONS else None
    if single is not None and (name == LOAD or name not in {*definition.excitations, *definition.elements}):
        return name, name, single
    tables: dict[str, Mapping[str, Declared]] = {
        EXCITATIONS: definition.excitations, ELEMENTS: definition.elements, SCENARIOS: definition.scenarios
    }  # fmt: skip
    owners = [(table, name, sections[name]) for table, sections in tables.items() if name in sections]
    fitting = [owner for owner in owners if entry in dict(owner[2].specs())]
    return next(iter(fitting or owners), None)


def by_section(definition: Definition, changes: Mapping[str, Any]) -> dict[tuple[str, str], dict[str, Any]]:
    """Changes of entries of elements, excitations, scenarios, load and speeds, by table and name of their section.

    They are written as ``engine.misfire: [3]``. Changes of unknown sections are left out.
    """
    by_owner: dict[tuple[str, str], dict[str, Any]] = {}
    for key, value in changes.items():
        section = section_of(definition, key)
        if section is not None:
            by_owner.setdefault(section[:2], {})[key.rpartition(".")[2]] = value
    return by_owner


def all_nodes(elements: Iterable[Element]) -> tuple[str, ...]:
    """Nodes of the elements in the order of their first mention, without ground."""
    nodes: dict[str, None] = {}
    for element in elements:
        for node in (*element.ports.values(), *element.internal_nodes):
            if node != GROUND:
                nodes[node] = None
    return tuple(nodes)


def with_operating_values(definition: Definition, values: Mapping[str, float]) -> Definition:
    """Definition of a model with given values of the parameters that follow the operating point."""
    if not values:
        return definition
    parameters = {name: definition.parameters[name].with_operating_values(value) for name, value in values.items()}
    return replace(definition, parameters={**definition.parameters, **parameters})


def with_tangents(definition: Definition, speed: float | None = None) -> Definition:
    """Definition of a model whose laws of motion are linear about the operating point, worked out when first used.

    ``speed`` in rad/s is that of the reference node of a load, by default the one of tangents that are there, else that
    of the operating point. Without laws of motion the definition is unchanged.
    """
    if not any(element.enabled and element.has_motion_laws for element in definition.elements.values()):
        return definition
    if definition.tangents is not None and speed is None:
        return replace(definition, tangents=definition.tangents.of(definition))
    plain = definition if definition.tangents is None else replace(definition, tangents=None)
    return replace(plain, tangents=imported(sections.OPERATING_BALANCE)(plain, speed))
