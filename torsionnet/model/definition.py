"""The content of a model, read and typed but not yet checked against itself."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

from torsionnet.core.entries.composite import Named, Nested, Typed
from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.format_version import KEY, VERSION, version_faults
from torsionnet.core.entries.nearby import names_a_file
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import NAME_SCHEMA, Text, name_fault
from torsionnet.core.errors import Fault
from torsionnet.core.expression_reading import check_name
from torsionnet.model.channels import INPUT, SENSOR, Input, Sensor
from torsionnet.model.configurations import AxesEntry, Overlay
from torsionnet.model.elements import GROUND, Element
from torsionnet.model.elements.element_table import ElementTable, element_kinds
from torsionnet.model.operating_point import OPERATING_POINT, OperatingPoint
from torsionnet.model.parameters import PARAMETER, Parameter, resolve
from torsionnet.model.referral import at_own_speeds

if TYPE_CHECKING:
    from torsionnet.model.bench import Plan
    from torsionnet.model.excitations import OrderExcitation
    from torsionnet.model.excitations.speed_range import SpeedRange
    from torsionnet.model.limits import Limit
    from torsionnet.model.load.load_section import Load
    from torsionnet.model.report import ReportPlan

LOAD = "load"
"""What ``load.entry`` in a configuration means; no excitation can have this name."""
EXCITATIONS = "excitations"
ELEMENTS = "elements"


def _plan() -> type[Declared]:
    from torsionnet.model.bench.plan import Plan  # loads numpy, which most models can do without

    return Plan


def _speeds() -> type[Declared]:
    from torsionnet.model.excitations.speed_range import SpeedRange

    return SpeedRange


def _load() -> type[Declared]:
    from torsionnet.model.load.load_section import Load

    return Load


def _excitation_kinds() -> Mapping[str, type[Declared]]:
    from torsionnet.model.excitations import excitation_kinds  # loads numpy, which most models can do without

    return excitation_kinds()


def _limit_rules() -> Mapping[str, type[Declared]]:
    from torsionnet.model.limits import limit_rules

    return limit_rules()


def _report() -> type[Declared]:
    from torsionnet.model.report.report_plan import ReportPlan

    return ReportPlan


_PARAMETERS = Named(
    "named values with unit, or expressions of other parameters", PARAMETER, refused=check_name, names=NAME_SCHEMA
)
_ELEMENTS = ElementTable(
    "the parts of the drivetrain by name, each attached to nodes",
    Typed("what kind of element this is", element_kinds, "element", "element"),
    names=NAME_SCHEMA,
    fewest=1,
)
_INPUTS = Named("excitations by name", INPUT, refused=name_fault, names=NAME_SCHEMA)
_SENSORS = Named("measured quantities by name", SENSOR, refused=name_fault, names=NAME_SCHEMA)
_CONFIGURATIONS = AxesEntry("axes of alternatives, gear: {II: {tau: 7.96}}; the name of a single axis may be left out")
_SPEEDS = Nested("at which speeds running machinery is examined", _speeds, "speeds", optional=True)
_LOAD = Nested("who absorbs the power, how that follows the speed, and who drives", _load, "load", optional=True)
_EXCITATIONS = Named(
    "what runs and excites the drivetrain by orders of its speed, by name",
    Typed("what kind of excitation this is", _excitation_kinds, "excitation", "order_excitation"),
    refused=name_fault,
    names=NAME_SCHEMA,
)
_LIMITS = Named(
    "what elements may bear while the machinery runs, by name",
    Typed("which rule says so", _limit_rules, "limit", "limit", key="rule"),
    refused=name_fault,
    names=NAME_SCHEMA,
)
_BENCH = Nested("a virtual test: excitation, exciter, sensors, data acquisition", _plan, "bench", optional=True)
_REPORT = Nested("what torsionnet report writes about the model", _report, "report", optional=True)


@dataclass(frozen=True)
class Definition(Declared):
    """A lumped-parameter torsional model of a drivetrain, as typed values."""

    kind: ClassVar[str] = "model"
    article: ClassVar[str] = "a model"
    head: ClassVar[tuple[str, ...]] = (KEY,)

    name: str = entry(Text("title of the model"), "unnamed")
    source: str = entry(Text("where the numbers come from"), "")
    description: str = entry(Text("what the model is"), "")
    parameters: Mapping[str, Parameter] = entry(_PARAMETERS, None)
    elements: Mapping[str, Element] = entry(_ELEMENTS, None, must=True)
    inputs: Mapping[str, Input] = entry(_INPUTS, None)
    sensors: Mapping[str, Sensor] = entry(_SENSORS, None)
    configurations: Mapping[str, Mapping[str, Overlay]] = entry(_CONFIGURATIONS, None)
    operating_point: OperatingPoint = entry(OPERATING_POINT, OperatingPoint())
    speeds: SpeedRange | None = entry(_SPEEDS, None)
    load: Load | None = entry(_LOAD, None)
    excitations: Mapping[str, OrderExcitation] = entry(_EXCITATIONS, None)
    limits: Mapping[str, Limit] = entry(_LIMITS, None)
    bench: Plan | None = entry(_BENCH, None)
    report: ReportPlan | None = entry(_REPORT, None)

    def __post_init__(self) -> None:
        """The values are typed already; reading them once more would cost as much as the file."""
        for name, stored in self.defaults().items():
            if getattr(self, name) is None:
                object.__setattr__(self, name, stored)
        if self.excitations:
            fitted = {name: one.fitted(self.elements) for name, one in self.excitations.items()}
            object.__setattr__(self, "excitations", fitted)

    @cached_property
    def active(self) -> tuple[Element, ...]:
        """The elements that are switched on, with the values of their own shafts where they are quoted at another."""
        on = tuple(element for element in self.elements.values() if element.enabled)
        if all(element.referred_to is None for element in on):
            return on
        return at_own_speeds(on, resolve(self.parameters)[0])

    def overlaid(self, overlay: Overlay) -> Definition:
        """The definition with one alternative laid over it."""
        parameters = dict(self.parameters)
        for name, value in overlay.parameters.items():
            parameters[name] = parameters[name].given(value)
        switched = dict.fromkeys(overlay.on, True) | dict.fromkeys(overlay.off, False)
        elements = {
            name: replace(element, enabled=switched[name]) if name in switched else element
            for name, element in self.elements.items()
        }
        point = self.operating_point.overlaid(overlay.operating_point)
        return replace(
            self,
            parameters=parameters,
            operating_point=point,
            **self._overridden(overlay.entries, elements),
        )

    def _overridden(self, changes: Mapping[str, Any], elements: Mapping[str, Element]) -> dict[str, Any]:
        """The sections with ``box.engaged: II``, ``engine.misfire: [3]``, ``load.power: 1 MW`` and the like put in."""
        found: dict[str, Any] = {EXCITATIONS: dict(self.excitations), ELEMENTS: dict(elements), LOAD: self.load}
        # All entries of one section at once: each alone may contradict what the others change.
        for (table, name), fields in by_section(self, changes).items():
            if table == LOAD:
                found[LOAD] = replace(found[LOAD], **fields)
            else:
                found[table][name] = replace(found[table][name], **fields)
        return found

    def to_data(self) -> dict[str, Any]:
        """The entries of a model file; reading them again gives an equal definition."""
        return {KEY: VERSION, "name": self.name, **super().to_data()}


def section_of(definition: Definition, key: str) -> tuple[str, str, Declared] | None:
    """Table, name and section that ``box.engaged`` and the like are about; None if nothing has that name.

    Of an excitation and an element of one name it is the excitation, unless only the element has such an entry.
    """
    name, _, entry = key.rpartition(".")
    if name == LOAD and definition.load is not None:
        return LOAD, name, definition.load
    tables: dict[str, Mapping[str, Declared]] = {EXCITATIONS: definition.excitations, ELEMENTS: definition.elements}
    found = [(table, name, sections[name]) for table, sections in tables.items() if name in sections]
    fitting = [one for one in found if entry in dict(one[2].specs())]
    return next(iter(fitting or found), None)


def by_section(definition: Definition, changes: Mapping[str, Any]) -> dict[tuple[str, str], dict[str, Any]]:
    """``engine.misfire: [3]`` and the like as entries by the table and the name of the section they belong to.

    What belongs to none is left out.
    """
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for key, value in changes.items():
        section = section_of(definition, key)
        if section is not None:
            found.setdefault(section[:2], {})[key.rpartition(".")[2]] = value
    return found


def _with_files_read(definition: Definition) -> Definition:
    """Alternatives that name files for entries of excitations get their content: they are laid over later."""
    axes = {
        axis: {label: replace(one, entries=_settled(definition, one.entries)) for label, one in names.items()}
        for axis, names in definition.configurations.items()
        if any(names_a_file(value) for one in names.values() for value in one.entries.values())
    }
    return replace(definition, configurations={**definition.configurations, **axes}) if axes else definition


def _settled(definition: Definition, changes: Mapping[str, Any]) -> dict[str, Any]:
    """What cannot be read stays as it is; checks say why."""
    found = dict(changes)
    for key, raw in changes.items():
        section, field = section_of(definition, key), key.rpartition(".")[2]
        specs = dict(section[2].specs()) if section else {}
        value, faults = specs[field].read(raw) if field in specs and names_a_file(raw) else (None, [])
        if value is not None and not faults:
            found[key] = specs[field].plain(value)
    return found


def all_nodes(elements: Iterable[Element]) -> tuple[str, ...]:
    """Nodes in the order of their first mention, without ground."""
    nodes: dict[str, None] = {}
    for element in elements:
        for node in (*element.ports.values(), *element.internal_nodes):
            if node != GROUND:
                nodes[node] = None
    return tuple(nodes)


def collect_elements(elements: Iterable[Element]) -> tuple[dict[str, Element], list[Fault]]:
    """Elements by name; a name used twice is a fault."""
    table: dict[str, Element] = {}
    faults: list[Fault] = []
    if isinstance(elements, Mapping):
        elements = elements.values()
    if not isinstance(elements, Iterable) or isinstance(elements, str):
        return {}, [Fault(f"expected a list of elements, got {elements!r}", ("elements",))]
    for element in elements:
        if not isinstance(element, Element):
            faults.append(Fault(f"expected an element such as Inertia(...), got {element!r}", ("elements",)))
            continue
        if element.name in table:
            faults.append(
                Fault(f'two elements are named "{element.name}"; names must be unique', ("elements", element.name))
            )
        table[element.name] = element
    if not table and not faults:
        faults.append(Fault("a drivetrain needs at least one element", ("elements",)))
    return table, faults


def read_definition(data: Any) -> tuple[Definition, list[Fault]]:
    """Definition from the plain content of a model file, with all faults of reading it."""
    if not isinstance(data, Mapping):
        return Definition(""), [Fault("a model is a mapping with the entries torsionnet, name, elements, ...")]
    definition, faults = define(data)
    return definition, [*version_faults(data, "model"), *faults]


def define(entries: Mapping[str, Any]) -> tuple[Definition, list[Fault]]:
    """The definition holds what could be read of the entries, the faults say what could not."""
    values, faults = Definition.read_entries(entries)
    definition = Definition(**{name: value for name, value in values.items() if value is not None})
    return _with_files_read(definition), faults
