"""Motion of every node in each mode of a drivetrain, for a page that moves the schematic, as JSON data."""

from __future__ import annotations

from typing import Any

import numpy as np

from torsionnet.app.explore.page_numbers import json_numbers
from torsionnet.base.errors import TorsionnetError
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.frequency_response import FloatArray
from torsionnet.linear.modes.modes import Modes

DIGITS = 6
"""Number of decimals of amplitudes and phases; a screen shows three."""
LEAST_SHARE = 1e-4
"""Least share of an element in the strain energy of a mode that is given; smaller ones have no colour to be seen."""


def mode_motion(rig: Drivetrain, modes: Modes) -> dict[str, Any]:
    """Motion of each mode and what the elements need to be coloured by, as JSON data.

    Returns
    -------
    dict
        ``modes``: rows with ``frequency_hz`` (natural, 0 of a rigid body), ``damped_hz``, ``damping_ratio`` (None of a
        rigid body), ``kind``, ``name``, ``description``, ``nodes``, which gives each node its amplitude, 1 at the node
        that moves most, and its phase in rad, and ``strain``, the shares of elements in the strain energy.
        ``elements``: for each element the nodes at its ends under ``nodes``, ground included, and ``mean_torque``
        in N m where mean torques determine it. ``notes``: what to know of the modes.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.Drivetrain("two discs", [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b",
    ...     inertia=1), tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)])
    >>> found = mode_motion(rig, rig.modes())
    >>> [(mode["name"], mode["nodes"]["a"]) for mode in found["modes"]]
    [('rigid body', [1.0, 0.0]), ('1', [0.5, 3.141593])]
    """
    torques = mean_torques(rig)
    return {
        "modes": [_mode(modes, number) for number in range(len(modes))],
        "elements": {
            name: {"nodes": list(dict.fromkeys(element.ports.values()))}
            | ({"mean_torque": torques[name]} if name in torques else {})
            for name, element in rig.elements.items()
        },
        "notes": list(modes.notes),
    }


def mean_torques(rig: Drivetrain) -> dict[str, float]:
    """Mean torques in N m by element, at the first node of each, of a drivetrain with a load or an operating point.

    Elements without one, as inertias and dampers, and those that mean torques do not determine are left out; empty
    where nothing gives mean torques, or these are out of balance.
    """
    try:
        loads = rig.static_state().loads
    except TorsionnetError:
        return {}
    found: dict[str, float] = {}
    for load in loads:
        if load.torque is not None and np.isfinite(load.torque):
            found.setdefault(load.element, float(load.torque))
    return found


def _mode(modes: Modes, number: int) -> dict[str, Any]:
    amplitude, phase = _motion(modes, number)
    (natural,), (damped,), (ratio,) = (
        json_numbers(values[number : number + 1])
        for values in (modes.natural_frequencies, modes.damped_frequencies, modes.damping_ratios)
    )
    moved = zip(amplitude.tolist(), phase.tolist(), strict=True)
    return {
        "frequency_hz": natural,
        "damped_hz": damped,
        "damping_ratio": ratio,
        "kind": modes.kinds[number],
        "name": modes.names[number],
        "description": modes.descriptions[number],
        "nodes": dict(zip(modes.nodes, map(list, moved), strict=True)),
        "strain": {
            name: round(share, DIGITS)
            for name, share in zip(modes.elements, modes.strain[:, number].tolist(), strict=True)
            if abs(share) >= LEAST_SHARE
        },
    }


def _motion(modes: Modes, number: int) -> tuple[FloatArray, FloatArray]:
    """Amplitudes, 1 at the node that moves most, and phases in rad of the nodes in a mode, each of shape (n_nodes,)."""
    shape = np.nan_to_num(modes.shapes[:, number])
    amplitude = np.abs(shape)
    largest = float(amplitude.max(initial=0.0))
    amplitude = np.round(amplitude / largest, DIGITS) if largest > 0 else amplitude
    # A phase of a node that stands still would be noise.
    phase = np.where(amplitude > 0, np.round(np.angle(shape), DIGITS), 0.0)
    return np.asarray(amplitude), np.asarray(phase + 0.0)
