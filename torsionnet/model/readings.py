"""Readings of sensors in any algebra, so that numbers, symbols and derivatives follow the same rules.

An angle, its rates and a twist are a motion of nodes. A torque is what the element's own laws and constraints do at one
node: of every law its torque times the coefficient there, and so of every constraint. The torque of a constraint is its
multiplier, which equilibrium gives: with a virtual motion z that violates this constraint alone by one,
lambda = z^T (B u - D(s) theta), the work of all laws and of the torques applied. A nominal shear stress is the torque
over the section modulus of a round shaft, pi (D^4 - d^4) / (16 D).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from torsionnet.base.errors import Fault, UsageError
from torsionnet.base.expressions import exact
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.model.channels import Sensor, channel_words, port_fault
from torsionnet.model.element_base.laws import own_node
from torsionnet.model.elements import GROUND, Element, Row, Values
from torsionnet.model.kinematics import Kinematics, virtual_motion

POWERS_OF_S = {"angle": 0, "velocity": 1, "acceleration": 2}
"""Power of s over the angle that a motion sensor reads, by its quantity."""


@dataclass(frozen=True)
class Reading:
    """Reading of a sensor as a motion of nodes, or as a sum of torques of an element's laws and constraints.

    It is s^power (row theta), or without a row sum_i laws[i] kappa_i (a_i theta) + sum_j constraints[j] lambda_j.

    Attributes
    ----------
    power : int
        Power of s: 0 for an angle, 1 for a velocity, 2 for an acceleration.
    row : Row, optional
        Weights of node angles.
    laws, constraints, actions : mapping
        Number of a law, constraint or action of the element -> factor of its torque.
    """

    power: int = 0
    row: Row | None = None
    laws: Mapping[int, Any] = field(default_factory=dict)
    constraints: Mapping[int, Any] = field(default_factory=dict)
    actions: Mapping[int, Any] = field(default_factory=dict)


def reading(
    sensor: Sensor,
    elements: Mapping[str, Element],
    value: Values,
    laws: Iterable[tuple[str, Row]],
    constraints: Iterable[tuple[str, Row]],
    actions: Iterable[tuple[str, Mapping[str, Any]]] = (),
) -> Reading:
    """Reading of a sensor in terms of node motions and of the torques of an element.

    Laws, constraints and actions are (element, row) in order.

    Raises
    ------
    UsageError
        No ratio leads to the shaft that the reading is referred to.
    """
    if sensor.quantity in POWERS_OF_S:
        measured = Reading(POWERS_OF_S[sensor.quantity], sensor.row)
    elif sensor.quantity == "twist":
        measured = Reading(0, elements[sensor.of].twist(value))
    else:
        # A torque at one node of the element: of each of its laws and constraints by the coefficient there.
        element = elements[sensor.of]
        node, sign = port_of(element, sensor.at)
        share: Any = sign
        if sensor.quantity == "stress":
            from torsionnet.model.element_base.round_section import section_modulus

            share = sign / section_modulus(element, value)
        tables: tuple[Iterable[tuple[str, Mapping[str, Any]]], ...] = (laws, constraints, actions)
        own, rigid, driving = (
            {i: share * row[node] for i, (owner, row) in enumerate(rows) if owner == element.name and node in row}
            for rows in tables
        )
        # An action drives with its torque where laws and constraints resist, hence the sign.
        measured = Reading(laws=own, constraints=rigid, actions={number: -factor for number, factor in driving.items()})
    if sensor.referred_to is None:
        return measured
    factor = referring_factor(sensor, elements, value)
    if measured.row is not None:
        return replace(measured, row={node: share * factor for node, share in measured.row.items()})
    own, rigid, driving = (
        {number: share * factor for number, share in shares.items()}
        for shares in (measured.laws, measured.constraints, measured.actions)
    )
    return replace(measured, laws=own, constraints=rigid, actions=driving)


def referring_factor(sensor: Sensor, elements: Mapping[str, Element], value: Values) -> Any:
    """Factor, without unit, from a sensor's reading at its own shaft to the shaft that it is referred to.

    For motions the speed ratio.

    Raises
    ------
    UsageError
        No ratio leads there.
    """
    own, shaft = sensor.of, str(sensor.referred_to)
    if sensor.is_on_element:
        element = elements[sensor.of]
        own = port_of(element, sensor.at)[0] if sensor.quantity == "torque" else own_node(element.ports)
    from torsionnet.model.element_base.speed_path import SpeedPaths

    path = SpeedPaths([element for element in elements.values() if element.enabled], value).between(own, shaft)
    if path is None:
        text = phrase(
            "{0}: no ratio leads from {1} to {2} in this configuration; close the clutch or gearbox in between, or "
            "measure at {1}",
            channel_words(sensor),
            ModelName(own),
            ModelName(shaft),
        )
        raise UsageError(Fault(text, kind="no-ratio"))
    # Power is the same at both shafts, so that torques go with 1/ratio.
    ratio = path.ratio(value)
    return 1 / ratio if sensor.quantity == "torque" else ratio


@dataclass(frozen=True)
class Balance:
    """Factors with which torques of laws, and torques applied to nodes, add up to a torque that is read.

    Attributes
    ----------
    laws : tuple of (int, factor)
        Laws of the element first, then for each of its constraints the laws that do work on its virtual motion.
    applied : mapping
        Share of the torque applied to each node; empty where no constraint is read.
    """

    laws: tuple[tuple[int, Any], ...]
    applied: Mapping[str, Any]


def balance(
    torque: Reading, kinematics: Kinematics, laws: Sequence[Row], number: Callable[[Any], Any] = exact
) -> Balance:
    """Factors of law torques and applied torques that make up the torque that a sensor reads.

    ``laws`` are the rows by which factors are numbered.

    Raises
    ------
    UsageError
        The torque of a constraint is statically indeterminate.
    """
    shares = [(law, number(factor)) for law, factor in torque.laws.items()]
    applied: dict[str, Any] = {}
    for constraint, read in torque.constraints.items():
        # lambda = z^T (B u - D theta): torques applied count as they are, those of the laws are taken off.
        opened, factor = virtual_motion(kinematics, constraint, number), number(read)
        for node, angle in opened.items():
            share = factor * angle
            applied[node] = applied[node] + share if node in applied else share
        for law, row in enumerate(laws):
            moved = [number(row[node]) * opened[node] for node in row if node in opened]
            if moved:
                shares.append((law, -(sum(moved, start=number(0)) * factor)))
    return Balance(tuple(shares), applied)


def port_of(element: Element, at: str | None) -> tuple[str, int]:
    """Name of the node of a port, and +1 or -1 for the sense in which its torque counts.

    +1 into the element at the first port, else -1.

    An element that drives by itself has -1 at all ports.

    A connection without inertia passes to ground the torque of its other end, so that end is returned instead.
    """
    fault = None if at is None else port_fault(element, at)
    if fault:
        raise UsageError(fault)
    nodes, index = list(element.ports.values()), element.place_of(at)
    if nodes[index] == GROUND:
        index = _other_end(element, index)
    return nodes[index], 1 if index == 0 and not element.drives else -1


def _other_end(element: Element, index: int) -> int:
    if element.glyph in ("spring", "damper", "coupling", "clearance", "friction") and len(element.ports) == 2:
        return 1 - index
    raise UsageError(
        f"attach {element.name} to a node with a lock instead of ground to read the torque there", kind="unfit-channel"
    )
