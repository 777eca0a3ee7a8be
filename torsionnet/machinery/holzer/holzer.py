"""Holzer tables of modes and of trial frequencies, and natural frequencies counted from 1."""

from __future__ import annotations

import math
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from torsionnet.base.errors import TorsionnetError, UsageError, did_you_mean
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.modes.eigen import undamped_modes
from torsionnet.linear.modes.mode_pairs import VibrationMode, undamped_place, vibration_modes
from torsionnet.linear.modes.mode_shapes import Links
from torsionnet.linear.modes.modes import Modes
from torsionnet.linear.modes.natural_modes import modes
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
from torsionnet.machinery.holzer.mass_elastic_lines import hidden_nodes
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
    segments: bool = False,
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
    segments : bool
        Whether the nodes inside of shafts are stations too; else a shaft is one link, however finely it is divided.

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
        raise UsageError(
            "a Holzer table is of a mode (mode=1) or of a trial frequency (at=12.0 in Hz), one of the two",
            kind="contradicting-entries",
        )
    if not 0 < amplitude < math.inf:
        raise UsageError(f"the amplitude of the first station is above 0 rad, got {amplitude}", kind="out-of-range")
    for name in (first, referred_to):
        if name is not None and name not in drivetrain.nodes:
            raise UsageError(f'no node is named "{name}"{did_you_mean(name, drivetrain.nodes)}', kind="unknown-node")
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
    relative = {node: speed / own for node, speed in ratios.items() if speed}
    inside = hidden_nodes(drivetrain, tree, balance.inertias).names
    branches = tuple(_HolzerWalk(drivetrain, balance, tree, relative, omega, inside).branches(order))
    hertz = omega / (2 * math.pi)
    extra = [*_film_notes(drivetrain, omega, balance), *_housing_notes(balance)]
    notes = (*notes, *extra, *law_notes(drivetrain.definition), *range_notes(drivetrain.assembly, [hertz]))
    table = HolzerTable(hertz, mode, shaft, branches, drivetrain.title, notes, bool(rests), drivetrain.configuration)
    return table if segments else table.whole_shafts()


def _film_notes(drivetrain: AssembledModel, omega: float, balance: HolzerBalance) -> Iterator[str]:
    """Sentences on the rings of dampers that only a film drags along, at omega in rad/s.

    The ring follows a hub at rest, theta_r (c + j omega J) = c theta_h, so that J/(1 + (omega J/c)^2) of its inertia
    acts in phase with the hub; without damping it is 0.
    """
    held = {node for load in balance.loads for node in load.row}
    damping_laws = [law for law in drivetrain.assembly.laws if law.damping]
    for ring in (node for node in balance.angles if node not in held):
        laws = [law for law in damping_laws if ring in law.row]
        if len(laws) != 1 or len(laws[0].row) != 2:
            continue
        (law,) = laws
        hub = next(node for node in law.row if node != ring)
        inertia, damping = balance.inertias[ring], float(law.damping) * float(law.row[ring]) ** 2
        swinging = 1 / (1 + (omega * inertia / damping) ** 2)
        yield phrase(
            "{ring} hangs on {hub} by damping alone and does not count in this undamped table; with damping "
            "{percent:.3g} % of its inertia swing along",
            ring=ring, hub=hub, percent=100 * swinging,
        )  # fmt: skip


def _housing_notes(balance: HolzerBalance) -> Iterator[str]:
    """Sentences on gears whose twist is not that of two stations alone, as their housing turns with a third motion."""
    housed = [load for load in balance.loads if load.housing in load.row]
    for rigid, text in (
        (False, "the twist of {elements} counts the motion of the housing, and the angle of the next station does too"),
        (True, "behind the rigid mesh of {elements} the angle counts the motion of the housing"),
    ):
        names = dict.fromkeys(load.element for load in housed if load.rigid == rigid)
        if names:
            yield phrase(text, elements=", ".join(names))


def _trial_rate(at: float | None) -> float:
    if at is None or not 0 < at < math.inf:
        raise UsageError(f"a trial frequency is above 0 Hz, got {at}", kind="out-of-range")
    return 2 * math.pi * at


def _mode(drivetrain: AssembledModel, mode: int, start: str) -> tuple[float, FloatArray, tuple[str, ...]]:
    """Frequency in rad/s, angles (n_nodes,) and notes of an undamped mode, 1 at a first station that moves.

    Else it is 1 at the station that moves most.
    """
    assembly = drivetrain.assembly
    rates, shapes = undamped_modes(assembly.system)
    at, pair = undamped_place(drivetrain, mode)
    place = np.flatnonzero(rates)[at]
    shifted = "with damping its natural frequency is {frequency:.5g} Hz"
    notes = (phrase(shifted, frequency=pair.natural_frequency),) if pair.is_shifted else ()
    angles = np.asarray(assembly.node_rows.dense @ shapes[:, place])
    # Scaled to 1 where it moves most, so that the amplitude of the first station is judged against that.
    angles /= np.abs(angles).max()
    at_start = angles[assembly.node_index[start]]
    if abs(at_start) > LEAST_AMPLITUDE:
        return float(rates[place]), angles / at_start, notes
    still = "{node} stands still in this mode: the amplitude is that of the station that moves most"
    return float(rates[place]), angles, (phrase(still, node=start), *notes)


@dataclass
class _HolzerWalk:
    """Summation of torques in N m, station by station, along the lines of a Holzer table."""

    drivetrain: AssembledModel
    balance: HolzerBalance
    tree: Neighbours
    ratios: Mapping[str, float]
    omega: float
    inside: Container[str]
    """Names of the nodes inside of divided shafts."""
    branch_torques: dict[str, float] = field(default_factory=dict)
    """Torques in N m that branches bring to the node they join, by node."""

    def branches(self, order: Sequence[HolzerLine]) -> list[HolzerBranch]:
        """Branches of the Holzer table, with angles and torques by station, in the order of the lines.

        Each is summed before the line that it joins.
        """
        self._add_other_torques()
        branches = {line: self._branch(line) for line in reversed(order)}
        return [branches[line] for line in order]

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
            inertia, angle = self.balance.masses[node], self.balance.angles[node]
            inertia_torque = self.omega**2 * inertia * angle
            distributed = self.balance.distributed_torques[node]
            # T_i = T_(i-1) + omega^2 J_i theta_i + omega^2 sum(M_ij theta_j) of shafts + torques that join here.
            torque = carried + inertia_torque + distributed + joined
            link = self._link(node, after, torque) if after else None
            stations.append(
                HolzerStation(
                    node,
                    self.ratios.get(node, math.nan),
                    inertia,
                    angle,
                    inertia_torque,
                    joined,
                    torque,
                    link,
                    distributed,
                    node in self.inside,
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


# Natural frequencies of a drivetrain, counted from 1, with what swings against what and the nodes of vibration.

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
    strain, kinetic : str
        Elements with the largest shares of the strain and of the kinetic energy of the damped mode, as "shaft 96 %";
        empty where the mode exists without damping only.
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
    strain: Annotated[str, Out("strain energy")]
    kinetic: Annotated[str, Out("kinetic energy")]
    remark: Annotated[str, Out("remark")]

    @property
    def per_minute(self) -> Annotated[float, Out("undamped", "1/min", None, digits=5, after="undamped_frequency")]:
        """Undamped natural frequency of a mode in vibrations per minute."""
        return SECONDS_PER_MINUTE * self.undamped_frequency

    @property
    def node_places(self) -> Annotated[str, Out("nodes of vibration", json=None, after="n_nodes")]:
        """Text with the places of a mode's nodes of vibration, joined by commas."""
        return joined(", ", self.nodes)

    @property
    def lowest(self) -> float:
        """Lower one of a mode's natural frequencies in Hz without and with damping, or the only one it has."""
        both = (self.undamped_frequency, self.natural_frequency)
        return min(frequency for frequency in both if not math.isnan(frequency))


def natural_frequency_table(title: str, rows: tuple[CountedVibration, ...], notes: tuple[str, ...] = ()) -> Table:
    """Table of natural frequencies in Hz and per minute, with damping ratio in percent and number of nodes."""
    return result_table(title, rows, CountedVibration, notes=notes)


LEAST_SHARE_NAMED, MOST_MASSES_NAMED = 0.15, 2
"""Share of the kinetic energy from which on a mass is named beside the largest one of its sense of rotation, and most
masses named of one sense: more would not be read in a table."""
LEAST_ENERGY_NAMED, MOST_SHARES = 0.05, 3
"""Share of an energy from which on an element is named, and most elements named."""


def natural_frequencies(drivetrain: AssembledModel) -> tuple[CountedVibration, ...]:
    """Natural frequencies of all vibrations in Hz, by number of the mode, with nodes and what swings against what.

    The numbers are those of :meth:`torsionnet.Drivetrain.modes`, ``critical_speeds`` and ``holzer_table``: 1 is the
    lowest vibration with damping. Nodes are counted in the undamped shape, that of the Holzer table.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
    >>> (vibration,) = natural_frequencies(tn.Drivetrain("fan", elements))  # sqrt(1e4 (1/2 + 1)) rad/s
    >>> vibration.mode, round(vibration.undamped_frequency, 4), vibration.n_nodes, vibration.against
    (1, 19.4924, 1, 'b against a')
    """
    links = Links.of(drivetrain.assembly)
    senses = _senses(drivetrain)
    damped = modes(drivetrain)
    vibrations = sorted(vibration_modes(drivetrain, damped), key=lambda mode: mode.number)
    return tuple(_row(drivetrain, links, senses, mode, damped) for mode in vibrations)


def _row(
    drivetrain: AssembledModel, links: Links, senses: Mapping[str, float], mode: VibrationMode, damped: Modes
) -> CountedVibration:
    assembly = drivetrain.assembly
    places = [assembly.node_index[name] for name in assembly.kinematics.coordinates]
    (nodes,) = links.vibration_nodes(np.asarray(mode.shape[places], dtype=complex)[:, None])
    return CountedVibration(
        mode.number, mode.undamped_frequency, mode.natural_frequency, mode.damping_ratio,
        None if nodes is None else len(nodes), tuple(nodes or ()), _against(drivetrain, senses, mode),
        _shares_of(damped, damped.strain, mode), _shares_of(damped, damped.kinetic, mode), mode.remark,
    )  # fmt: skip


def _shares_of(damped: Modes, energy: FloatArray, mode: VibrationMode) -> str:
    """Text with the largest shares of the elements in an energy, (n_elements, n_modes), of the mode of this number."""
    if mode.number not in damped.numbers:
        return ""
    shares = dict(zip(damped.elements, energy[:, damped.numbers.index(mode.number)].tolist(), strict=True))
    largest = sorted(shares, key=lambda name: -shares[name])[:MOST_SHARES]
    return ", ".join(f"{name} {100 * shares[name]:.0f} %" for name in largest if shares[name] >= LEAST_ENERGY_NAMED)


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
    named = [text for text, _ in sides if text]
    return phrase("{first} against {second}", first=named[0], second=named[1]) if len(named) == 2 else "".join(named)


def _named(shares: Mapping[str, float]) -> tuple[str, float]:
    """Text with the masses of the largest shares of the kinetic energy, and the largest share."""
    largest = sorted(shares, key=lambda node: -shares[node])
    kept = [node for node in largest[:MOST_MASSES_NAMED] if node == largest[0] or shares[node] >= LEAST_SHARE_NAMED]
    return ", ".join(kept), shares[largest[0]] if largest else 0.0
