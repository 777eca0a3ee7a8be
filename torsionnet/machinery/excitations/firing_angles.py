"""Crank angles at which the cylinders of an engine fire."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence

FIRING_ANGLE_TOL = math.radians(0.5)
"""Angle in rad by which firing angles may differ from crank and banks, as makers state them to a degree or less."""


def even_phases(order: Sequence[int], cycle: float) -> dict[int, float]:
    """Firing angle in rad by cylinder of an engine that fires evenly over a cycle in rad, the first cylinder at 0.

    >>> [round(math.degrees(angle)) for angle in even_phases([1, 5, 3, 6, 2, 4], 4 * math.pi).values()]
    [0, 120, 240, 360, 480, 600]
    """
    return {number: place * cycle / len(order) for place, number in enumerate(order)}


def banked_phases(
    order: Sequence[int], cycle: float, throws: Mapping[int, str], places: Mapping[int, float]
) -> dict[int, float] | None:
    """Firing angle in rad by cylinder of several banks that share crank pins; None if the order does not fix them.

    All fire evenly if the pins allow that, as in a cross-plane V8. Else those of the bank at angle 0 do, and a cylinder
    in another bank fires when its pin has turned to that bank, in this revolution or the next, as the order says. None
    where the order cannot be had with these banks, or with either revolution.

    Parameters
    ----------
    order : sequence of int
        All cylinders.
    cycle : float
        rad.
    throws : mapping
        Cylinder -> name of its throw.
    places : mapping
        Cylinder -> angle of its bank in the direction of rotation, rad.

    Examples
    --------
    >>> order, throws = [1, 4, 2, 3], {1: "a", 2: "b", 3: "a", 4: "b"}
    >>> places = {1: 0, 2: 0, 3: math.pi / 2, 4: math.pi / 2}
    >>> {one: round(math.degrees(at)) for one, at in banked_phases(order, 4 * math.pi, throws, places).items()}
    {1: 0, 4: 90, 2: 360, 3: 450}
    """
    evenly = even_phases(order, cycle)
    if firing_against_banks(evenly, throws, places) is None:
        return evenly
    leading = even_phases([number for number in order if not places[number]], cycle)
    on_throw = {throws[number]: angle for number, angle in leading.items()}
    turns = [2 * math.pi * number for number in range(round(cycle / (2 * math.pi)))]
    choices = []
    for number in order:
        if number in leading:
            choices.append([leading[number]])
        elif throws[number] not in on_throw:
            return None
        else:
            at = on_throw[throws[number]] + places[number]
            choices.append([(at + turn) % cycle for turn in turns])
    return _in_order(order, choices, cycle)


def shares_pins(throws: Mapping[int, str], places: Mapping[int, float]) -> bool:
    """Whether the nodes of the cylinders are crank pins that banks share.

    Cylinders of different banks share a throw, cylinders of one bank do not.
    """
    places_on: dict[str, list[float]] = {}
    for number, throw in throws.items():
        places_on.setdefault(throw, []).append(places.get(number, 0.0))
    several = [found for found in places_on.values() if len(found) > 1]
    return bool(several) and all(len(set(found)) == len(found) for found in several)


def _in_order(order: Sequence[int], choices: Sequence[Sequence[float]], cycle: float) -> dict[int, float] | None:
    """Firing angle in rad by cylinder, one of its choices each, with which the cylinders fire in this order.

    None if no or several choices do.
    """
    found: list[list[float]] = [[one] for one in choices[0]]
    for further in choices[1:]:
        found = [
            [*before, angle]
            for before, angle in itertools.product(found, further)
            if (before[-1] - before[0]) % cycle < (angle - before[0]) % cycle - FIRING_ANGLE_TOL / 10
        ]
    if len(found) != 1:
        return None
    return {number: (angle - found[0][0]) % cycle for number, angle in zip(order, found[0], strict=True)}


def firing_against_banks(
    phases: Mapping[int, float], throws: Mapping[int, str], places: Mapping[int, float]
) -> tuple[int, int, float, float] | None:
    """Numbers and angles of the first two cylinders on one throw whose firing angles do not fit their banks, or None.

    The tuple is (cylinder, cylinder, angle between them in rad, angle by their banks in rad).

    Firing comes once in a cycle and top dead centre once in a revolution, so whole revolutions do not count.
    """
    if not shares_pins(throws, places):
        return None
    for one, other in itertools.combinations(phases, 2):
        if throws[one] == throws[other]:
            apart, due = phases[other] - phases[one], places[other] - places[one]
            if abs(math.remainder(apart - due, 2 * math.pi)) > FIRING_ANGLE_TOL:
                return one, other, apart, due
    return None
