"""Holzer table, amplitudes and torques along a drivetrain at one frequency, station by station."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Schema
from torsionnet.base.packages import SavedResult
from torsionnet.base.phrases import phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table

AMPLITUDE = Value("amplitude of the first station", "angle", exclusive=True)
"""Specification of the amplitude in rad of the first station of a Holzer table, for options and arguments."""
FREQUENCY = Value("frequency of a trial", "frequency", exclusive=True)
"""Specification of the trial frequency in Hz of a Holzer table, for options and arguments."""
TRIAL_OR_MODE: Schema = {"type": ["integer", "null"], "description": "null for a trial frequency"}
"""JSON Schema of the number of the mode of a Holzer table, null for a trial frequency."""
MPA_PER_PA = 1e-6
"""Factor from stresses in Pa to MPa, as Holzer tables show them."""
NEGLIGIBLE_TORQUE = 1e-9
"""Ratio of a torque to the largest one of a Holzer table below which the table shows 0: it is what rounding leaves."""

DISTRIBUTED = "distributed"
"""Heading of the column with the torque of inertia that is no disc's, as that of shafts."""


@dataclass(frozen=True)
class HolzerLink:
    """Connection of a station of a Holzer table to the next, with stiffness (N m/rad), twist (rad) and stress (Pa).

    Attributes
    ----------
    elements : tuple of str
        Names of the elements between the two stations.
    stiffness : float
        Stiffness referred to the near station, N m/rad; infinite for a rigid connection.
    twist : float
        Twist referred to the near station, rad.
    stress : float
        Nominal shear stress in Pa of a shaft with a diameter; nan for others.
    ratio : float
        Angle of this station over that of the next one where nothing twists.
    """

    elements: tuple[str, ...]
    stiffness: float
    twist: float
    stress: float
    ratio: Annotated[float, Out(json=None)]

    @property
    def rigid(self) -> Annotated[bool, Out(json="rigid", after="elements")]:
        """Whether nothing between two stations of a Holzer table twists."""
        return math.isinf(self.stiffness)


@dataclass(frozen=True)
class HolzerStation:
    """Station of a Holzer table, a node with inertia, amplitude and torques of its own shaft, SI units, peak values.

    Attributes
    ----------
    node : str
    ratio : float
        Speed over that of the shaft that quantities are referred to; nan without a fixed ratio.
    inertia : float
        Inertia of the masses at the node in kg m^2, without that of shafts.
    amplitude : float
        Angle, rad.
    inertia_torque : float
        ``J omega^2 theta``, N m.
    joined : float
        Torque of branches that join here, and of what holds the node, N m.
    torque : float
        Sum of torques up to this station, N m: the torque of the link, or the remainder at the end of a branch.
    link : HolzerLink or None
        To the next station, for the last station of a branch to the one it joins.
    distributed : float
        Torque of the shafts' own inertia, ``omega^2 sum(M_ij theta_j)``, N m.
    inside : bool
        Whether it is a node inside a shaft that the model divides into segments.
    """

    node: str
    ratio: float
    inertia: float
    amplitude: float
    inertia_torque: float
    joined: float
    torque: float
    link: HolzerLink | None
    distributed: Annotated[float, Out(after="inertia_torque")] = 0.0
    inside: Annotated[bool, Out(json=None)] = False


@dataclass(frozen=True)
class HolzerBranch:
    """Branch of a Holzer table, stations from a free end to where it joins another branch, or to the last station.

    ``joins`` is the node it joins, None for a main line.
    """

    joins: str | None
    stations: tuple[HolzerStation, ...]

    @property
    def title(self) -> str:
        """Heading of a branch of a Holzer table, such as 'pump to gearbox, which it joins'."""
        first, last = self.stations[0].node, self.joins or self.stations[-1].node
        ends = phrase("{first} to {last}", first=first, last=last)
        return phrase("{line}, which it joins", line=ends) if self.joins else ends


@dataclass(frozen=True, eq=False, repr=False)
class HolzerTable(SavedResult):
    """Holzer table of a drivetrain at one frequency in Hz, a list of branches, those that join no other branch first.

    Attributes
    ----------
    frequency : float
        Hz.
    mode : int or None
        Number of the mode, 1 for the lowest vibration; None for a trial frequency.
    referred_to : str
        Node of the shaft that referred quantities belong to.
    branches : tuple of HolzerBranch
    title : str
    notes : tuple of str
    first_rests : bool
        Whether the first station stands still, so that the amplitude is that of the station that moves most.
    configuration : str

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
    >>> holzer = tn.Drivetrain("fan", elements).holzer_table(1)
    >>> [(mass.node, round(mass.amplitude, 6), round(mass.torque, 3) + 0.0) for mass in holzer.branches[0].stations]
    [('a', 1.0, 30000.0), ('b', -2.0, 0.0)]
    """

    SHOWN: ClassVar = (
        "title", "configuration", "mode", "frequency", "referred_to", "remainder", "relative_remainder", "notes",
        "branches",
    )  # fmt: skip

    frequency: Annotated[float, Out(json="frequency_Hz")]
    mode: Annotated[int | None, Out(schema=TRIAL_OR_MODE)]
    referred_to: str
    branches: tuple[HolzerBranch, ...]
    title: str = ""
    notes: tuple[str, ...] = ()
    first_rests: bool = False
    configuration: str = ""

    @property
    def remainder(self) -> Annotated[float, Out(json="remainder_Nm")]:
        """Torque in N m left over at the last station of the first branch of a Holzer table.

        0 at a natural frequency.
        """
        return self.branches[0].stations[-1].torque

    @property
    def relative_remainder(self) -> float:
        """Ratio of the largest torque left over at the end of a line to the largest between stations, without unit.

        At a natural frequency it is only rounding.
        """
        # A branch hands its torque on to the line that it joins; only main lines end with a remainder.
        lines = [abs(branch.stations[-1].torque) for branch in self.branches if not branch.joins]
        return max(lines) / (self._largest or 1.0)

    @property
    def _largest(self) -> float:
        """Largest torque in N m in any connection between two stations of a Holzer table."""
        return max((abs(station.torque) for station in self._stations() if station.link is not None), default=0.0)

    def station(self, node: str) -> HolzerStation:
        """Station of a Holzer table by the name of its node."""
        return next(station for station in self._stations() if station.node == node)

    def whole_shafts(self) -> HolzerTable:
        """Copy of a Holzer table in which every divided shaft is one link, with the stiffness of all its segments.

        With 1/k = sum 1/k_s, twists add to (T + sum_i (1 - x_i) tau_i)/k, T being the torque that enters the shaft and
        tau_i that of its own inertia at an inner node, which lies at the share x_i of the shaft's flexibility. So
        (1 - x_i) tau_i counts at the near end and x_i tau_i at the far one, and every row still closes.
        """
        if not any(station.inside for station in self._stations()):
            return self
        # A branch hands its torque to the line that it joins, which therefore comes after it.
        moved: dict[str, tuple[float, float]] = {}
        branches = [_with_whole_shafts(branch, moved) for branch in reversed(self.branches)]
        return replace(self, branches=tuple(reversed(branches)))

    def tables(self, *, referred: bool = False) -> tuple[Table, ...]:
        """Tables of the branches of a Holzer table, each with a row per station.

        With ``referred`` all quantities are of one shaft.
        """
        return tuple(self._table(number, branch, referred=referred) for number, branch in enumerate(self.branches, 1))

    def table(self, *, referred: bool = False) -> Table:
        """Table with a row for each station of a Holzer table, with the number of its branch in the first column."""
        tables = self.tables(referred=referred)
        rows = tuple((number, *row) for number, table in enumerate(tables, 1) for row in table.rows)
        return Table(self.heading, (Column("branch"), *tables[0].columns), rows, self._notes())

    @property
    def heading(self) -> str:
        """Heading of a Holzer table with model, mode or trial, and frequency in Hz and per minute."""
        what = f"mode {self.mode}, " if self.mode else "trial at "
        return f"{self.title}: {what}{self.frequency:.6g} Hz, {self.frequency * 60:.6g} per minute"

    @property
    def has_distributed(self) -> bool:
        """Whether inertia other than that of discs, as that of shafts, acts in a Holzer table."""
        return any(station.distributed for station in self._stations())

    def _stations(self) -> Iterator[HolzerStation]:
        for branch in self.branches:
            yield from branch.stations

    def _table(self, number: int, branch: HolzerBranch, *, referred: bool) -> Table:
        columns = (
            Column("station"),
            Column("J", "kg*m^2", 5),
            Column("J referred", "kg*m^2", 5),
            Column("theta", "rad", 5),
            Column("J w^2 theta", "N*m", 5),
            Column(DISTRIBUTED, "N*m", 5),
            Column("joined", "N*m", 5),
            Column("sum of torque", "N*m", 5),
            Column("k", "N*m/rad", 5),
            Column("k referred", "N*m/rad", 5),
            Column("twist", "rad", 5),
            Column("stress", "MPa", 5),
            Column("to the next by"),
        )
        rows = tuple(_row(station, NEGLIGIBLE_TORQUE * self._largest, referred=referred) for station in branch.stations)
        name = f"branch {number}, " if len(self.branches) > 1 else ""
        last = number == len(self.branches)
        heading = f"{self.heading}\n" if number == 1 else ""
        table = Table(f"{heading}{name}{branch.title}", columns, rows, self._notes() if last else ())
        if self.has_distributed:
            return table
        return table.chosen([place for place, column in enumerate(columns) if column.name != DISTRIBUTED])

    def _notes(self) -> tuple[str, ...]:
        at = self.branches[0].stations[-1].node
        remainder = f"{self.remainder:.5g} N*m remain at {at}, {self.relative_remainder:.2g} of the largest torque"
        if self.relative_remainder < NEGLIGIBLE_TORQUE:
            remainder = f"nothing but rounding remains at {at}"
        return (f"{remainder}; referred to {self.referred_to}", *self.notes)


def _with_whole_shafts(branch: HolzerBranch, moved: dict[str, tuple[float, float]]) -> HolzerBranch:
    """Branch with whole shafts; ``moved`` has what joined and distributed torques of a junction change by, N m.

    A far end that lies on another line is written into ``moved``.
    """
    stations: list[HolzerStation] = []
    carried, far = 0.0, 0.0
    for group in _shaft_groups(branch.stations):
        near, links = group[0], [station.link for station in group if station.link is not None]
        joined, distributed = moved.get(near.node, (0.0, 0.0))
        near = replace(near, joined=near.joined + joined, distributed=near.distributed + distributed + far)
        shares = _far_shares(links)
        inner = [station.inertia_torque + station.distributed + station.joined for station in group[1:]]
        far = sum(share * torque for share, torque in zip(shares, inner, strict=False))
        near = replace(near, distributed=near.distributed + sum(inner) - far)
        torque = carried + near.inertia_torque + near.distributed + near.joined
        stations.append(replace(near, torque=torque, link=_joined_links(links)))
        carried = torque * links[-1].ratio if links else 0.0
    if branch.joins:
        last = branch.stations[-1]
        before = last.torque * last.link.ratio if last.link else 0.0
        joined, distributed = moved.get(branch.joins, (0.0, 0.0))
        moved[branch.joins] = joined + carried - before, distributed + far
    return replace(branch, stations=tuple(stations))


def _shaft_groups(stations: tuple[HolzerStation, ...]) -> Iterator[list[HolzerStation]]:
    """Yield each station with those behind it that lie inside the shaft which leads on from it."""
    group: list[HolzerStation] = []
    for station in stations:
        if group and not station.inside:
            yield group
            group = []
        group.append(station)
    if group:
        yield group


def _far_shares(links: list[HolzerLink]) -> list[float]:
    """Share of a shaft's flexibility that lies before each of its inner nodes."""
    flexibility = [1 / link.stiffness for link in links]
    return [before / sum(flexibility) for before in itertools.accumulate(flexibility[:-1])]


def _joined_links(links: list[HolzerLink]) -> HolzerLink | None:
    """Link of several in series; its stress is the largest of theirs."""
    if len(links) < 2:
        return links[0] if links else None
    names = tuple(dict.fromkeys(name for link in links for name in link.elements))
    twist, stress = sum(link.twist for link in links), max(link.stress for link in links)
    return HolzerLink(names, 1 / sum(1 / link.stiffness for link in links), twist, stress, links[-1].ratio)


def _row(mass: HolzerStation, rounding: float, *, referred: bool) -> tuple[object, ...]:
    # Referred to the shaft of speed 1: J n^2, k n^2, T n and theta/n, so that T theta stays.
    angle, torque = (1 / mass.ratio, mass.ratio) if referred else (1.0, 1.0)
    link = mass.link
    own = [mass.node, mass.inertia, mass.inertia * mass.ratio**2, mass.amplitude * angle, mass.inertia_torque * torque]
    own += [part * torque if part else None for part in (mass.distributed, mass.joined)]
    own.append(mass.torque * torque if abs(mass.torque) > rounding else 0.0)
    if link is None:
        return (*own, None, None, None, None, "")
    stiff = not math.isinf(link.stiffness)
    stiffness = (link.stiffness, link.stiffness * mass.ratio**2) if stiff else (None, None)
    names = ", ".join(link.elements) if stiff else f"{', '.join(link.elements)} (rigid)"
    return (*own, *stiffness, link.twist * angle if stiff else None, link.stress * MPA_PER_PA, names)


# Nodes of vibration of a mode, the places at rest between masses that swing against each other.

STANDING_SHARE = 1e-6
"""Ratio of a mass's amplitude to that of its neighbour up to which the mass itself counts as the node: what rounding
leaves of a mode that is symmetric about a mass."""

ROUNDED_SHARE = 1e-10
"""Ratio of a mass's amplitude to the largest one of the mode below which it is rounding and has no sign."""


@dataclass(frozen=True)
class VibrationNode:
    """Place at rest in a mode, as a share of the compliance between two masses, with the names of both masses.

    Attributes
    ----------
    first, second : str
        Masses on both sides; the same for a mass at rest.
    elements : tuple of str
        Elements between these masses; empty for a mass at rest.
    position : float
        Share of the twist between them that lies before the node, seen from ``first``: of a uniform shaft the share of
        its length.
    """

    first: Annotated[str, Out("from")]
    second: Annotated[str, Out("to")]
    elements: tuple[str, ...]
    position: Annotated[float, Out("node at", "%", digits=3, factor=100)]


def vibration_nodes(holzer: HolzerTable) -> tuple[VibrationNode, ...]:
    """Nodes of vibration along the lines of a Holzer table, each with its place between two masses.

    Along a spring between two masses the angle is linear in the compliance, so that the node lies at
    ``theta_1 / (theta_1 - theta_2)`` of the compliance, both angles referred to one shaft.

    Parameters
    ----------
    holzer : HolzerTable
        Of a mode. Connections that a Holzer table does not follow, as planetary sets, have no node here.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4)]
    >>> [(node.first, node.second, round(node.position, 6))
    ...     for node in vibration_nodes(tn.Drivetrain("fan", elements).holzer_table(1))]
    [('a', 'b', 0.333333)]
    """
    nodes = []
    rounding = ROUNDED_SHARE * max(abs(station.amplitude) for branch in holzer.branches for station in branch.stations)
    rests: dict[str, set[int]] = {}
    for here, after in _links(holzer):
        assert here.link is not None
        # Both angles on the shaft of the first mass: theta_2 times the ratio of the link.
        near, far = (
            angle if abs(angle) > rounding else 0.0 for angle in (here.amplitude, after.amplitude * here.link.ratio)
        )
        limit = STANDING_SHARE * max(abs(near), abs(far))
        if here.link.rigid or not limit:
            continue
        # The angle runs straight over the compliance: it is 0 at near/(near - far) of it.
        if near * far < 0 and min(abs(near), abs(far)) > limit:
            nodes.append(VibrationNode(here.node, after.node, here.link.elements, near / (near - far)))
        # The sense of a neighbour is seen on the shaft of the mass at rest.
        for node, own, other in ((here.node, near, far), (after.node, far, near)):
            if abs(own) <= limit:
                forwards = other > 0 if node == here.node else other * here.link.ratio > 0
                rests.setdefault(node, set()).add(1 if forwards else -1)
    still = (VibrationNode(node, node, (), 0.0) for node, senses in rests.items() if len(senses) > 1)
    return (*nodes, *still)


def _links(holzer: HolzerTable) -> Iterator[tuple[HolzerStation, HolzerStation]]:
    """Yield pairs of neighbouring stations of a Holzer table, in a branch up to the station that it joins."""
    for branch in holzer.branches:
        stations = list(branch.stations)
        if branch.joins:
            stations.append(holzer.station(branch.joins))
        for here, after in itertools.pairwise(stations):
            if here.link is not None:
                yield here, after
