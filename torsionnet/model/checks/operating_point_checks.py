"""Checks of the mean speeds and torques about which a model is linear, and of the entries that depend on them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from torsionnet.core.errors import Fault, ModelError, Path, UsageError
from torsionnet.core.expressions import Expression
from torsionnet.core.units import RPM
from torsionnet.model.checks.balance import unbalanced_torques
from torsionnet.model.checks.load_checks import unfit_load
from torsionnet.model.definition import Definition
from torsionnet.model.element_base.element import Element
from torsionnet.model.element_base.laws import own_node
from torsionnet.model.kinematics import Kinematics
from torsionnet.model.load.external_torques import ExternalTorques, stated_torques
from torsionnet.model.operating_values import OperatingPoints, operating_parameter_faults, with_operating_values
from torsionnet.model.parameters import resolve

SPEED_ENTRY, SAME_SPEED_SHARE = "speed", 0.005
"""Entry of an element for the speed of its first node, and the share by which it may differ from that speed."""


def unfit_operation(
    definition: Definition, values: Mapping[str, Any], kinematics: Kinematics, *, sound: bool
) -> list[Fault]:
    """Faults of mean speeds and torques in one configuration, and of the entries that depend on them.

    Of an unsound structure only those independent of it.
    """
    external = ExternalTorques(definition, values)
    faults = _inconsistent_speeds(external)
    if faults or not sound:
        return faults if definition.load else faults + unbalanced_torques(external, kinematics)
    misfits = unfit_load(external) or operating_parameter_faults(external) or _beyond_curves(external)
    if misfits:
        return misfits
    return [
        *unbalanced_torques(external, kinematics),
        *_unlike_directions(external),
        *_unlike_working_speeds(external),
        *_unlike_at_rated_speed(external),
    ]


def _unlike_at_rated_speed(external: ExternalTorques) -> list[Fault]:
    """Warnings about powers and speeds at rated speed that do not agree.

    Their checks load numpy, which a model without speeds does not need.
    """
    if not external.rated_speed:
        return []
    from torsionnet.model.checks.propeller_conditions import archer_at_small_torque
    from torsionnet.model.checks.rating_mismatches import rating_mismatches

    return [*rating_mismatches(external), *archer_at_small_torque(external)]


def _inconsistent_speeds(external: ExternalTorques) -> list[Fault]:
    """Faults of mean speeds that contradict the gear ratios."""
    try:
        _ = external.mean_speeds
    except ModelError as error:
        return list(error.faults)
    return []


def _unlike_directions(external: ExternalTorques) -> Iterator[Fault]:
    """Warnings about torques of the operating point whose power is that of a consumer at an engine, or the opposite."""
    speeds, definition = external.mean_speeds, external.definition
    expected: dict[str, tuple[str, bool]] = {}
    for name, one in definition.excitations.items():
        if one.enabled and one.rating is not None and one.rating.torque:
            expected |= dict.fromkeys((*one.nodes, one.shaft), (name, one.rating.torque > 0))
    expected |= {own_node(one.ports): (one.name, False) for one in definition.active if one.absorbs}
    for node, torque in stated_torques(definition, external.values).items():
        if node in expected and torque * speeds.get(node, 0.0):
            yield from _wrong_way(node, torque, speeds, *expected[node])


def _wrong_way(node: str, torque: float, speeds: Mapping[str, float], name: str, drives: bool) -> Iterator[Fault]:
    if (torque * speeds[node] > 0) == drives:
        return
    sense = "in" if torque * speeds[node] > 0 else "against"
    text = f"{torque:.6g} N*m act {sense} the rotation of {node}, {speeds[node] * RPM:.6g} rpm"
    text += f", but {name} {'drives' if drives else 'takes power'} there; did you mean {-torque:.6g} N*m?"
    yield Fault(text, ("operating_point", "torque", node), "warning")


def _beyond_curves(external: ExternalTorques) -> list[Fault]:
    """Faults of operating values of elements that lie outside the rows of a curve, also over the range of speeds.

    One for each entry.
    """
    faults: dict[Path, Fault] = {}
    for where, values in _working_points(external):
        for path, what in _beyond(external.definition, values):
            faults.setdefault(path, Fault(where + what, path))
    return list(faults.values())


def _working_points(external: ExternalTorques) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Texts about the speed, and values of the parameters there, of the working points that are checked."""
    definition = external.definition
    if not definition.following:
        yield "", external.values
        return
    points = OperatingPoints(external)
    speeds = [external.operating_speed]
    if definition.speeds is not None and (definition.load or not definition.operating_point.torque):
        speeds += [definition.speeds.values[0], definition.speeds.values[-1]]
    for speed in speeds:
        values = resolve(with_operating_values(definition, points.at(speed)).parameters)[0]
        yield f"with {external.reference} at {speed * RPM:.6g} rpm, ", values


def _beyond(definition: Definition, values: Mapping[str, Any]) -> Iterator[tuple[Path, str]]:
    for element in (one for one in definition.active if one.reads_off):
        for path, spec, expression, _ in element.expressions():
            if reason := spec.curve_fault(float(expression.evaluate(values))):
                yield ("elements", element.name, *path), f"{expression} {reason}"


def _unlike_working_speeds(external: ExternalTorques) -> Iterator[Fault]:
    """Warnings about elements that are calculated at another speed than the load or the operating point gives them."""
    stated = [(one, speed) for one in external.definition.active if (speed := _stated(one))]
    turning = _speeds(external) if stated else {}
    values = _values(external) if turning else {}
    for element, speed in stated if turning else ():
        own, expected = abs(float(speed.evaluate(values))), _turning(element, turning)
        if expected and abs(own - expected) > SAME_SPEED_SHARE * expected:
            reference = external.reference
            where = f" with {reference} at {abs(turning[reference]) * RPM:.6g} rpm" if reference in turning else ""
            text = f"{element.name} is calculated at {own * RPM:.6g} rpm, but turns at {expected * RPM:.6g} rpm{where}"
            yield Fault(text, ("elements", element.name, SPEED_ENTRY), "warning")


def _speeds(external: ExternalTorques) -> dict[str, float]:
    """Speed in rad/s, by node, about which the model is linear; empty where nothing says one."""
    if external.mean_speeds or not external.definition.load:
        return external.mean_speeds
    try:
        reference = external.operating_speed
    except UsageError:
        return {}
    return {node: ratio * reference for node, ratio in external.ratios.items()}


def _stated(element: Element) -> Expression | None:
    if SPEED_ENTRY not in dict(element.specs()):
        return None
    found = element.expressions()
    return next((one for path, _, one, dimension in found if path == (SPEED_ENTRY,) and dimension == SPEED_ENTRY), None)


def _values(external: ExternalTorques) -> Mapping[str, Any]:
    """Value in SI units of every parameter, by name, those that follow the operating point taken at its speed."""
    definition = external.definition
    if not definition.following:
        return external.values
    at = OperatingPoints(external).at(external.operating_speed)
    return resolve(with_operating_values(definition, at).parameters)[0]


def _turning(element: Element, speeds: dict[str, float]) -> float:
    """Speed in rad/s of an element's first node, relative to its housing if it has one; 0 where unknown."""
    housing = getattr(element, "housing", None)
    node = next(iter(element.ports.values()))
    return abs(speeds.get(node, 0.0) - speeds.get(housing, 0.0)) if housing else abs(speeds.get(node, 0.0))
