"""Checks of the mean speeds and torques about which a model is linear, and of the entries that depend on them.

Here as well: check that the mean torques of the operating point are in balance; checks that the load fits the
drivetrain, its speeds and its operating point.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import EntryPath, Fault, ModelError, UsageError, unknown_name
from torsionnet.base.expressions import Expression
from torsionnet.base.packages import imported
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.base.units import RPM
from torsionnet.model.definition import Definition, all_nodes, with_operating_values
from torsionnet.model.element_base.element import Element
from torsionnet.model.element_base.laws import own_node
from torsionnet.model.kinematics import Kinematics, free_motions
from torsionnet.model.load.external_torques import (
    UNBALANCED_SHARE,
    CutOffError,
    ExternalTorques,
    stated_torques,
    unknown_driver,
)
from torsionnet.model.operating_point import torque_place
from torsionnet.model.operating_values import OperatingPoints, operating_parameter_faults
from torsionnet.model.parameters import resolve
from torsionnet.model.sections import CONDITIONS_AT_RATED_SPEED

if TYPE_CHECKING:
    from torsionnet.model.load.load_section import Load


def unbalanced_torques(external: ExternalTorques, kinematics: Kinematics) -> list[Fault]:
    """Warnings about mean torques out of balance on a part that turns freely, as a load with the sign of a drive.

    Springs hand mean torques on and dampers stand for vibration, so neither takes any. A single torque is half of what
    acts there, and says nothing. Those of a load are in balance as a whole: what is left on one part is an error. Laws
    of motion take torques too, so that their operating point tells what is left.
    """
    definition = external.definition
    if any(element.has_motion_laws for element in definition.switched_on):
        return []
    acting = external.at_operating_point
    given = {node: torque for node, torque in acting.items() if torque and node in kinematics.nodes}
    if len(given) < 2:
        return []
    fewest = 2 if definition.load is None else 1
    left = free_motions(kinematics, lambda law: law.is_elastic)
    work: dict[str, dict[str, float]] = {}
    for node, torque in given.items():
        for motion, ratio in left.in_floats({node: 1}).items():
            work.setdefault(motion, {})[node] = torque * ratio
    faults = [fault for done in work.values() if len(done) >= fewest for fault in _unbalanced(given, done)]
    if definition.load is None:
        return faults
    return [replace(fault, path=("load",), severity="error") for fault in faults]


def _unbalanced(given: Mapping[str, float], done: Mapping[str, float]) -> list[Fault]:
    """Warning that mean torques do net work on one rigid motion of the drivetrain.

    ``done`` is the work of each torque.
    """
    rest, largest = sum(done.values()), max(map(abs, done.values()))
    if abs(rest) <= UNBALANCED_SHARE * largest:
        return []
    last = list(done)[-1]
    # What is left as a torque at the last node, whose work is the torque times a ratio.
    over = rest * given[last] / done[last]
    listed = ", ".join(f"{node} {given[node]:.6g} N*m" for node in done)
    # A torque of the wrong sign leaves twice its own work over.
    turned = [node for node in done if abs(rest - 2 * done[node]) <= UNBALANCED_SHARE * largest]
    hint = f'; did you mean "{turned[-1]}: {-given[turned[-1]]:.6g} N*m"?' if turned else ""
    text = (
        f"the mean torques ({listed}) leave {over:.4g} N*m over at {last}, and a load acts against the rotation{hint}"
    )
    return [Fault(text, ("operating_point", "torque"), "warning", on_key=True, kind="unbalanced-torques")]


SAME_TORQUE_SHARE = 0.01
"""Relative difference up to which torques of the load and of the operating point agree, rounded as in data sheets."""


def unknown_in_load(definition: Definition, load: Load) -> Iterator[Fault]:
    """Faults of nodes and excitations that a load names and the model does not have."""
    nodes = all_nodes(definition.elements.values())
    single: EntryPath = ("load", "absorbed_at")
    for place in load.by_place:
        path = ("load", "absorbers", place) if load.absorbers else single
        for node in torque_place(place).nodes:
            if node not in nodes:
                yield unknown_name("node", node, nodes, path, on_key=bool(load.absorbers))
    for name in load.driven_by:
        fault = unknown_driver(definition, name, ("load", "driven_by", name))
        if fault:
            yield fault


def unfit_load(external: ExternalTorques) -> list[Fault]:
    """Faults of a load that does not turn with the drivetrain, has no rated speed or table row, or is contradicted."""
    definition = external.definition
    if definition.load is None:
        return []
    try:
        at = external.operating_speed
        torques = external.at_operating_point if at > 0 else external.at(abs(at))
        for speed in _extremes(definition):
            external.at(speed)
    except CutOffError as error:
        return [Fault(str(error), ("load",), "note", on_key=True, kind="no-effect")]
    except UsageError as error:
        return [Fault(str(error), ("load",), on_key=True, kind="missing-entry")]
    if at < 0:
        text = f"with a load, {external.reference} turns in the positive sense: its mean speed must not be negative"
        return [Fault(text, ("operating_point", "speed"), on_key=True, kind="out-of-range")]
    return list(_contradicted(external, torques, at))


def _extremes(definition: Definition) -> tuple[float, ...]:
    return (definition.speeds.values[0], definition.speeds.values[-1]) if definition.speeds else ()


def _contradicted(external: ExternalTorques, torques: Mapping[str, float], at: float) -> Iterator[Fault]:
    """Faults of stated torques that contradict the load, at single nodes or in the power driven in all."""
    stated = stated_torques(external.definition, external.values)
    apart = [node for node in stated if node in torques and not _agree(stated[node], torques[node])]
    for node in apart:
        text = f"the load gives {torques[node]:.6g} N*m here at this speed, the operating point {stated[node]:.6g} N*m"
        yield Fault(f"{text}; leave one of them out", ("operating_point", "torque", node), kind="contradicting-entries")
    if not stated or apart:
        return
    speeds = {node: ratio * at for node, ratio in external.ratios.items()}
    driven, load = (
        sum(max(0.0, torque * speeds.get(node, 0.0)) for node, torque in side.items()) for side in (stated, torques)
    )
    if driven and not _agree(driven, load):
        text = (
            f"these torques drive with {driven / 1e3:.6g} kW, the load takes {load / 1e3:.6g} kW; leave one of them out"
        )
        yield Fault(text, ("operating_point", "torque"), on_key=True, kind="contradicting-entries")


def _agree(first: float, second: float) -> bool:
    return abs(first - second) <= SAME_TORQUE_SHARE * max(abs(first), abs(second))


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
    return [fault for place in CONDITIONS_AT_RATED_SPEED for fault in imported(place)(external)]


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
    for name, excitation in definition.excitations.items():
        if excitation.enabled and excitation.rating is not None and excitation.rating.torque:
            expected |= dict.fromkeys((*excitation.nodes, excitation.shaft), (name, excitation.rating.torque > 0))
    expected |= {own_node(element.ports): (element.name, False) for element in definition.active if element.absorbs}
    for node, torque in stated_torques(definition, external.values).items():
        if node in expected and torque * speeds.get(node, 0.0):
            yield from _wrong_way(node, torque, speeds, *expected[node])


def _wrong_way(node: str, torque: float, speeds: Mapping[str, float], name: str, drives: bool) -> Iterator[Fault]:
    if (torque * speeds[node] > 0) == drives:
        return
    sense = "in" if torque * speeds[node] > 0 else "against"
    text = f"{torque:.6g} N*m act {sense} the rotation of {node}, {speeds[node] * RPM:.6g} rpm"
    meant = f"{-torque:.6g} N*m"
    text += f", but {name} {'drives' if drives else 'takes power'} there; did you mean {meant}?"
    yield Fault(text, ("operating_point", "torque", node), "warning", meant=meant, kind="wrong-sense")


def _beyond_curves(external: ExternalTorques) -> list[Fault]:
    """Faults of operating values of elements that lie outside the rows of a curve, also over the range of speeds.

    One for each entry.
    """
    faults: dict[EntryPath, Fault] = {}
    for where, values in _working_points(external):
        for path, what in _beyond(external.definition, values):
            faults.setdefault(path, Fault(phrase("{}{}", where, what), path, kind="out-of-range"))
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
        yield phrase("with {} at {:.6g} rpm, ", ModelName(external.reference), speed * RPM), values


def _beyond(definition: Definition, values: Mapping[str, Any]) -> Iterator[tuple[EntryPath, str]]:
    for element in (element for element in definition.active if element.reads_off):
        for path, spec, expression, _ in element.expressions():
            if reason := spec.curve_fault(float(expression.evaluate(values))):
                yield ("elements", element.name, *path), phrase("{} {}", expression, reason)


def _unlike_working_speeds(external: ExternalTorques) -> Iterator[Fault]:
    """Warnings about elements that are calculated at another speed than the load or the operating point gives them."""
    stated = [(element, speed) for element in external.definition.active if (speed := _stated(element))]
    turning = _speeds(external) if stated else {}
    values = _values(external) if turning else {}
    for element, speed in stated if turning else ():
        own, expected = abs(float(speed.evaluate(values))), _turning(element, turning)
        if expected and abs(own - expected) > SAME_SPEED_SHARE * expected:
            reference = external.reference
            said = "{} is calculated at {:.6g} rpm, but turns at {:.6g} rpm"
            text = phrase(said, ModelName(element.name), own * RPM, expected * RPM)
            if reference in turning:
                text = phrase("{} with {} at {:.6g} rpm", text, ModelName(reference), abs(turning[reference]) * RPM)
            yield Fault(text, ("elements", element.name, SPEED_ENTRY), "warning", kind="implausible-size")


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
    expressions = element.expressions()
    return next(
        (formula for path, _, formula, dimension in expressions if path == (SPEED_ENTRY,) and dimension == SPEED_ENTRY),
        None,
    )


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
