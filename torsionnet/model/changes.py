"""Settings that change the operating point or the load of a model, named as they stand in its file.

Here as well: parameters made from values of elements, as ``dmf.stiffness``, so that these can vary.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, cast

from torsionnet.base.entries.scalars import QuantityKind
from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import Fault, ModelError, UsageError, did_you_mean
from torsionnet.base.expressions import Expression, Name
from torsionnet.model.configurations import Axes, Overlay
from torsionnet.model.definition import ELEMENTS, LOAD, Definition, section_of
from torsionnet.model.operating_point import OperatingPoint
from torsionnet.model.parameters import Parameter

POINT = "operating_point"
TORQUE, SPEED = "torque", "speed"
LOAD_SIZES = (f"{LOAD}.power", f"{LOAD}.{TORQUE}")
"""Names of the settings that change how large a load with one absorber is."""
FORMS = f"{POINT}.{TORQUE}.NODE, {POINT}.{SPEED}.NODE, {' or '.join(LOAD_SIZES)}"


def is_point_setting(name: str) -> bool:
    """Whether a name of a setting is that of an entry of the operating point or the load.

    >>> is_point_setting("operating_point.torque.crank"), is_point_setting("k_1")
    (True, False)
    """
    return name.partition(".")[0] in (POINT, LOAD) and "." in name


def setting_name(entry: str, place: str) -> str:
    """Name of the setting of a torque or speed at a place, as ``operating_point.torque.crank``."""
    return f"{POINT}.{entry}.{place}"


def with_point_settings(changes: Overlay, settings: Mapping[str, Any], definition: Definition) -> Overlay:
    """Changes to a model with entries of its operating point and load put in; entries not named stay.

    Raises
    ------
    UsageError
        A name that is no entry of an operating point, or of the load that the model has.
    ModelError
        A value that is no torque, speed or power, or that follows parameters which do not exist.
    """
    if not settings:
        return changes
    given: dict[str, dict[str, Any]] = {SPEED: {}, TORQUE: {}}
    entries: dict[str, Any] = {}
    for name, value in settings.items():
        section, entry, place = (*name.split(".", 2), "")[:3]
        if section == POINT and entry in given and place:
            given[entry][place] = value
        elif name in LOAD_SIZES:
            entries[name] = _load_size(name, value, definition)
        else:
            raise UsageError(
                f'"{name}" is no setting{did_you_mean(name, LOAD_SIZES)}; there are {FORMS}', kind="unknown-word"
            )
    point, faults = OperatingPoint.read(given)
    faults = [fault.under(POINT) for fault in faults]
    if point is not None:
        faults += [
            Fault(
                f"follows {other}, which is no parameter of the model", (POINT, entry, place), kind="unknown-parameter"
            )
            for entry in given
            for place, value in getattr(point, entry).items()
            for other in sorted(value.names - definition.parameters.keys())
        ]
    if faults or point is None:
        raise ModelError(faults, definition.name)
    changed = replace(changes, entries={**changes.entries, **entries})
    if changes.at is not None:
        return replace(changed, at=changes.at.with_overlay(point))
    return replace(changed, operating_point=(changes.operating_point or OperatingPoint()).with_overlay(point))


def point_settings_of(changes: Overlay) -> dict[str, Any]:
    """Settings that make the changes of an operating point and a load, by name."""
    point = changes.operating_point or OperatingPoint()
    settings = {
        setting_name(entry, place): value for entry in (SPEED, TORQUE) for place, value in getattr(point, entry).items()
    }
    return {**settings, **changes.entries}


def _load_size(name: str, value: Any, definition: Definition) -> Any:
    """Power or torque of the load as given; UsageError if the load of the model has no such entry."""
    entry = name.partition(".")[2]
    if definition.load is None:
        raise UsageError(f"{name}: the model has no load:; its torques stand under {POINT}:", kind="missing-entry")
    if getattr(definition.load, entry) is None:
        other = next((size for size in LOAD_SIZES if getattr(definition.load, size.partition(".")[2]) is not None), "")
        hint = f"its size is {other}" if other else "it has several absorbers, or a table over speed"
        raise UsageError(f"{name}: the load of the model has no {entry}; {hint}", kind="missing-entry")
    try:
        replace(definition.load, **{entry: value})
    except ModelError as error:
        raise ModelError([fault.under(LOAD) for fault in error.faults], definition.name) from None
    return value


def value_of_entry(definition: Definition, name: str) -> Expression | None:
    """Expression of an element's entry, as that of ``dmf.stiffness``.

    None if no element has such a physical quantity.
    """
    element, _, entry = name.rpartition(".")
    if element not in definition.elements:
        return None
    spec, value = definition.elements[element].scalars().get(entry, (None, None))
    return value if isinstance(spec, QuantityKind) and isinstance(value, Expression) else None


def can_be_named(definition: Definition, name: str) -> bool:
    """Whether an entry as ``dmf.stiffness`` is a plain value, and its name is not that of a parameter."""
    value = value_of_entry(definition, name)
    return name not in definition.parameters and value is not None and not value.names


def with_named_entries(definition: Definition, names: Iterable[str]) -> Definition:
    """Definition of a model with a parameter for each of the entries ``names``, as ``dmf.stiffness``.

    An alternative that gives the entry another value gives it to the parameter.
    """
    parameters, elements = dict(definition.parameters), dict(definition.elements)
    named = dict.fromkeys(names)
    for name in named:
        element, _, entry = name.rpartition(".")
        text = f"{entry.replace('_', ' ')} of {element}"
        parameters[name] = Parameter(value=not_none(value_of_entry(definition, name)), description=text)
        entries: dict[str, Any] = {entry: Name(name)}
        elements[element] = replace(elements[element], **entries)
    axes = _with_parameters(definition, named)
    return replace(definition, parameters=parameters, elements=elements, configurations=axes)


def _with_parameters(definition: Definition, named: Mapping[str, None]) -> Axes:
    return {
        axis: {label: _moved(definition, overlay, named) for label, overlay in alternatives.items()}
        for axis, alternatives in definition.configurations.items()
    }


def _moved(definition: Definition, overlay: Overlay, named: Mapping[str, None]) -> Overlay:
    """Changes of an alternative in which those of named entries are changes of parameters."""
    entries = dict(overlay.entries)
    parameters = dict(overlay.parameters)
    for name in named:
        section = section_of(definition, name) if name in entries else None
        if section is not None and section[0] == ELEMENTS:
            key = name.rpartition(".")[2]
            parameters[name] = cast("Expression", dict(section[2].specs())[key].coerce(entries.pop(name)))
    return replace(overlay, parameters=parameters, entries=entries)
