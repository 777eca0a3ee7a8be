"""Entries for the sections of a model file, of which its elements and parts are tables by name."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

from torsionnet.base.entries.composite import Listed, Named, Nested, Typed
from torsionnet.base.entries.scalars import QuantityKind
from torsionnet.base.entries.spec import NAME_SCHEMA, Schema, Text, name_fault, single_name_fault
from torsionnet.base.errors import Fault, ModelError, got, unfit_word
from torsionnet.base.expression_reading import check_name
from torsionnet.base.expressions import Number
from torsionnet.base.packages import imported
from torsionnet.model.channels import INPUT, SENSOR
from torsionnet.model.configurations import AxesEntry
from torsionnet.model.element_base.element import ELEMENT_TYPES, Element
from torsionnet.model.element_base.element_entries import CATALOGUE, SIZE, NodeName
from torsionnet.model.parameters import PARAMETER

FORM = "{name: {type: inertia, node: ..., inertia: ...}, ...}"


class ElementTable(Named[Element]):
    """Entry for the elements of a model by name; an element gets its name, which messages on the element contain."""

    @property
    def example(self) -> str:
        return FORM

    def read(self, raw: object) -> tuple[dict[str, Element], list[Fault]]:
        """Elements by name that can be made, and all faults."""
        if not isinstance(raw, Mapping) or not raw:
            return {}, [Fault(f"a model needs elements: {FORM}", kind="missing-entry", about="elements")]
        elements: dict[str, Element] = {}
        faults: list[Fault] = []
        for name, entry in raw.items():
            element, wrong = _read_element(name, entry)
            faults += [fault.under(name) for fault in wrong]
            if element is not None:
                elements[name] = element
        return elements, faults


def _read_element(name: Any, raw: object) -> tuple[Element | None, list[Fault]]:
    if isinstance(raw, Element):
        return raw, []
    if not isinstance(name, str) or name_fault(name):
        unfit = name_fault(str(name)) or Fault(f"the name of an element is a text, {got(name)}", kind="invalid-name")
        return None, [replace(unfit, on_key=True)]
    if not isinstance(raw, Mapping):
        return None, [Fault(f"expected {{type: ..., ...}}, {got(raw)}", kind="wrong-form")]
    kind = raw.get("type")
    if not isinstance(kind, str) or kind not in ELEMENT_TYPES:
        return None, [_kind_fault(kind)]
    cls, entries = ELEMENT_TYPES[kind], {key: value for key, value in raw.items() if key != "type"}
    if not entries.keys().isdisjoint((CATALOGUE, SIZE)):
        from torsionnet.model.catalogues.catalogue_reading import chosen_row, row_entries

        row, faults = chosen_row(entries)
        if row is not None:
            # What the model says itself wins over the catalogue.
            taken, faults = row_entries(row, dict(cls.specs()), entries)
            entries = {**taken, **entries, CATALOGUE: row}
        if faults:
            return None, faults
    faults = cls.key_faults(entries, name)
    known: dict[str, Any] = {key: entries[key] for key, _ in cls.specs() if key in entries}
    if any(known[key] is None for key in known if key not in cls.required()):
        return None, faults
    lacking: list[str] = [key for key in cls.required() if key not in entries]
    try:
        element = cls(name, **{**known, **dict.fromkeys(lacking)})
    except ModelError as error:
        wrong = [replace(fault, path=fault.path[2:]) for fault in error.faults]
        faults += [fault for fault in wrong if not (fault.path and fault.path[0] in lacking)]
        return None, [*faults, *_beyond_bounds(cls, known, {fault.path[0] for fault in faults if fault.path})]
    # With unknown keys alone it goes on to the checks, which tell what else is wrong.
    return (element if all(fault.kind == "unknown-entry" for fault in faults) else None), faults


def _beyond_bounds(cls: type[Element], known: Mapping[str, Any], told: Container[Any]) -> Iterator[Fault]:
    """Yield faults of the numbers of an element that cannot be made, as the checks of a whole model tell them."""
    for key, spec in cls.specs():
        if key not in known or key in told or not isinstance(spec, QuantityKind):
            continue
        value, _ = spec.read(known[key])
        reason = spec.bound_fault(value.value) if isinstance(value, Number) else None
        if reason:
            yield Fault(f"{value}: {spec.description} {reason}", (key,), kind="out-of-range")


def _kind_fault(kind: Any) -> Fault:
    known = ", ".join(ELEMENT_TYPES)
    if kind is None:
        return Fault(f"an element needs a type: {known}", on_key=True, kind="missing-entry")
    from torsionnet.base.familiar_words import ELEMENT_TYPES as FAMILIAR_TYPES
    from torsionnet.base.familiar_words import SECTIONS as FAMILIAR_SECTIONS

    word, text = str(kind).casefold(), f'no element type is named "{kind}"'
    if word in FAMILIAR_SECTIONS:
        return Fault(f"{text}; {FAMILIAR_SECTIONS[word]}", ("type",), kind="unknown-word")
    familiar = FAMILIAR_TYPES.get(word, "")
    meant = familiar if familiar in ELEMENT_TYPES else ""
    return unfit_word(text, str(kind), ELEMENT_TYPES, ("type",), f"known: {known}", meant=meant)


def element_kinds() -> Mapping[str, type[Element]]:
    """Class of every registered element type, by the word in ``type:``."""
    return ELEMENT_TYPES


PLAIN_NAME_SCHEMA: Schema = {"pattern": "^[A-Za-z][A-Za-z0-9_]*$"}
"""JSON Schema of a name without dots."""


def prefix_fault(name: str) -> Fault | str | None:
    """Fault that a name is not allowed for a use, as names of parameters begin with it, or None."""
    return single_name_fault(name) or check_name(name)


class PartTable(Named[Any]):
    """Entry of a model's parts by name.

    A part that could be read incompletely is kept, so that its uses are checked.
    """

    def read(self, raw: object) -> tuple[Mapping[str, Any], list[Fault]]:
        if not isinstance(raw, Mapping):
            return super().read(raw)
        table, faults = {}, list(self._name_faults(raw))
        for name, raw_part in raw.items():
            part, wrong = self.of.read(raw_part)
            faults += [fault.under(name) for fault in wrong]
            if part is not None and not single_name_fault(str(name)):
                table[str(name)] = part
        return table, faults

    def _name_faults(self, raw: Mapping[str, Any]) -> Iterator[Fault]:
        for name in raw:
            unfit = single_name_fault(str(name))
            if unfit:
                yield replace(unfit, path=(name,), on_key=True)


class SectionOwner(NamedTuple):
    """Places in another room, as ``module:name``, of what a section of a model file is made of.

    A model file with the section alone imports them.
    """

    entries: str
    """Class of the section, or function that returns its classes by kind."""
    faults: str = ""
    """Function of a definition that returns all faults of the section."""
    faults_of_one: str = ""
    """Function of a definition and a name that returns the faults of one entry of the section."""


OWNERS = {
    "speeds": SectionOwner("torsionnet.machinery.excitations.speed_range:SpeedRange"),
    "load": SectionOwner("torsionnet.model.load.load_section:Load"),
    "excitations": SectionOwner(
        "torsionnet.machinery.excitations:excitation_kinds",
        "torsionnet.machinery.checks.section_checks:unfit_excitations",
        "torsionnet.machinery.checks.section_checks:excitation_faults",
    ),
    "limits": SectionOwner(
        "torsionnet.machinery.limits:limit_rules", "torsionnet.machinery.checks.section_checks:unfit_limits"
    ),
    "scenarios": SectionOwner(
        "torsionnet.motion.scenarios:scenario_kinds",
        "torsionnet.motion.scenario_courses:unfit_scenarios",
        "torsionnet.motion.scenario_courses:scenario_faults",
    ),
    "bench": SectionOwner("torsionnet.bench.plan.plan:Plan", "torsionnet.bench.plan.bench_checks:unfit_bench"),
    "report": SectionOwner(
        "torsionnet.report.plan.report_plan:ReportPlan", "torsionnet.report.plan.report_checks:check_report"
    ),
}
"""Owner of each section that few models have, by its key in a model file."""
CONDITIONS_AT_RATED_SPEED = (
    "torsionnet.machinery.checks.rating_mismatches:rating_mismatches",
    "torsionnet.machinery.checks.section_checks:archer_at_small_torque",
    "torsionnet.machinery.checks.section_checks:cut_off_excitations",
)
"""Places of the checks of powers and speeds at rated speed, functions of the external torques."""
EXCITATION_NUMBERS = "torsionnet.machinery.excitations.excitation_numbers:with_numbers"
"""Place of the function that puts other numbers into excitations."""
REPORT_FAULTS = "torsionnet.report.plan.report_checks:check_report"
"""Place of the check of another plan of a report, a function of the definition of its model and the plan."""
BENCH_FILE = "torsionnet.bench.plan.plan:BenchFile"
"""Place of the class of a file that names a model and describes a test of it."""
OPERATING_BALANCE = "torsionnet.motion.balance.operating_balance:OperatingBalance"
"""Place of the operating point about which laws of motion are linear; a model with such laws imports it."""
PERIODIC_ORDERS = "torsionnet.motion.periodic.periodic_response:periodic_orders"
"""Place of the function that gives order responses with laws of motion in full, where that is asked for."""


def section_class(key: str) -> Any:
    """Class of a section, or its classes by kind, from the room that owns it."""
    entries = imported(OWNERS[key].entries)
    return entries if isinstance(entries, type) else entries()


PARAMETERS = Named(
    "named values with unit, or expressions of other parameters", PARAMETER, refused=check_name, names=NAME_SCHEMA
)
ELEMENTS = ElementTable(
    "the parts of the drivetrain by name, each attached to nodes",
    Typed("what kind of element this is", element_kinds, "element", "element"),
    names=NAME_SCHEMA,
    fewest=1,
)
INPUTS = Named("excitations by name", INPUT, refused=name_fault, names=NAME_SCHEMA)
SENSORS = Named("measured quantities by name", SENSOR, refused=name_fault, names=NAME_SCHEMA)
CONFIGURATIONS = AxesEntry("axes of alternatives, gear: {II: {tau: 7.96}}; the name of a single axis may be left out")
SPEEDS = Nested(
    "at which speeds running machinery is examined", partial(section_class, "speeds"), "speeds", optional=True
)
LOAD = Nested(
    "who absorbs the power, how that follows the speed, and who drives",
    partial(section_class, "load"),
    "load",
    optional=True,
)
EXCITATIONS = Named(
    "what runs and excites the drivetrain by orders of its speed, by name",
    Typed("what kind of excitation this is", partial(section_class, "excitations"), "excitation", "order_excitation"),
    refused=name_fault,
    names=NAME_SCHEMA,
)
LIMITS = Named(
    "what elements may bear while the machinery runs, by name",
    Typed("which rule says so", partial(section_class, "limits"), "limit", "limit", key="rule"),
    refused=name_fault,
    names=NAME_SCHEMA,
)
SCENARIOS = Named(
    "what happens to the drivetrain over time, by name",
    Typed("what kind of scenario this is", partial(section_class, "scenarios"), "scenario", "scenario"),
    refused=name_fault,
    names=NAME_SCHEMA,
)
BENCH = Nested(
    "a virtual test: excitation, exciter, sensors, data acquisition",
    partial(section_class, "bench"),
    "bench",
    optional=True,
)
REPORT = Nested(
    "what torsionnet report writes about the model", partial(section_class, "report"), "report", optional=True
)
USE = Named(
    "parts put into this model, by the name that stands before those of all they hold",
    Nested(
        "a part, the nodes it is joined to and its values", partial(imported, "torsionnet.model.parts.part:Use"), "use"
    ),
    refused=prefix_fault,
    names=PLAIN_NAME_SCHEMA,
    form="{left: {part: half_shaft, at: {inner: dl, outer: hub}}}",
)
"""Specification of a model's entry ``use:``, the parts put into it."""
PORTS = Listed(
    "nodes at which a model is joined to others that use it as a part", NodeName("a node", False), "a list of nodes"
)
"""Specification of a model's entry ``ports:``, the nodes at which it is joined to others."""
PARTS = PartTable(
    "models with ports, to be put in under use:, by name",
    Nested("a model with ports", partial(imported, "torsionnet.model.parts.part:Part"), "part"),
    names=PLAIN_NAME_SCHEMA,
    form="{half_shaft: {ports: [inner, outer], elements: {...}}}",
)
"""Specification of a model's entry ``parts:``, its own parts by name."""
INCLUDE = Listed(
    "files beside this one or below with parts:, or models with ports:, which are parts under the name of their file",
    Text("the name of a file", "the name of a file"),
    "a list of files",
)
"""Specification of a model's entry ``include:``, the files of parts that it includes."""
