"""Natural frequencies of a drivetrain, counted from 1, with what swings against what and the nodes of vibration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from torsionnet.base.errors import TorsionnetError
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.modes.mode_pairs import VibrationMode, vibration_modes
from torsionnet.linear.modes.mode_shapes import Links
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.machinery.holzer.holzer_balance import balance_of
from torsionnet.model.speeds import speeds_by_reference

SECONDS_PER_MINUTE = 60.0
"""Factor from a frequency in Hz to vibrations per minute."""


@dataclass(frozen=True)
class CountedVibration:
    """Vibration with its number, undamped and damped natural frequency in Hz, damping ratio, nodes and what swings.

    Attributes
    ----------
    mode : int
        Number as in every other table: 1 is the lowest vibration.
    undamped_frequency, natural_frequency : float
        Hz, without damping and with it (``|lambda|/2pi``); nan where the mode exists only one way.
    damping_ratio : float
    n_nodes : int or None
        Number of nodes of vibration; None where an element ties three shafts, or has nodes inside.
    nodes : tuple of str
        Elements with these nodes in words, such as "in intermediate".
    against : str
        Masses with most of the kinetic energy in either sense of rotation, as "propeller against flywheel".
    remark : str
        Why a frequency is missing; empty if none is.
    """

    mode: Annotated[int, Out("mode")]
    undamped_frequency: Annotated[float, Out("undamped", "Hz", "undamped_natural_frequency_Hz", digits=4)]
    natural_frequency: Annotated[float, Out("with damping", "Hz", "natural_frequency_Hz", digits=4)]
    damping_ratio: Annotated[float, Out("damping ratio", "%", digits=3, factor=100)]
    n_nodes: Annotated[int | None, Out("nodes")]
    nodes: tuple[str, ...]
    against: Annotated[str, Out("what swings")]
    remark: Annotated[str, Out("remark")]

    @property
    def per_minute(self) -> Annotated[float, Out("undamped", "1/min", None, digits=5, after="undamped_frequency")]:
        """Undamped natural frequency of a mode in vibrations per minute."""
        return SECONDS_PER_MINUTE * self.undamped_frequency

    @property
    def node_places(self) -> Annotated[str, Out("nodes of vibration", json=None, after="n_nodes")]:
        """Text with the places of a mode's nodes of vibration, joined by commas."""
        return ", ".join(self.nodes)

    @property
    def lowest(self) -> float:
        """Lower one of a mode's natural frequencies in Hz without and with damping, or the only one it has."""
        both = (self.undamped_frequency, self.natural_frequency)
        return min(one for one in both if not math.isnan(one))


def natural_frequency_table(title: str, rows: tuple[CountedVibration, ...], notes: tuple[str, ...] = ()) -> Table:
    """Table of natural frequencies in Hz and per minute, with damping ratio in percent and number of nodes."""
    return result_table(title, rows, CountedVibration, notes=notes)


# Natural frequencies counted alike everywhere, with nodes of vibration and what swings against what.

LEAST_SHARE_NAMED, MOST_MASSES_NAMED = 0.15, 2
"""Share of the kinetic energy from which on a mass is named beside the largest one of its sense of rotation, and most
masses named of one sense: more would not be read in a table."""


def natural_frequencies(drivetrain: AssembledModel) -> tuple[CountedVibration, ...]:
    """Natural frequencies of all vibrations in Hz, by number of the mode, with nodes and what swings against what.

    The numbers are those of :meth:`torsionnet.Drivetrain.modes`, ``critical_speeds`` and ``holzer_table``: 1 is the
    lowest vibration with damping. Nodes are counted in the undamped shape, that of the Holzer table.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
    >>> (one,) = natural_frequencies(tn.Drivetrain("fan", elements))  # sqrt(1e4 (1/2 + 1)) rad/s
    >>> one.mode, round(one.undamped_frequency, 4), one.n_nodes, one.against
    (1, 19.4924, 1, 'b against a')
    """
    links = Links.of(drivetrain.assembly)
    senses = _senses(drivetrain)
    found = sorted(vibration_modes(drivetrain, modes(drivetrain)), key=lambda one: one.number)
    return tuple(_row(drivetrain, links, senses, one) for one in found)


def _row(
    drivetrain: AssembledModel, links: Links, senses: Mapping[str, float], mode: VibrationMode
) -> CountedVibration:
    assembly = drivetrain.assembly
    places = [assembly.node_index[name] for name in assembly.kinematics.coordinates]
    nodes = links.vibration_nodes(np.asarray(mode.shape[places], dtype=complex))
    return CountedVibration(
        mode.number, mode.undamped_frequency, mode.natural_frequency, mode.damping_ratio,
        None if nodes is None else len(nodes), tuple(nodes or ()), _against(drivetrain, senses, mode), mode.remark,
    )  # fmt: skip


def _senses(drivetrain: AssembledModel) -> dict[str, float]:
    """Sense of rotation, 1 or -1, of each node with a mean speed, against that of the first node."""
    reference = drivetrain.definition.speeds.of if drivetrain.definition.speeds else drivetrain.nodes[0]
    speeds = speeds_by_reference(drivetrain.definition, drivetrain.exact_values, reference)
    return {node: math.copysign(1.0, speed) for node, speed in speeds.items() if speed}


def _against(drivetrain: AssembledModel, senses: Mapping[str, float], mode: VibrationMode) -> str:
    """Text with the masses that have most of a mode's kinetic energy, forwards and backwards in their rotation."""
    shape = np.asarray(mode.shape)
    # The phase at which sum Re(phi)^2 is largest: a damped shape is nearly real there.
    angles = (shape * np.exp(-0.5j * np.angle(np.sum(shape**2)))).real
    frequency = mode.natural_frequency if math.isnan(mode.undamped_frequency) else mode.undamped_frequency
    try:
        inertias = balance_of(drivetrain, 2 * math.pi * frequency, angles).inertias
    except TorsionnetError:  # controllers drive nodes: no balance of masses and springs alone
        return ""
    signed = dict(zip(drivetrain.assembly.nodes, angles.tolist(), strict=True))
    # Kinetic energy J theta^2 of each mass, up to a factor common to all.
    energies = {node: inertia * signed[node] ** 2 for node, inertia in inertias.items() if inertia > 0}
    total = sum(energies.values())
    if not total:
        return ""
    sides = [
        _named(
            {node: size / total for node, size in energies.items() if sense * signed[node] * senses.get(node, 1) > 0}
        )
        for sense in (1, -1)
    ]
    sides.sort(key=lambda side: -side[1])
    return " against ".join(text for text, _ in sides if text)


def _named(shares: Mapping[str, float]) -> tuple[str, float]:
    """Text with the masses of the largest shares of the kinetic energy, and the largest share."""
    largest = sorted(shares, key=lambda node: -shares[node])
    kept = [node for node in largest[:MOST_MASSES_NAMED] if node == largest[0] or shares[node] >= LEAST_SHARE_NAMED]
    return ", ".join(kept), shares[largest[0]] if largest else 0.0
