"""Words of a report on conditions of operation: what the alternatives of configurations change of the model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from torsionnet.base.entries.spec import not_none
from torsionnet.base.expressions import Expression, Number
from torsionnet.base.number_text import typeset_unit
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.units import RPM
from torsionnet.model.checks.values import parameter_units
from torsionnet.model.condition_titles import ConditionTitles
from torsionnet.model.damping import MEASURES, DampingMeasure
from torsionnet.model.definition import EXCITATIONS, LOAD, section_of
from torsionnet.report.report_text import as_words, capital, unit

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.model.configurations import Overlay
    from torsionnet.report.report_data import ReportData

UNCHANGED = "as the model is written"
"""Words for an alternative that changes nothing."""
FIRING = {"misfire": "without ignition", "gas_off": "without gas torque"}
"""Words for the state of the cylinders that an entry of an engine names, by the entry."""
GAS = "gas"
"""Entry of an engine with its pressure traces."""
LONGEST_LIST = 12
"""Largest number of values in a list that is written out; of a longer one the length is given."""


def alternative_words(model: Drivetrain, overlay: Overlay) -> str:
    """Text of what an alternative of the configurations changes in the model, in words of the model's file.

    Examples
    --------
    >>> import torsionnet as tn
    >>> model = tn.load("marine_medium_speed")
    >>> axes = model.definition.configurations
    >>> print(alternative_words(model, axes["firing"]["misfire"]))
    Engine: each cylinder in turn without ignition
    >>> print(alternative_words(model, axes["coupling"]["stiff"]))
    Coupling: stiffness 0.40 MN·m/rad instead of 0.30 MN·m/rad (+33 %)
    """
    point = overlay.operating_point
    changes = [
        *(_changed_parameter_words(model, name, value) for name, value in overlay.parameters.items()),
        *(phrase("{name} switched on", name=_element(model, name)) for name in overlay.on),
        *(phrase("{name} switched off", name=_element(model, name)) for name in overlay.off),
        *(_changed_entry_words(model, key, value, overlay.by_files.get(key)) for key, value in overlay.entries.items()),
        *([] if point is None else [_named_value_text("operating_point", point.to_data(), None, "")]),
    ]
    return capital(joined("; ", changes)) if changes else capital(UNCHANGED)


def _changed_parameter_words(model: Drivetrain, name: str, value: Expression) -> str:
    """Text with the new value of a parameter beside the written one, and by how much they differ.

    The description of a parameter is that of the written value, so that it names the new one only where no element
    does.
    """
    number, written = float(value.evaluate(model.exact_values)), float(model.parameters[name])
    own = unit(parameter_units(model.definition)[name])
    share = (
        f" ({100 * (number / written - 1):+.0f} %)".replace("-", "−")
        if written and number and number != written
        else ""
    )
    before = _size(model.parameter_definitions[name].value, written, own)
    return phrase(
        "{what} {value} instead of {before}{share}",
        what=_meant(model, name) or model.parameter_definitions[name].description or as_words(name),
        value=_size(value, number, own),
        before=before,
        share=share,
    )


def _size(value: Expression, number: float, own: str) -> str:
    """Text of a value as it is written, or of its size where an expression gives it."""
    return typeset_unit(str(value)) if isinstance(value, Number) else f"{number:.6g} {own}"


def _meant(model: Drivetrain, name: str) -> str:
    """Text of the entry of the only element that has a parameter as its value; empty where there is none."""
    users = [
        (element, entry)
        for element in model.definition.elements.values()
        for entry, _ in element.specs()
        if name in getattr(getattr(element, entry), "names", ())
    ]
    if len(users) != 1:
        return ""
    ((element, entry),) = users
    value = getattr(element, entry)
    is_measured = isinstance(value, DampingMeasure) and name in value.value.names
    what = MEASURES[value.measure].name if is_measured else as_words(entry)
    return joined(": ", (as_words(element.name), phrase(what)))


def _element(model: Drivetrain, name: str) -> str:
    element = model.definition.elements[name]
    return element.description or as_words(name)


def _changed_entry_words(model: Drivetrain, key: str, value: Any, written: Any = None) -> str:
    """Text of a changed entry of an excitation, an element or the load, which its author may have written by a file."""
    owner, _, name = key.rpartition(".")
    section = section_of(model.definition, key)
    if section is not None and section[0] == EXCITATIONS:
        excitation = model.definition.excitations[owner]
        if name in FIRING:
            if excitation.absorbs:
                return joined(": ", (as_words(owner), _unloaded(excitation, value)))
            return joined("", (as_words(owner), ": ", _cylinders(value), " ", phrase(FIRING[name])))
        if name == "enabled":
            return phrase("{name} running" if value else "{name} not running", name=as_words(owner))
        known = excitation.to_data()
        before = known.get(name) if isinstance(known, Mapping) else None
        if isinstance(value, Mapping) and isinstance(before, Mapping):
            # What stays as it is written is no change.
            value = {key: new for key, new in value.items() if str(before.get(key)) != str(new)} or value
    what = phrase("load") if owner == LOAD else as_words(owner)
    points = "{name}: pressure trace of {count} points" if name == GAS else "{name}: {count} values"
    return joined("", (what, ": ", _named_value_text(name, value, written, points)))


def _unloaded(excitation: Any, value: Any) -> str:
    """Text of the cylinders of a compressor that are unloaded: all alike, or some beside others that are not."""
    known = {str(number) for number in getattr(excitation, "numbers", ())}
    if isinstance(value, Sequence) and not isinstance(value, str) and {*map(str, value)} == known:
        return phrase("all cylinders unloaded alike")
    return phrase("{cylinders} unloaded, the others loaded", cylinders=_cylinders(value))


def _cylinders(value: Any) -> str:
    if value == "each":
        return phrase("each cylinder in turn")
    numbers = list(value) if isinstance(value, Sequence) and not isinstance(value, str) else [value]
    template = "cylinders {number}" if len(numbers) > 1 else "cylinder {number}"
    return phrase(template, number=", ".join(map(str, numbers)))


def _named_value_text(name: str, value: Any, written: Any, points: str) -> str:
    """Text of an entry with its name and its value; of a list too long, ``points`` or the file that it came from."""
    if isinstance(value, Mapping) and not _is_long(value.get("pressures")):
        own = written if isinstance(written, Mapping) else {}
        each = (_named_value_text(str(key), inner, own.get(key), points) for key, inner in value.items())
        return joined(" ", (phrase(as_words(name)), joined(", ", each)))
    pressures = value["pressures"] if isinstance(value, Mapping) else value
    if not _is_long(pressures):
        return joined(" ", (phrase(as_words(name)), _listed(value)))
    template = "{name}: pressure trace of {file}, {count} points" if isinstance(written, str) else points
    return phrase(template, name=as_words(name), file=written, count=len(pressures))


def _is_long(value: Any) -> bool:
    """Whether a value is a list too long to be written out."""
    return isinstance(value, Sequence) and not isinstance(value, str) and len(value) > LONGEST_LIST


def _listed(value: Any) -> str:
    if value is None:
        return phrase("left out")
    if isinstance(value, bool):
        return phrase("yes") if value else phrase("no")
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ", ".join(map(_listed, value))
    return typeset_unit(str(value)) if isinstance(value, str) and "*" in value else as_words(str(value))


def speed_words(subject: ReportData) -> str:
    """Sentences with the shaft, the ranges of speeds in rpm that are calculated in the conditions, and rated speed."""
    speeds = subject.model.definition.speeds
    if speeds is None:
        return ""
    rated = phrase("; rated speed {speed:.6g} rpm", speed=speeds.rated * RPM) if speeds.rated else ""
    ranges: dict[tuple[float, float], list[str]] = {}
    for case in subject.judged_cases:
        values = not_none(case.drivetrain.definition.speeds).values
        ranges.setdefault((values[0] * RPM, values[-1] * RPM), []).append(case.configuration)
    known = [case.configuration for case in subject.judged_cases]
    if len(ranges) > 1:
        template = "Speeds in {conditions}: {low:.6g} to {high:.6g} rpm of {node}{rated}."
        return joined(" ", (
            phrase(template, low=low, high=high, node=as_words(speeds.of), rated=rated,
                   conditions=subject.titles.several(names, known))
            for (low, high), names in ranges.items()
        ))  # fmt: skip
    ((low, high),) = ranges
    return phrase(
        "Speeds in every condition: {low:.6g} to {high:.6g} rpm of {node}{rated}.",
        low=low,
        high=high,
        node=as_words(speeds.of),
        rated=rated,
    )


def load_words(model: Drivetrain) -> str:
    """Sentence on who absorbs and who drives with which share of the power; empty where one does each."""
    load = model.definition.load
    if load is None or len(load.by_place) + len(load.driven_by) < 3:
        return ""
    shares = ", ".join(f"{as_words(name)} {100 * share:.4g} %" for name, share in load.driven_by.items())
    absorbers = ", ".join(map(as_words, load.by_place))
    given = phrase(" and given by {shares}.", shares=shares) if shares else "."
    return joined("", (phrase("Power is absorbed at {nodes}", nodes=absorbers), given))


def unexamined(model: Drivetrain, titles: ConditionTitles, examined: Sequence[str]) -> Iterator[str]:
    """Yield titles of alternatives that no examined configuration has."""
    for axis, alternatives in model.axes.items():
        for name in alternatives:
            label = f"{axis}={name}" if len(model.axes) > 1 else name
            if all(label not in condition.split(",") for condition in examined):
                yield titles.alternative(axis, name)
