"""Configurations of a model, alternatives on one or several axes with changes to the base model."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, cast

from torsionnet.base.entries.composite import Listed, Named
from torsionnet.base.entries.scalars import AnyQuantity, plain_scalar, read_scalar
from torsionnet.base.entries.spec import EntryError, Json, Plural, Renaming, Schema, Spec, Text, reference
from torsionnet.base.errors import (
    Fault,
    ModelError,
    UsageError,
    comma_list,
    did_you_mean,
    got,
    unfit_word,
    unknown_name,
)
from torsionnet.base.expressions import Expression
from torsionnet.model.element_base.element_entries import ElementName
from torsionnet.model.operating_point import OPERATING_POINT, OperatingPoint

DEFAULT_AXIS = "configuration"
ALL_CONFIGURATIONS = "all"
"""Name that stands for all configurations of a model in options and entries."""

Axes = Mapping[str, Mapping[str, "Overlay"]]


@dataclass(frozen=True)
class Overlay:
    """Changes to a model by an alternative of a configuration.

    Parameter values, elements on or off, operating point, entries; and what documents call it.
    """

    parameters: Mapping[str, Expression] = field(default_factory=dict)
    on: tuple[str, ...] = ()
    off: tuple[str, ...] = ()
    operating_point: OperatingPoint | None = None
    entries: Mapping[str, Any] = field(default_factory=dict)
    """Changed entries of elements, excitations, scenarios and the load as written, by ``element.entry`` and so on."""
    at: OperatingPoint | None = None
    """Operating point of a call, which replaces that of the model instead of changing some of its entries."""
    title: str = ""
    """Title of the alternative in documents; empty: words made of its name."""
    by_files: Mapping[str, Any] = field(default_factory=dict, compare=False)
    """Changed entries that name files as they are written, where ``entries`` hold the content of these files."""

    @property
    def changes_nothing(self) -> bool:
        """Whether the model with the alternative is the model as written."""
        return replace(self, title="") == Overlay()

    def renamed(self, names: Renaming) -> Overlay:
        """Copy of the changes in a part, with its names in the whole model; ``entries`` are not renamed."""
        point = self.operating_point
        return Overlay(
            {names.parameter(name): names.expression(value) for name, value in self.parameters.items()},
            tuple(map(names.element, self.on)),
            tuple(map(names.element, self.off)),
            None if point is None else point.renamed(names),
            {names.changed_entry(key): value for key, value in self.entries.items()},
            title=self.title,
            by_files={names.changed_entry(key): value for key, value in self.by_files.items()},
        )

    def to_data(self) -> dict[str, Json]:
        data: dict[str, Any] = {"title": self.title} if self.title else {}
        data |= {name: plain_scalar(value) for name, value in self.parameters.items()}
        data |= {key: list(getattr(self, key)) for key in ("on", "off") if getattr(self, key)}
        data |= self.entries
        return data | ({"operating_point": self.operating_point.to_data()} if self.operating_point else {})


class ConfigurationName(Spec[str]):
    """Entry of the name of a configuration, which in a file may look like a number."""

    def coerce(self, raw: object) -> str:
        if not isinstance(raw, str | int) or isinstance(raw, bool):
            raise EntryError(f"expected a name, {got(raw)}", kind="wrong-form")
        return str(raw)

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.configuration(value)

    def schema(self) -> Schema:
        return {"type": ["string", "number"]}


class ChangedEntry(Text):
    """Entry for the name of what an alternative changes."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return names.changed_entry(value)


_CHANGED = ChangedEntry("a parameter, or an entry as box.engaged")


class AlternativeEntry(Plural[Overlay]):
    """Entry for an alternative of a configuration with its changes to the model.

    ``{title: first gear, parameter: value, on: [element], operating_point: {...}, box.engaged: II}``.
    """

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        return {key: _KNOWN.get(key, VALUE) for key in raw if "." not in str(key)} if isinstance(raw, Mapping) else {}

    def key_names(self, raw: object) -> Mapping[Any, Spec[Any]]:
        return {key: _CHANGED for key in raw if key not in _KNOWN} if isinstance(raw, Mapping) else {}

    absent: ClassVar[Any] = Overlay()

    def read(self, raw: object) -> tuple[Overlay, list[Fault]]:
        if isinstance(raw, Overlay):
            return raw, []
        if raw is None:
            return Overlay(), []
        if not isinstance(raw, Mapping):
            return Overlay(), [Fault(f"expected {{parameter: value}}, {got(raw)}", kind="wrong-form")]
        known: dict[str, Any] = {}
        parameters: dict[str, Expression] = {}
        entries: dict[str, Any] = {}
        faults: list[Fault] = []
        for key, value in raw.items():
            # A name with a point is an entry of something else, as box.engaged; it is read where that is.
            if isinstance(key, str) and "." in key:
                entries[key] = value
                continue
            change, wrong = _KNOWN.get(key, VALUE).read(value)
            faults += [fault.under(key) for fault in wrong]
            if key in _KNOWN:
                known[key] = change
            elif not wrong:
                parameters[key] = cast("Expression", change)
        return Overlay(parameters, **known, entries=entries), faults

    def plain(self, value: Any) -> Json:
        data: Json = value.to_data()
        return data

    def schema(self) -> Schema:
        return reference("alternative")

    def definitions(self) -> Schema:
        alternative: Schema = {
            "type": ["object", "null"],
            "description": self.description,
            "properties": {key: spec.schema() for key, spec in _KNOWN.items()},
            "patternProperties": {r"\.": {"description": "of an element, excitation, scenario or load: box.engaged"}},
            "additionalProperties": reference("scalar"),
        }
        return {"alternative": alternative, **OPERATING_POINT.definitions()}


_ELEMENT = ElementName("an element of the model")
_ELEMENTS = "a list of element names"
_KNOWN: dict[str, Spec[object]] = {
    "title": Text("what documents call it; default: words made of its name"),
    "on": Listed("elements to switch on", _ELEMENT, form=_ELEMENTS),
    "off": Listed("elements to switch off", _ELEMENT, form=_ELEMENTS),
    "operating_point": OPERATING_POINT,
}
VALUE = AnyQuantity("value of a parameter")
ALTERNATIVE = AlternativeEntry("title, changed parameters, and elements switched on or off")
ALTERNATIVES = Named("the alternatives on this axis, by name", ALTERNATIVE)


def _name_fault(name: str) -> str | None:
    if any(mark in name for mark in ",= \t"):
        return f'"{name}" is no name for a configuration: no spaces, commas or ='
    if name == ALL_CONFIGURATIONS:
        return f'"{ALL_CONFIGURATIONS}" means every configuration; give this one another name'
    return None


class AxesEntry(Plural[dict[str, dict[str, Overlay]]]):
    """Entry for the axes of configurations and the alternatives on each.

    ``{gear: {II: {tau: 7.96}}}``, or ``{II: {tau: 7.96}}`` for a single axis.
    """

    absent: ClassVar[Any] = {}

    @property
    def may_be_empty(self) -> bool:
        return True

    def entry_specs(self, raw: object) -> Mapping[Any, Spec[Any]]:
        if not isinstance(raw, Mapping):
            return {}
        return dict.fromkeys(raw, ALTERNATIVES) if has_axes(raw) else ALTERNATIVES.entry_specs(raw)

    def read(self, raw: object) -> tuple[dict[str, dict[str, Overlay]], list[Fault]]:
        if not isinstance(raw, Mapping):
            return {}, [
                Fault(f"expected axes of alternatives, gear: {{II: {{tau: 7.96}}}}, {got(raw)}", kind="wrong-form")
            ]
        if raw and not has_axes(raw):
            overlays, faults = _read_axis(raw)
            return {DEFAULT_AXIS: overlays}, faults
        axes: dict[str, dict[str, Overlay]] = {}
        faults = []
        for axis, alternatives in raw.items():
            if not isinstance(alternatives, Mapping):
                faults.append(Fault(f"expected alternatives by name, {got(alternatives)}", (axis,), kind="wrong-form"))
                continue
            axes[axis], wrong = _read_axis(alternatives)
            faults += [fault.under(axis) for fault in wrong]
        return axes, faults

    def plain(self, value: Any) -> Json:
        return {axis: ALTERNATIVES.plain(alternatives) for axis, alternatives in value.items()}

    def schema(self) -> Schema:
        axes: Schema = {
            "type": ["object", "null"],
            "description": "axes by name",
            "additionalProperties": reference("axis"),
        }
        return {
            "description": self.description,
            "anyOf": [axes, {**ALTERNATIVES.schema(), "description": "alternatives by name"}],
        }

    def definitions(self) -> Schema:
        return {"axis": ALTERNATIVES.schema(), **ALTERNATIVES.definitions()}


def has_axes(raw: Mapping[Any, Any]) -> bool:
    """Whether alternatives in a file stand on axes with names, and not on a single one without."""
    return any(_is_axis(entry) for entry in raw.values())


def _is_axis(entry: Any) -> bool:
    if not isinstance(entry, Mapping):
        return False
    values = [value for key, value in entry.items() if key not in _KNOWN and "." not in str(key)]
    # On an axis every value is an alternative itself; a single scalar makes the entry an alternative.
    return bool(values) and all(value is None or isinstance(value, (Mapping, Overlay)) for value in values)


def _read_axis(alternatives: Mapping[str, Any]) -> tuple[dict[str, Overlay], list[Fault]]:
    """Alternatives on one axis by name, as far as they can be read, and their faults."""
    overlays: dict[str, Overlay] = {}
    faults: list[Fault] = []
    for name, raw in alternatives.items():
        reason = _name_fault(str(name))
        if reason:
            faults.append(Fault(reason, (name,), on_key=True, kind="invalid-name"))
            continue
        overlays[str(name)], wrong = ALTERNATIVE.read(raw)
        faults += [fault.under(name) for fault in wrong]
    return overlays, faults


def combinations(axes: Axes) -> Iterator[dict[str, str]]:
    """Choices of an alternative on every axis, as mappings, in all combinations."""
    named = [[(axis, name) for name in alternatives] for axis, alternatives in axes.items()]
    return (dict(choice) for choice in itertools.product(*named))


def label(choice: Mapping[str, str], axes: Axes) -> str:
    """Name of the configuration that a choice of alternatives makes.

    ``V`` with one axis, ``gear=V,clutch=open`` with several.
    """
    if len(axes) == 1:
        return next(iter(choice.values()), "")
    return ",".join(f"{axis}={name}" for axis, name in choice.items())


def other_configurations(choice: Mapping[str, str], axes: Axes) -> tuple[str, ...]:
    """Names of all configurations but the chosen one.

    On an axis without a choice the model is as written; an alternative that changes nothing is the same.
    """
    return tuple(
        label(other, axes)
        for other in combinations(axes)
        if any(
            # An axis without a choice leaves the model as written, which an alternative without changes does, too.
            choice[axis] != name if axis in choice else not axes[axis][name].changes_nothing
            for axis, name in other.items()
        )
    )


def parse_choice(text: str, axes: Axes) -> dict[str, str]:
    """Alternative chosen on each axis, by axis, that a text as ``V``, ``gear=V`` or ``gear=V,clutch=open`` names.

    Raises
    ------
    UsageError
        No such axis or alternative; the message lists the existing ones.
    """
    choice: dict[str, str] = {}
    if not isinstance(text, str):
        raise UsageError(f"a configuration is named by a text such as gear=V, got {text!r}", kind="wrong-form")
    for part in (piece.strip() for piece in text.split(",")):
        axis, name = _parse_part(part, axes)
        if axis in choice:
            raise UsageError(
                f'"{text}" chooses twice on axis "{axis}"; give one alternative', kind="contradicting-entries"
            )
        choice[axis] = name
    return choice


def _parse_part(part: str, axes: Axes) -> tuple[str, str]:
    if "=" in part:
        axis, name = (piece.strip() for piece in part.split("=", 1))
        if axis not in axes:
            there = comma_list(axes, none="none")
            raise UsageError(unknown_name("axis of configurations", axis, axes, rest=f"there is {there}"))
        if name not in axes[axis]:
            there = comma_list(axes[axis], none="none")
            raise UsageError(unfit_word(f'axis "{axis}" has no "{name}"', name, axes[axis], rest=f"it has {there}"))
        return axis, name
    # A name without its axis is enough where one axis alone has it.
    homes = [axis for axis, alternatives in axes.items() if part in alternatives]
    if len(homes) == 1:
        return homes[0], part
    if homes:
        raise UsageError(
            f'"{part}" stands on several axes; write one of {", ".join(f"{axis}={part}" for axis in homes)}',
            kind="ambiguous-name",
        )
    names = [name for alternatives in axes.values() for name in alternatives]
    hint = f"there is {comma_list(names)}" if names else "the model has no configurations"
    raise UsageError(unknown_name("configuration", part, names, rest=hint))


def read_overrides(
    overrides: Mapping[str, Any], parameters: Mapping[str, Any], axes: Mapping[str, Any]
) -> dict[str, Expression]:
    """Expression of each parameter value that a call overrides, by name of the parameter.

    Raises
    ------
    UsageError
        No such parameter.
    ModelError
        A value that cannot be read.
    """
    values = {}
    for name, raw in overrides.items():
        if name not in parameters:
            axis = f'; configurations are chosen by text: configured("{name}={raw}")' if name in axes else ""
            raise UsageError(
                f'no parameter is named "{name}"{axis or did_you_mean(name, parameters)}', kind="unknown-parameter"
            )
        try:
            values[name] = read_scalar(raw)
        except EntryError as error:
            raise ModelError([error.fault.under("parameters", name)]) from None
    return values


def known_elements(names: Iterable[str] | str, elements: Mapping[str, Any]) -> list[str]:
    """Names of elements from one name or several, all of which exist, as a list.

    Raises
    ------
    UsageError
        No such element.
    """
    listed = [names] if isinstance(names, str) else list(names)
    for name in listed:
        if name not in elements:
            raise UsageError(f'no element is named "{name}"{did_you_mean(str(name), elements)}', kind="unknown-element")
    return listed
