"""Derivatives of readings to parameters, from motions under loads and under the readings taken for loads.

A reading y = c . [theta, lambda] under a load has the derivative dc . [theta, lambda] - z . dK [theta, lambda], where K
is the matrix of :mod:`torsionnet.linear.sensitivity.augmented` and K z = c: the motion under the reading taken for a
load. A torque that is read opens a gap by one in it. Of a law with the twist gamma under the load and zeta under the
reading there remains

    dy = -(dkappa gamma zeta + kappa (dgamma zeta + gamma dzeta))

with dgamma, dzeta for the change of its row. What an element adds to its own torque is in zeta, so that nothing cancels
between the two parts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np

from torsionnet.base.expressions import exact
from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.response_problem import Loading, ResponseProblem
from torsionnet.linear.dynamic_stiffness.row_algebra import Row
from torsionnet.linear.sensitivity.augmented import Augmented
from torsionnet.linear.sensitivity.unknowns import DUALS, gradient_of, value_of
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.elements import Element, Values
from torsionnet.model.elimination import reduce_rows
from torsionnet.model.kinematics import UNIT, exact_row
from torsionnet.model.readings import Reading, reading

# Derivatives of the coefficients of sensor readings with respect to parameters.


@dataclass(frozen=True, eq=False)
class ReadingDerivative:
    """Derivatives of the coefficients of a reading by node, law and condition, with respect to parameters.

    They are those of m, f and g in y = s^power (m . theta) + sum_i f_i kappa_i (a_i . theta) + sum_j g_j lambda_j.

    Arrays over nodes, laws and conditions, each with a last axis of parameters.
    """

    motion: FloatArray
    laws: FloatArray
    conditions: FloatArray

    @classmethod
    def nothing(cls, system: Augmented) -> ReadingDerivative:
        """Derivatives of a reading that does not depend on parameters, which are all zero."""
        (_, n_nodes, count), n_conditions = system.law_slopes.shape, len(system.condition_owners)
        return cls(np.zeros((n_nodes, count)), np.zeros(system.inertia.slopes.shape), np.zeros((n_conditions, count)))


def reading_on_duals(
    sensor: Sensor, elements: Mapping[str, Element], system: Augmented, values: Mapping[str, Any]
) -> Reading:
    """Reading of a sensor, known to be present, with coefficients that carry their derivatives."""
    laws = zip(system.law_owners, system.law_rows, strict=True)
    conditions = zip(system.condition_owners, system.condition_rows, strict=True)
    return reading(sensor, elements, Values(values, DUALS), laws, conditions)


def derivative_of(read: Reading, system: Augmented, nodes: Sequence[str]) -> ReadingDerivative:
    """Derivatives of a reading's coefficients by node, law and condition to parameters, from dual numbers."""
    new, count = ReadingDerivative.nothing(system), system.inertia.slopes.shape[1]
    places = {node: place for place, node in enumerate(nodes)}
    motion = {places[node]: number for node, number in (read.row or {}).items() if node in places}
    for numbers, slopes in ((motion, new.motion), (read.laws, new.laws), (read.constraints, new.conditions)):
        for place, number in numbers.items():
            slopes[place] = gradient_of(number, count)
    return new


ExactRow = Mapping[str, Fraction]


@dataclass(frozen=True)
class GapDerivative:
    """Virtual motion that opens a rigid connection whose torque is read, and the share of the element's own laws."""

    motion: ExactRow
    own: Mapping[int, Fraction] = field(default_factory=dict)


@dataclass(frozen=True)
class SolvedReadings:
    """Reading in a derivative problem, as row of motion or gap of its torque, derivatives, and number as a load."""

    power: int
    row: ExactRow | None
    gap: int
    slopes: ReadingDerivative
    load: int


class DerivativeProblem:
    """Response problem whose solution gives readings and their derivatives to parameters, for one set of rows.

    Parameters
    ----------
    system : Augmented
    sensors : sequence of Sensor
    elements : mapping
    values : mapping
        Of all parameters, as duals.
    loads : sequence of Input
    names : mapping
        Input -> name.
    nodes : sequence of str
    probes : sequence of str, optional
        Nodes that are loaded and read too, after the others of both.
    """

    def __init__(
        self,
        system: Augmented,
        sensors: Sequence[Sensor],
        elements: Mapping[str, Element],
        values: Mapping[str, Any],
        loads: Sequence[Input],
        names: Mapping[Input, str],
        nodes: Sequence[str],
        probes: Sequence[str] = (),
    ) -> None:
        self.system: Augmented = system
        self.nodes: Sequence[str] = nodes
        self.n_loads: int = len(loads) + len(probes)
        self.followed: range | tuple[int, ...] = range(len(system.law_owners)) if probes else system.varied
        self.driven: list[str] = [name for name in system.condition_owners if name.startswith("input:")]
        order = {node: index for index, node in enumerate(nodes)}
        # theta = T q + S x, equation (2.1), with imposed angles x kept.
        self.reduction = reduce_rows(system.exact_conditions, order, set(self.driven))
        free = [node for node in nodes if self.reduction.is_free(node)]
        self.columns: dict[str, int] = {name: column for column, name in enumerate((*free, *self.driven))}
        self.n_free: int = len(free)
        self.gaps: list[GapDerivative] = []
        # A constraint whose coefficients follow a parameter does work with its torque: that is solved for, too.
        self.multipliers: dict[int, int] = {
            condition: self._gap(GapDerivative(self._opened(condition)))
            for condition in np.flatnonzero(system.condition_slopes.any(axis=(1, 2))).tolist()
        }
        self.readings: list[SolvedReadings] = [
            self._asked(sensor, elements, values, number) for number, sensor in enumerate(sensors, self.n_loads)
        ]
        still = ReadingDerivative.nothing(system)
        self.readings += [
            SolvedReadings(0, {node: Fraction(1)}, -1, still, number) for number, node in enumerate(probes, len(loads))
        ]
        self._set_up([self._load(load, names) for load in (*loads, *(Input("torque", node) for node in probes))])

    # --- rows -------------------------------------------------------------------------------------------------------

    def _gap(self, gap: GapDerivative) -> int:
        self.gaps.append(gap)
        return len(self.gaps) - 1

    def _opened(self, condition: int) -> ExactRow:
        """Motion in rad by node that violates one rigid condition by one and no other. Driven nodes stand still."""
        rows = [dict(row) for row in self.system.exact_conditions]
        # Imposed angles stand still.
        for name in self.driven:
            for row in rows:
                row.pop(name, None)
        # The condition a . theta = 1 in place of a . theta = 0.
        last = {**rows.pop(condition), UNIT: Fraction(-1)}
        order = {node: index for index, node in enumerate(self.nodes)}
        reduction = reduce_rows([*rows, last], order, {UNIT})
        return {node: row[UNIT] for node, row in reduction.solved.items() if UNIT in row}

    def _asked(
        self, sensor: Sensor, elements: Mapping[str, Element], values: Mapping[str, Any], load: int
    ) -> SolvedReadings:
        read = reading_on_duals(sensor, elements, self.system, values)
        slopes = derivative_of(read, self.system, self.nodes)
        if read.row is not None:
            row = {node: exact(value_of(a)) for node, a in read.row.items()}
            return SolvedReadings(read.power, row, -1, slopes, load)
        motion: dict[str, Fraction] = {}
        for condition, factor in read.constraints.items():
            for moved, angle in self._opened(condition).items():
                motion[moved] = motion.get(moved, Fraction(0)) + exact(value_of(factor)) * angle
        own = {law: exact(value_of(factor)) for law, factor in read.laws.items()}
        return SolvedReadings(0, None, self._gap(GapDerivative(motion, own)), slopes, load)

    def _row_without_own(self, row: ExactRow, own: Mapping[int, Fraction] | None = None) -> Row:
        """Coefficients by column of the problem of a row over nodes, less ``own`` in the columns of gaps."""
        by_column = {self.columns[name]: float(a) for name, a in self.reduction.reduced(row).items()}
        for number, gap in enumerate(self.gaps):
            opened = sum((a * gap.motion[node] for node, a in row.items() if node in gap.motion), start=Fraction(0))
            opened -= (own or {}).get(number, Fraction(0))
            if opened:
                by_column[len(self.columns) + number] = float(opened)
        return by_column

    def _law_row(self, law: int) -> Row:
        own = {number: gap.own[law] for number, gap in enumerate(self.gaps) if law in gap.own}
        return self._row_without_own(self.system.exact_laws[law], own)

    def _slope_row(self, slopes: FloatArray, law: int = -1, p: int = -1) -> Row:
        """Row over columns of the derivative (n_nodes,) of a law's or condition's row to one parameter.

        For a law it holds the share in its own torque too.
        """
        own = {out.gap: exact(float(out.slopes.laws[law, p])) for out in self.readings if law >= 0 and out.gap >= 0}
        return self._row_without_own(
            {self.nodes[i]: exact(float(slopes[i])) for i in np.flatnonzero(slopes).tolist()}, own
        )

    # --- the problem ------------------------------------------------------------------------------------------------

    def _set_up(self, loads: Sequence[Loading]) -> None:
        """Set up the response problem, and note the numbers of twists, derivatives and motions among its outputs."""
        system, outputs = self.system, _Outputs()
        count = system.inertia.slopes.shape[1]
        laws = [self._law_row(law) for law in range(len(system.law_owners))]
        self.twists: dict[int, int] = {law: outputs.add(laws[law]) for law in self.followed}
        self.law_slopes: dict[tuple[int, int], int] = {
            (law, int(p)): outputs.add(self._slope_row(system.law_slopes[law][:, p], law, int(p)))
            for law in system.varied
            for p in np.flatnonzero(system.law_slopes[law].any(axis=0))
        }
        self.condition_slopes: dict[tuple[int, int], int] = {
            (condition, int(p)): outputs.add(self._slope_row(system.condition_slopes[condition][:, p]))
            for condition in self.multipliers
            for p in np.flatnonzero(system.condition_slopes[condition].any(axis=0))
        }
        self.motions = [
            None if output.row is None else outputs.add(self._row_without_own(output.row)) for output in self.readings
        ]
        self.motion_slopes: dict[tuple[int, int], int] = {
            (number, int(p)): outputs.add(self._slope_row(output.slopes.motion[:, p]))
            for number, output in enumerate(self.readings)
            for p in range(count)
            if output.slopes.motion[:, p].any()
        }
        self.first_gap: int = len(outputs.rows)
        # The loads first, then every reading taken for a load, K z = c: that of a torque opens its gap by one.
        excitations = [
            *loads,
            *(
                Loading(motion={len(self.columns) + output.gap: 1.0})
                if output.row is None
                else Loading(load=self._row_without_own(output.row))
                for output in self.readings
                if output.load >= self.n_loads
            ),
        ]
        gaps = tuple(len(self.columns) + number for number in range(len(self.gaps)))
        self.problem = ResponseProblem(laws, self.n_free, tuple(excitations), tuple(outputs.rows), gaps)

    def _load(self, load: Input, names: Mapping[Input, str]) -> Loading:
        if load.quantity == "torque":
            return Loading(load=self._row_without_own(exact_row(load.row)))
        return Loading(motion={self.columns[f"input:{names[load]}"]: 1.0})

    # --- what its solution says -------------------------------------------------------------------------------------

    def values(self, solved: ComplexArray, s: ComplexArray) -> ComplexArray:
        """Readings (n_f, n_readings, n_loads) in SI units per unit load, from the solution of the problem."""
        readings = np.empty((len(s), len(self.readings), self.n_loads), dtype=complex)
        for number, output in enumerate(self.readings):
            motion = self.motions[number]
            place = self.first_gap + output.gap if motion is None else motion
            readings[:, number] = (s**output.power * solved[place, : self.n_loads]).T
        return readings

    def slopes(
        self, solved: ComplexArray, system: Augmented, kappa: ComplexArray, s: ComplexArray, at: FloatArray
    ) -> ComplexArray:
        """Derivatives of readings (n_f, n_readings, n_loads, n_p) per SI unit of each parameter.

        The other arguments are those of ``Augmented.kappa``.
        """
        count = system.inertia.slopes.shape[1]
        stiffness = {law: list(system.kappa_slopes(law, s, at)) for law in system.varied}
        derivatives = np.zeros((len(s), len(self.readings), self.n_loads, count), dtype=complex)
        for number, output in enumerate(self.readings):
            for load in range(self.n_loads):
                x, z = solved[:, load], solved[:, output.load]
                # -z^T dK x; below, what the change of the reading's own coefficients adds.
                derivatives[:, number, load] = -self._equation_slopes(stiffness, kappa, x, z, count)
                for p in range(count):
                    if (number, p) in self.motion_slopes:
                        derivatives[:, number, load, p] += x[self.motion_slopes[number, p]]
                    for condition, gap in self.multipliers.items():
                        slope = output.slopes.conditions[condition, p]
                        derivatives[:, number, load, p] += slope * x[self.first_gap + gap]
            # Rates and accelerations are s and s^2 times angles.
            derivatives[:, number] *= (s**output.power)[:, None, None]
        return derivatives

    def slopes_along(self, solved: ComplexArray, rates: ComplexArray, s: ComplexArray) -> ComplexArray:
        """Derivatives of readings (n_f, n_readings, n_loads) along ``rates`` (n_laws, n_f) of the stiffnesses."""
        twists = solved[[self.twists[law] for law in range(len(rates))]]
        adjoint, motion = twists[:, [output.load for output in self.readings]], twists[:, : self.n_loads]
        powers = np.array([s**output.power for output in self.readings])
        return np.asarray(-np.einsum("lf,lzf,lxf,zf->fzx", rates, adjoint, motion, powers, optimize=True))

    def _equation_slopes(
        self,
        stiffness: Mapping[int, Sequence[tuple[int, ComplexArray]]],
        kappa: ComplexArray,
        x: ComplexArray,
        z: ComplexArray,
        count: int,
    ) -> ComplexArray:
        """Derivatives (n_f, n_p) of the equations of motion to every parameter, z^T dK x for solutions x and z."""
        total = np.zeros((x.shape[1], count), dtype=complex)
        # dkappa gamma zeta
        for law, slopes in stiffness.items():
            place = self.twists[law]
            for p, slope in slopes:
                total[:, p] += slope * x[place] * z[place]
        # kappa (dgamma zeta + gamma dzeta), where a ratio moves the row of the law
        for (law, p), place in self.law_slopes.items():
            twist = self.twists[law]
            total[:, p] += kappa[law] * (x[place] * z[twist] + x[twist] * z[place])
        # Likewise of a condition, whose torque lambda takes the place of kappa gamma.
        for (condition, p), place in self.condition_slopes.items():
            gap = self.first_gap + self.multipliers[condition]
            total[:, p] += z[gap] * x[place] + x[gap] * z[place]
        return total


@dataclass
class _Outputs:
    rows: list[Row] = field(default_factory=list)

    def add(self, row: Row) -> int:
        self.rows.append(row)
        return len(self.rows) - 1


def law_stiffness_of(system: Augmented, omega: FloatArray) -> LawStiffness:
    """Dynamic stiffness (n_laws, n_f) of an augmented system at omega (n_f,) in rad/s, as the solver takes it."""
    # j k eta of hysteretic laws does not grow with omega and stands with the tables.
    sampled: dict[int, ComplexArray] = {
        law: np.full((1, len(omega)), 1j * system.hysteretic.values[law])
        for law in np.flatnonzero(system.hysteretic.values).tolist()
    }
    for law, table in system.tables:
        sampled[law] = sampled.get(law, 0.0) + table.kappa(omega)[None]
    parts = (system.inertia.values[None], system.damping.values[None], system.stiffness.values[None])
    return LawStiffness(*parts, omega=omega, sampled=tuple(sampled.items()))
