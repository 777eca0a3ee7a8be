"""The content of a model, read and typed but not yet checked against itself."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from torsionnet.core.errors import Fault, ModelError, Path, did_you_mean, unknown_key
from torsionnet.model.channels import Input, Sensor, read_channels
from torsionnet.model.configurations import Overlay, read_configurations
from torsionnet.model.elements import ELEMENT_TYPES, GROUND, Element
from torsionnet.model.elements.fields import node_name_fault
from torsionnet.model.operating_point import OperatingPoint, read_operating_point
from torsionnet.model.parameters import Parameter, read_parameters

if TYPE_CHECKING:
    from torsionnet.model.bench import Plan
    from torsionnet.model.report import ReportPlan

VERSION = 1
TEXTS = ("name", "source", "description")
TABLES = ("parameters", "elements", "inputs", "sensors", "configurations", "operating_point", "bench", "report")
KEYS = ("torsionnet", *TEXTS, *TABLES)


@dataclass(frozen=True)
class Definition:
    """Everything a model file or a call of ``Drivetrain`` says, as typed values."""

    name: str
    elements: Mapping[str, Element]
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    inputs: Mapping[str, Input] = field(default_factory=dict)
    sensors: Mapping[str, Sensor] = field(default_factory=dict)
    axes: Mapping[str, Mapping[str, Overlay]] = field(default_factory=dict)
    operating_point: OperatingPoint = field(default_factory=OperatingPoint)
    source: str = ""
    description: str = ""
    bench: Plan | None = None
    report: ReportPlan | None = None

    @property
    def active(self) -> tuple[Element, ...]:
        """The elements that are switched on."""
        return tuple(element for element in self.elements.values() if element.enabled)

    def overlaid(self, overlay: Overlay) -> Definition:
        """The definition with one alternative laid over it."""
        parameters = dict(self.parameters)
        for name, value in overlay.parameters.items():
            parameters[name] = replace(parameters[name], value=value)
        switched = dict.fromkeys(overlay.on, True) | dict.fromkeys(overlay.off, False)
        elements = {
            name: replace(element, enabled=switched[name]) if name in switched else element
            for name, element in self.elements.items()
        }
        point = self.operating_point.overlaid(overlay.operating_point)
        return replace(self, parameters=parameters, elements=elements, operating_point=point)

    def to_data(self) -> dict[str, Any]:
        """The entries of a model file; reading them again gives an equal definition."""
        data: dict[str, Any] = {"torsionnet": VERSION, "name": self.name}
        data |= {key: getattr(self, key) for key in ("source", "description") if getattr(self, key)}
        for key in ("parameters", "elements", "inputs", "sensors"):
            table = getattr(self, key)
            if table:
                data[key] = {name: entry.to_data() for name, entry in table.items()}
        if self.axes:
            data["configurations"] = {
                axis: {name: overlay.to_data() for name, overlay in alternatives.items()}
                for axis, alternatives in self.axes.items()
            }
        if self.operating_point:
            data["operating_point"] = self.operating_point.to_data()
        if self.bench:
            data["bench"] = self.bench.to_data()
        if self.report:
            data["report"] = self.report.to_data()
        return data


def all_nodes(elements: Iterable[Element]) -> tuple[str, ...]:
    """Nodes in the order of their first mention, without ground."""
    nodes: dict[str, None] = {}
    for element in elements:
        for node in (*element.ports.values(), *element.internal_nodes):
            if node != GROUND:
                nodes[node] = None
    return tuple(nodes)


def define(
    name: Any,
    elements: Mapping[str, Element],
    *,
    parameters: Any = None,
    inputs: Any = None,
    sensors: Any = None,
    configurations: Any = None,
    operating_point: Any = None,
    source: Any = "",
    description: Any = "",
    bench: Any = None,
    report: Any = None,
) -> tuple[Definition, list[Fault]]:
    """Type the content of a model; the definition holds what could be read, the faults say what could not."""
    faults: list[Fault] = []
    texts = {"name": name, "source": source, "description": description}
    for key, text in texts.items():
        if not isinstance(text, str):
            faults.append(Fault(f"expected text, got {text!r}", (key,)))
    tables: dict[str, Any] = {}
    raw_tables = {"parameters": parameters, "inputs": inputs, "sensors": sensors}
    for key, raw in raw_tables.items():
        if raw is not None and not isinstance(raw, Mapping):
            faults.append(Fault(f"expected entries by name, got {raw!r}", (key,)))
            raw_tables[key] = None
    tables["parameters"], found = read_parameters(raw_tables["parameters"] or {})
    faults += found
    for key in ("inputs", "sensors"):
        tables[key], found = read_channels(raw_tables[key] or {}, key)
        faults += found
    axes, found = read_configurations({} if configurations is None else configurations)
    faults += found
    point, found = read_operating_point(operating_point)
    faults += found
    plan, found = _read_bench(bench)
    faults += found
    outline, found = _read_report(report)
    faults += found
    texts = {key: text if isinstance(text, str) else "" for key, text in texts.items()}
    parts: dict[str, Any] = {
        "elements": elements,
        "axes": axes,
        "operating_point": point,
        "bench": plan,
        "report": outline,
    }
    return Definition(**parts, **tables, **texts), faults


def _read_bench(raw: Any) -> tuple[Plan | None, list[Fault]]:
    if raw is None:
        return None, []
    from torsionnet.model.bench.plan import read_plan  # loads numpy, which most models can do without

    return read_plan(raw)


def _read_report(raw: Any) -> tuple[ReportPlan | None, list[Fault]]:
    if raw is None:
        return None, []
    from torsionnet.model.report.report_reading import read_outline

    return read_outline(raw)


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
        empty = Definition("", {})
        return empty, [Fault("a model is a mapping with the entries torsionnet, name, elements, ...")]
    faults = [*_key_faults(data)]
    elements, found = read_elements(data.get("elements"))
    faults += found
    texts = {key: data[key] for key in ("source", "description") if key in data}
    rest = {key: data.get(key) for key in TABLES if key != "elements"}
    definition, found = define(data.get("name", "unnamed"), elements, **texts, **rest)
    return definition, faults + found


def _key_faults(data: Mapping[Any, Any]) -> list[Fault]:
    rest = f"a model has {', '.join(KEYS)}"
    faults = [unknown_key(key, KEYS, (key,), rest) for key in data if key not in KEYS]
    version = data.get("torsionnet")
    if version is None:
        text = "the first entry of a model file is torsionnet: 1, the version of the format"
        faults.append(Fault(text, kind="missing key", about="torsionnet"))
    elif version != VERSION or isinstance(version, bool):
        shown = f"format {version}" if isinstance(version, int) and not isinstance(version, bool) else repr(version)
        text = f"torsionnet: is the version of the format, {VERSION} for this release; this is {shown}"
        faults.append(Fault(text, ("torsionnet",)))
    return faults


def read_elements(raw: Any) -> tuple[dict[str, Element], list[Fault]]:
    """Every element that can be made, and the faults of the others."""
    if not isinstance(raw, Mapping) or not raw:
        text = "a model needs elements: {name: {type: inertia, node: ..., inertia: ...}, ...}"
        return {}, [Fault(text, ("elements",), kind="missing key", about="elements")]
    elements: dict[str, Element] = {}
    faults: list[Fault] = []
    for name, entry in raw.items():
        try:
            elements[name] = _read_element(name, entry)
        except ModelError as error:
            faults += error.faults
    return elements, faults


def _read_element(name: Any, entry: Any) -> Element:
    path: Path = ("elements", name)
    if not isinstance(name, str) or node_name_fault(name):
        raise ModelError([Fault(node_name_fault(str(name)) or f"{name!r} is no name", path, on_key=True)])
    if not isinstance(entry, Mapping):
        raise ModelError([Fault(f"expected {{type: ..., ...}}, got {entry!r}", path)])
    kind = entry.get("type")
    if not isinstance(kind, str) or kind not in ELEMENT_TYPES:
        raise ModelError([_kind_fault(kind, path)])
    cls = ELEMENT_TYPES[kind]
    specs = dict(cls.specs())
    required = cls.required()
    unknown = [key for key in entry if key != "type" and key not in specs]
    faults = [unknown_key(key, specs, (*path, key), f"{kind} has {', '.join(specs)}") for key in unknown]
    missing = [key for key in required if key not in entry]
    faults += [_missing(key, kind, name, specs[key].description) for key in missing]
    empty = [key for key in entry if key in specs and entry[key] is None and key not in required]
    faults += [
        Fault(f"{key} has no value; give one, or leave the entry out", (*path, key), on_key=True) for key in empty
    ]
    if empty:
        raise ModelError(faults)
    given = {key: value for key, value in entry.items() if key in specs}
    try:
        element = cls(name, **(given | dict.fromkeys(missing)))
    except ModelError as error:
        raise ModelError(
            [*faults, *(fault for fault in error.faults if fault.path[2:3] not in [(key,) for key in missing])]
        ) from None
    if faults:
        raise ModelError(faults)
    return element


def _missing(key: str, kind: str, name: str, description: str) -> Fault:
    text = f"{kind} {name} needs {key}: {description}"
    return Fault(text, ("elements", name), on_key=True, kind="missing key", about=key)


def _kind_fault(kind: Any, path: Path) -> Fault:
    known = ", ".join(ELEMENT_TYPES)
    if kind is None:
        return Fault(f"an element needs a type: {known}", path, on_key=True)
    return Fault(
        f'no element type is named "{kind}"{did_you_mean(str(kind), ELEMENT_TYPES)}; known: {known}', (*path, "type")
    )
