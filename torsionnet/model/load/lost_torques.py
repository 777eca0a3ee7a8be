"""Mean torque that piston machines keep in a condition with a cylinder lost.

The pressures of the cylinders that work stay those of the same speed, as they do in the torques by order; nothing makes
up for what is lost. A driver gives less, and all who absorb take less in the same proportion; a compressor takes less.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.model.channels import Input
from torsionnet.model.definition import Definition

FloatArray = NDArray[np.float64]


def has_lost_cylinders(definition: Definition) -> bool:
    """Whether a piston machine that runs has a cylinder without injection or without gas torque."""
    machines = definition.excitations.values()
    return any(machine.enabled and machine.has_lost_cylinder for machine in machines)


def has_lost_torque(definition: Definition) -> bool:
    """Whether a piston machine that runs has a cylinder that gives less torque by misfire, in part or whole."""
    machines = definition.excitations.values()
    return any(machine.enabled and machine.has_lost_torque for machine in machines)


def with_all_working(definition: Definition) -> Definition:
    """Definition of the same model in which no piston machine has lost a cylinder."""
    machines = {name: machine.all_working() for name, machine in definition.excitations.items()}
    return replace(definition, excitations=machines)


def remaining_by_node(
    definition: Definition,
    ratios: Mapping[str, float],
    speeds: FloatArray,
    drivers: Iterable[Input],
    absorbers: Iterable[Input],
) -> dict[str, FloatArray]:
    """Mean torque over that with all cylinders working, (n_speeds,), by node at which a machine lost cylinders.

    A machine whose cylinders are not all on nodes of the load acts at the only driver (a compressor: absorber) that is
    no other machine's, by the mean over its cylinders. Empty where nothing is lost, or where that node is not clear.

    Parameters
    ----------
    definition : Definition
    ratios : mapping
        Node -> its speed over that of the reference node.
    speeds : (n_speeds,) array
        rad/s, of the reference node.
    drivers, absorbers : iterable of Input
        Places of the load.
    """
    machines = {
        name: machine for name, machine in definition.excitations.items() if machine.numbers and machine.enabled
    }
    remaining: dict[str, FloatArray] = {}
    for name, machine in machines.items():
        if not machine.has_lost_torque:
            continue
        ratio = abs(ratios.get(machine.shaft, 0.0))
        if not ratio:
            continue
        shares = machine.mean_torque_shares(ratio * speeds)
        places = {place.of for place in (absorbers if machine.absorbs else drivers)}
        own = {*machine.numbers.values()}
        others = {node for other, neighbour in machines.items() if other != name for node in neighbour.numbers.values()}
        if own <= places:
            for node in own:
                remaining[node] = np.mean(
                    [shares[number] for number, at in machine.numbers.items() if at == node], axis=0
                )
        elif len(places - others) == 1:
            remaining[(places - others).pop()] = np.mean([*shares.values()], axis=0)
    return remaining
