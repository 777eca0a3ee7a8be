"""Holzer tables of modes and of trial frequencies, for chains, branches and gears."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.modes.eigen import undamped_modes
from torsionnet.linear.modes.mode_pairs import undamped_place
from torsionnet.machinery.holzer.holzer_balance import (
    HolzerBalance,
    HolzerLine,
    Neighbours,
    NodeLoad,
    balance_of,
    holzer_lines,
    trial_angles,
)
from torsionnet.machinery.holzer.holzer_table import HolzerBranch, HolzerLink, HolzerStation, HolzerTable
from torsionnet.model.elements import Values
from torsionnet.model.elements.shaft import Shaft
from torsionnet.model.operating_values import law_notes
from torsionnet.model.speeds import speeds_by_reference

LEAST_AMPLITUDE = 1e-9
"""Amplitude of the first station, over the largest, up to which a Holzer table cannot be scaled to 1 there."""


def holzer_table(
    drivetrain: AssembledModel,
    mode: int | None = None,
    *,
    at: float | None = None,
    first: str | None = None,
    amplitude: float = 1.0,
    referred_to: str | None = None,
) -> HolzerTable:
    """Holzer table of a mode or trial frequency: amplitudes, torques and twists station by station, undamped.

    Parameters
    ----------
    mode : int, optional
        Number of the mode as in :meth:`modes`: 1 is the lowest vibration, rigid bodies and real poles have none.
    at : float, optional
        Instead, a trial frequency in Hz: a torque remains at the last station.
    first : str, optional
        The station to begin with; default: the first free end of the model.
    amplitude : float
        rad at the first station.
    referred_to : str, optional
        Node of the shaft that referred quantities belong to; default: the first station.

    Raises
    ------
    UsageError
        No such mode or node, or not one of mode and trial frequency.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
    >>> fan = tn.Drivetrain("fan", elements)  # at 10 rad/s: 200 N m twist the shaft by 0.02 rad
    >>> round(fan.holzer_table(at=10 / 6.283185307179586).remainder, 9)
    298.0
    """
    if (mode is None) == (at is None):
        raise UsageError("a Holzer table is of a mode (mode=1) or of a trial frequency (at=12.0 in Hz), one of the two")
    if not 0 < amplitude < math.inf:
        raise UsageError(f"the amplitude of the first station is above 0 rad, got {amplitude}")
    for name in (first, referred_to):
        if name is not None and name not in drivetrain.nodes:
            raise UsageError(f'no node is named "{name}"{did_you_mean(name, drivetrain.nodes)}')
    still = balance_of(drivetrain, 0.0, np.zeros(len(drivetrain.assembly.nodes)))
    order, tree = holzer_lines(drivetrain.assembly.nodes, still.loads, first)
    start, end = order[0].nodes[0], order[0].nodes[-1]
    if mode is not None:
        omega, angles, notes = _mode(drivetrain, mode, start)
        balance = balance_of(drivetrain, omega, amplitude * angles)
        rests = abs(angles[drivetrain.assembly.node_index[start]]) <= LEAST_AMPLITUDE
    else:
        omega, notes, rests = _trial_rate(at), (), False
        angles = trial_angles(drivetrain, omega, start, end)
        balance = balance_of(drivetrain, omega, amplitude * angles, end)
    # Again, as springs whose stiffness depends on frequency may be absent at 0 Hz.
    order, tree = holzer_lines(drivetrain.assembly.nodes, balance.loads, first)
    shaft = referred_to or start
    ratios = speeds_by_reference(drivetrain.definition, drivetrain.exact_values, shaft)
    own = ratios.get(shaft) or 1.0
    walk = _HolzerWalk(drivetrain, balance, tree, {node: speed / own for node, speed in ratios.items() if speed})
    branches = tuple(walk.branches(order))
    hertz = omega / (2 * math.pi)
    notes = (*notes, *law_notes(drivetrain.definition), *range_notes(drivetrain.assembly, [hertz]))
    return HolzerTable(hertz, mode, shaft, branches, drivetrain.title, notes, bool(rests), drivetrain.configuration)


def _trial_rate(at: float | None) -> float:
    if at is None or not 0 < at < math.inf:
        raise UsageError(f"a trial frequency is above 0 Hz, got {at}")
    return 2 * math.pi * at


def _mode(drivetrain: AssembledModel, mode: int, start: str) -> tuple[float, FloatArray, tuple[str, ...]]:
    """Frequency in rad/s, angles (n_nodes,) and notes of an undamped mode, 1 at a first station that moves.

    Else it is 1 at the station that moves most.
    """
    assembly = drivetrain.assembly
    rates, shapes = undamped_modes(assembly.system)
    at, pair = undamped_place(drivetrain, mode)
    place = np.flatnonzero(rates)[at]
    notes = () if not pair.is_shifted else (f"with damping its natural frequency is {pair.natural_frequency:.5g} Hz",)
    angles = np.asarray(assembly.node_rows.dense @ shapes[:, place])
    # Scaled to 1 where it moves most, so that the amplitude of the first station is judged against that.
    angles /= np.abs(angles).max()
    at_start = angles[assembly.node_index[start]]
    if abs(at_start) > LEAST_AMPLITUDE:
        return float(rates[place]), angles / at_start, notes
    note = f"{start} stands still in this mode: the amplitude is that of the station that moves most"
    return float(rates[place]), angles, (note, *notes)


@dataclass
class _HolzerWalk:
    """Summation of torques in N m, station by station, along the lines of a Holzer table."""

    drivetrain: AssembledModel
    balance: HolzerBalance
    tree: Neighbours
    ratios: Mapping[str, float]
    branch_torques: dict[str, float] = field(default_factory=dict)
    """Torques in N m that branches bring to the node they join, by node."""

    def branches(self, order: Sequence[HolzerLine]) -> list[HolzerBranch]:
        """Branches of the Holzer table, with angles and torques by station, in the order of the lines.

        Each is summed before the line that it joins.
        """
        self._add_other_torques()
        found = {line: self._branch(line) for line in reversed(order)}
        return [found[line] for line in order]

    def _add_other_torques(self) -> None:
        """Add the torques of connections outside the lines, as springs to ground, locks, planetary sets, loops."""
        followed = {id(load) for ends in self.tree.values() for loads in ends.values() for load in loads}
        for load in self.balance.loads:
            # The walk accounts for both ends of what it follows; on other nodes, as the housing of a gear, the
            # torque acts from outside.
            passed = load.ends if id(load) in followed else ()
            for node, value in load.row.items():
                if node in passed:
                    continue
                self.branch_torques[node] = self.branch_torques.get(node, 0.0) - value * load.torque

    def _branch(self, line: HolzerLine) -> HolzerBranch:
        stations = []
        carried = 0.0
        for node, after in line.steps():
            joined = self.branch_torques.get(node, 0.0)
            inertia_torque = self.balance.inertia_torques[node]
            # T_i = T_(i-1) + omega^2 J_i theta_i + torques of branches that join here.
            torque = carried + inertia_torque + joined
            link = self._link(node, after, torque) if after else None
            stations.append(
                HolzerStation(
                    node,
                    self.ratios.get(node, math.nan),
                    self.balance.inertias[node],
                    self.balance.angles[node],
                    inertia_torque,
                    joined,
                    torque,
                    link,
                )
            )
            # A rigid link passes power on: torque times angle is the same at both ends.
            carried = torque * link.ratio if link else 0.0
        if line.joins:
            self.branch_torques[line.joins] = self.branch_torques.get(line.joins, 0.0) + carried
        return HolzerBranch(line.joins or None, tuple(stations))

    def _link(self, node: str, after: str, torque: float) -> HolzerLink:
        loads = self.tree[node][after]
        first, stiffness = loads[0], sum(load.stiffness_at(node) for load in loads)
        # row @ theta = 0 of a rigid link: theta_node/theta_after = -row[after]/row[node].
        ratio = -first.row[after] / first.row[node]
        # gamma = T/k of the row, as an angle at this station.
        twist = 0.0 if math.isinf(stiffness) else first.torque / first.stiffness / first.row[node]
        stress = max((self._stress(load, node, torque, stiffness) for load in loads), default=math.nan)
        return HolzerLink(tuple(dict.fromkeys(load.element for load in loads)), stiffness, twist, stress, ratio)

    def _stress(self, load: NodeLoad, node: str, torque: float, stiffness: float) -> float:
        """Nominal shear stress in Pa of a shaft by its share of the torque in N m, nan for other elements."""
        shaft = self.drivetrain.elements[load.element]
        if not isinstance(shaft, Shaft):
            return math.nan
        value = Values(self.drivetrain.exact_values)
        outer, inner = float(value(shaft.outer_diameter)), float(value(shaft.inner_diameter))
        # Parallel elements twist alike: torque goes by stiffness.
        share = load.stiffness_at(node) / stiffness
        # tau = 16 T D/(pi (D^4 - d^4)) at the surface.
        return abs(torque * share) * 16 * outer / (math.pi * (outer**4 - inner**4))
