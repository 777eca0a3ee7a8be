"""Mass-elastic table of a drivetrain, inertias of masses with stiffness, damping and section of shafts between them.

Masses and the shafts between them, as they are and referred to one shaft.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from torsionnet.base.packages import SavedResult
from torsionnet.base.phrases import joined, phrase
from torsionnet.base.table import Column, Table

SAME_SPEED_SHARE = 1e-9
"""Relative difference of two speed ratios up to which they count as equal, as rounding of ratios is smaller."""
MM_PER_M, CM3_PER_M3 = 1e3, 1e6
"""Factors from m to mm and from m^3 to cm^3, in which diameters and section moduli are given."""
LEAST_SHARE = 1e-9
"""Share of an inertia below which that of shafts is what rounding leaves."""


@dataclass(frozen=True)
class StationSection:
    """Outer and inner diameter in m of a round shaft, and its polar section modulus in m^3."""

    outer: float
    inner: float
    modulus: float


@dataclass(frozen=True)
class MassElasticShaft:
    """Stiffness, damping and section (SI) of the connection of a mass to the next, referred to the first one's shaft.

    Attributes
    ----------
    elements : tuple of str
        Names of the elements between the two masses.
    to : str
        Node of the next mass.
    stiffness : float
        N m/rad; infinite for a rigid connection, 0 for a damper alone.
    damping : float
        Relative damping, viscous, N m s/rad.
    loss_factor : float
        Relative damping, of a hysteretic spring; 0 without.
    section : StationSection, optional
    length : float, optional
        Of the whole shaft, m.
    segments : int
        Number of equal parts into which the model divides the shaft; stiffness and damping are those of the whole.
    material : str
        Kind and tensile strength as a limit on the shaft gives them, else empty.
    """

    elements: tuple[str, ...]
    to: str
    stiffness: float
    damping: float = 0.0
    loss_factor: float = 0.0
    section: StationSection | None = None
    length: float | None = None
    segments: int = 1
    material: str = ""

    @property
    def is_elastic(self) -> bool:
        """Whether the connection of two masses twists under a constant torque, neither rigid nor a damper alone."""
        return 0 < self.stiffness < math.inf


@dataclass(frozen=True)
class MassElasticRow:
    """Mass of a mass-elastic table with the shaft to the next one, values in SI at the mass's own speed.

    Attributes
    ----------
    number : int
        Counted through all lines, from 1.
    node : str
    inertia : float
        kg m^2, with half of that of adjacent shafts.
    damping : float
        Absolute damping, against the ground, N m s/rad.
    ratio : float
        Speed over that of the shaft that values are referred to; nan without a fixed ratio.
    shaft : MassElasticShaft, optional
        To the next mass, in the last row of a branch to the one that the branch joins.
    shaft_inertia : float
        What adjacent shafts have of the inertia, kg m^2.
    """

    number: int
    node: str
    inertia: float
    damping: float
    ratio: float
    shaft: MassElasticShaft | None = None
    shaft_inertia: float = 0.0

    @property
    def referred_inertia(self) -> float:
        """Inertia J n^2 of a mass in kg m^2, referred to the reference shaft by its speed ratio n."""
        return self.inertia * self.ratio**2

    @property
    def referred_stiffness(self) -> float:
        """Stiffness k n^2 in N m/rad of the shaft to the next mass, referred to the reference shaft.

        It is nan without a shaft.
        """
        return math.nan if self.shaft is None else self.shaft.stiffness * self.ratio**2


@dataclass(frozen=True)
class MassElasticLine:
    """Masses in line from a free end to the last mass or, in a branch, to the mass of another line that it joins."""

    joins: str | None
    rows: tuple[MassElasticRow, ...]

    @property
    def title(self) -> str:
        """Heading of a line of masses, such as 'pump to gearbox, which it joins'."""
        first, last = self.rows[0].node, self.joins or self.rows[-1].node
        ends = first if first == last else phrase("{first} to {last}", first=first, last=last)
        return phrase("{line}, which it joins", line=ends) if self.joins else ends

    @property
    def flexibility(self) -> float:
        """Sum of the flexibilities of a line's shafts in rad/(N m), each referred to the reference shaft."""
        return sum(1 / row.referred_stiffness for row in self.rows if row.shaft is not None and row.shaft.is_elastic)


@dataclass(frozen=True, eq=False, repr=False)
class MassElasticTable(SavedResult):
    """Mass-elastic table of a drivetrain in SI units, its lines of masses with the shafts between them.

    Main lines come first.

    Attributes
    ----------
    referred_to : str
        Node of the shaft that referred values belong to.
    lines : tuple of MassElasticLine
    title : str
    notes : tuple of str
        Connections that are in no row: springs to the ground, sets of three shafts, closed loops.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="c", inertia=8),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4), tn.Gear("gear", nodes=("b", "c"), ratio=2)]
    >>> sheet = tn.Drivetrain("fan", elements).mass_elastic_table(referred_to="a")
    >>> [(mass.number, mass.node, mass.referred_inertia) for mass in sheet.rows]
    [(1, 'a', 2.0), (2, 'b', 0.0), (3, 'c', 2.0)]
    >>> sheet.total_inertia, sheet.lines[0].flexibility
    (4.0, 0.0001)
    """

    referred_to: str
    lines: tuple[MassElasticLine, ...]
    title: str = ""
    notes: tuple[str, ...] = ()

    @property
    def rows(self) -> tuple[MassElasticRow, ...]:
        """Masses of all lines of a mass-elastic table, in the order of their numbers."""
        return tuple(row for line in self.lines for row in line.rows)

    @property
    def has_one_speed(self) -> bool:
        """Whether all masses turn at the speed of the reference shaft, so that referred values are the given ones."""
        return all(abs(abs(row.ratio) - 1) <= SAME_SPEED_SHARE for row in self.rows)

    @property
    def total_inertia(self) -> float:
        """Sum of all inertias in kg m^2, referred to the reference shaft; masses without a fixed ratio do not count."""
        return sum(row.referred_inertia for row in self.rows if not math.isnan(row.ratio))

    def table(self) -> Table:
        """Table with a row per mass and its shaft to the next, in units of machine drawings, with sums as notes."""
        columns = (
            Column("no."),
            Column("mass"),
            Column("J", "kg*m^2", 4),
            Column("absolute damping", "N*m*s/rad", 4),
            Column("speed ratio", digits=5),
            Column("J referred", "kg*m^2", 4),
            Column("shaft to the next"),
            Column("k", "N*m/rad", 4),
            Column("k referred", "N*m/rad", 4),
            Column("outer diameter", "mm", 4),
            Column("inner diameter", "mm", 4),
            Column("length", "m", 4),
            Column("section modulus", "cm^3", 4),
            Column("relative damping", "N*m*s/rad", 4),
            Column("loss factor", digits=3),
            Column("material"),
        )
        return Table(f"{self.title}: mass-elastic table", columns, tuple(map(_cells, self.rows)), tuple(self._notes()))

    def _notes(self) -> Iterator[str]:
        total = f"sum of J {self.total_inertia:.5g} kg*m^2"
        yield f"referred to {self.referred_to}: J n^2, k n^2, n the speed ratio; {total}"
        for line in self.lines:
            if line.flexibility:
                where = f", {line.title}" if len(self.lines) > 1 else ""
                yield f"sum of 1/k referred to {self.referred_to}{where}: {line.flexibility:.5g} rad/(N*m)"
        yield from self.shares_of_shafts()
        yield from self.divided()
        yield from self.notes

    def shares_of_shafts(self) -> Iterator[str]:
        """Yield the sentence that says how much of each inertia is that of adjacent shafts, if any is.

        A Holzer table has the masses alone.
        """
        shares = [(row.node, row.shaft_inertia) for row in self.rows if row.shaft_inertia > LEAST_SHARE * row.inertia]
        if shares:
            each = ", ".join(f"{node} {size:.5g}" for node, size in shares)
            yield phrase("of J, half of each adjacent shaft: {masses}", masses=each)

    def divided(self) -> Iterator[str]:
        """Yield the sentence that says into how many segments the model divides which shafts, if it does."""
        shafts = [row.shaft for row in self.rows if row.shaft is not None and row.shaft.segments > 1]
        if shafts:
            template = "{shaft} divided into {count}"
            each = joined(", ", (phrase(template, shaft=shaft.elements[0], count=shaft.segments) for shaft in shafts))
            yield phrase("whole shafts, each end with half of its inertia; in the calculation {shafts}", shafts=each)


def _cells(row: MassElasticRow) -> tuple[object, ...]:
    known = not math.isnan(row.ratio)
    referred = (row.ratio, row.referred_inertia) if known else (None, None)
    own = (row.number, row.node, row.inertia, row.damping or None, *referred)
    shaft = row.shaft
    if shaft is None:
        return (*own, "", *[None] * 8, "")
    name = ", ".join(shaft.elements) + (" (rigid)" if math.isinf(shaft.stiffness) else "")
    elastic = (shaft.stiffness, row.referred_stiffness if known else None) if shaft.is_elastic else (None, None)
    outer, inner, modulus = None, None, None
    if (section := shaft.section) is not None:
        outer, inner = section.outer * MM_PER_M, section.inner * MM_PER_M or None
        modulus = section.modulus * CM3_PER_M3
    losses = (shaft.damping or None, shaft.loss_factor or None)
    return (*own, name, *elastic, outer, inner, shaft.length, modulus, *losses, shaft.material)
