"""Dynamic stiffness of every law in N m/rad over frequency, and over variants of the parameters.

Solvers work on points: one point is one frequency of one variant, all frequencies of the first variant first.

Readings of sensors as linear expressions of the motion and of applied torques.

Every reading is a sum of terms coefficient(s) * gamma, gamma = a^T theta, and a direct share of applied torques, which
only the torque through a rigid connection has. Solvers that care about accuracy keep the gap of such a connection as a
column of its own, because these terms may cancel.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError, unknown_name
from torsionnet.base.expressions import exact
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray, RowSystem
from torsionnet.linear.frequency_response import Channel
from torsionnet.model.channels import UNITS, Sensor
from torsionnet.model.definition import all_nodes
from torsionnet.model.elements import Values
from torsionnet.model.kinematics import exact_row
from torsionnet.model.readings import balance, reading


class LawTerms(NamedTuple):
    """Terms of sums of laws, one of each sum at most: number of the sum, law and factor, all (n,)."""

    slots: NDArray[np.intp]
    laws: NDArray[np.intp]
    factors: FloatArray


@dataclass(frozen=True, eq=False)
class LawStiffness:
    """Dynamic stiffness k - J omega^2 + j c omega + sampled(omega) in N m/rad of every law, by variant and frequency.

    Attributes
    ----------
    inertia, damping, stiffness : (n_variants, n_laws) arrays
    omega : (n_f,) array, or (n_variants, n_f) where every variant has frequencies of its own
        rad/s.
    sampled : tuple of (law index, (n_variants, n_f) complex array)
        What is no polynomial in omega, N m/rad.
    actions : tuple of (n_variants, n_f) complex arrays
        Torque per angle sensed of every action, N m/rad.
    """

    inertia: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    omega: FloatArray
    sampled: tuple[tuple[int, ComplexArray], ...] = ()
    actions: tuple[ComplexArray, ...] = ()

    @property
    def n_laws(self) -> int:
        return int(self.stiffness.shape[1])

    @property
    def n_points(self) -> int:
        return len(self.stiffness) * int(self.omega.shape[-1])

    @property
    def s(self) -> ComplexArray:
        """Laplace variable s = j omega of all points in rad/s, shape (n_points,)."""
        own = self.omega.size == self.n_points  # each variant has frequencies of its own, or all have the same
        omega = self.omega.ravel() if own else np.tile(self.omega, len(self.stiffness))
        return np.asarray(1j * omega, dtype=np.complex128)

    def of(self, law: int) -> ComplexArray:
        """Dynamic stiffness of one law at all points in N m/rad, complex, shape (n_points,)."""
        kappa = np.empty((len(self.stiffness), self.omega.shape[-1]), dtype=complex)
        kappa.real = self.inertia[:, [law]] * -(self.omega * self.omega) + self.stiffness[:, [law]]
        kappa.imag = self.damping[:, [law]] * self.omega
        for number, values in self.sampled:
            if number == law:
                kappa += values
        return kappa.ravel()

    def only(self, laws: Sequence[int]) -> LawStiffness:
        """Dynamic stiffness in N m/rad of the selected laws alone, in the order given."""
        places = {law: place for place, law in enumerate(laws)}
        sampled = tuple((places[law], values) for law, values in self.sampled if law in places)
        parts = self.inertia[:, laws], self.damping[:, laws], self.stiffness[:, laws]
        return LawStiffness(*parts, omega=self.omega, sampled=sampled)

    @property
    def by_law(self) -> ComplexArray:
        """Dynamic stiffness of all laws in N m/rad, shape (n_laws, n_points); the points of a law are contiguous."""
        kappa = np.empty((self.n_laws, len(self.stiffness), self.omega.shape[-1]), dtype=complex)
        J, c, k = (np.ascontiguousarray(part.T)[:, :, None] for part in (self.inertia, self.damping, self.stiffness))
        np.multiply(J, -(self.omega * self.omega), out=kappa.real)
        kappa.real += k
        np.multiply(c, self.omega, out=kappa.imag)
        for law, values in self.sampled:
            kappa[law] += values
        return kappa.reshape(self.n_laws, self.n_points)

    def at(self, points: NDArray[np.intp]) -> LawStiffness:
        """Dynamic stiffness of all laws in N m/rad at selected points.

        Points of several variants become variants of one frequency each.
        """
        variants, places = np.divmod(points, self.omega.shape[-1])
        one_variant = len(self.stiffness) == 1
        shape = (1, len(points)) if one_variant else (len(points), 1)

        def chosen(values: NDArray[Any]) -> Any:
            return values[variants, places].reshape(shape)

        omega = chosen(np.broadcast_to(self.omega, (len(self.stiffness), self.omega.shape[-1])))
        return replace(
            self if one_variant else self.variants(variants),
            omega=omega[0] if one_variant else omega,
            sampled=tuple((law, chosen(values)) for law, values in self.sampled),
            actions=tuple(chosen(values) for values in self.actions),
        )

    def scaled(self, factors: FloatArray) -> LawStiffness:
        """Dynamic stiffness of all laws times ``factors`` (n_laws,)."""
        J, c, k = (factors * part for part in (self.inertia, self.damping, self.stiffness))
        sampled = tuple((law, factors[law] * values) for law, values in self.sampled)
        return replace(self, inertia=J, damping=c, stiffness=k, sampled=sampled)

    def variants(self, which: NDArray[np.intp]) -> LawStiffness:
        """Dynamic stiffness of all laws in N m/rad for selected variants, at the same frequencies."""
        return replace(
            self,
            inertia=self.inertia[which],
            damping=self.damping[which],
            stiffness=self.stiffness[which],
            omega=self.omega if self.omega.ndim == 1 else self.omega[which],
            sampled=tuple((law, values[which]) for law, values in self.sampled),
            actions=tuple(values[which] for values in self.actions),
        )

    def with_sampled_stiffness(self, values: ComplexArray) -> LawStiffness:
        """Dynamic stiffness of all laws given by values (n_laws, n_f) in N m/rad, for one variant."""
        nothing = np.zeros((1, self.n_laws))
        sampled = tuple((law, value[None]) for law, value in enumerate(values))
        return LawStiffness(nothing, nothing, nothing, self.omega, sampled, self.actions)

    def law_sums(self, n_slots: int, terms: Sequence[LawTerms]) -> LawStiffness:
        """Dynamic stiffness in N m/rad of ``n_slots`` sums of laws: their first terms, their second ones, ..."""
        shape = (len(self.stiffness), n_slots)
        J, c, k = (np.zeros(shape, self.stiffness.dtype) for _ in range(3))
        for slots, laws, factors in terms:
            for part, whole in ((J, self.inertia), (c, self.damping), (k, self.stiffness)):
                part[:, slots] += whole[:, laws] * factors.astype(whole.dtype)
        sampled: dict[int, ComplexArray] = {}
        for law, values in self.sampled:
            for slots, laws, factors in terms:
                for place in np.flatnonzero(laws == law).tolist():
                    slot = int(slots[place])
                    sampled[slot] = float(factors[place]) * values + sampled.get(slot, 0.0)
        return LawStiffness(J, c, k, self.omega, tuple(sampled.items()))

    def polynomials(self) -> list[tuple[Any, Any, Any, ComplexArray | None]]:
        """J (kg m^2), c (N m s/rad), k (N m/rad) and samples (N m/rad) of every law, each None where it has none.

        J, c and k are numbers for one variant, else (n_variants, 1) arrays.
        """
        one, columns = len(self.stiffness) == 1, list[Any]()
        for part in (self.inertia, self.damping, self.stiffness):
            values: Any = part[0].tolist() if one else part.T[:, :, None]
            acting: Any = part.any(axis=0).tolist()
            columns.append([value if some else None for value, some in zip(values, acting, strict=True)])
        samples = {law: values[0] if one else values for law, values in self.sampled}
        return list(zip(*columns, map(samples.get, range(self.n_laws)), strict=True))

    def blocks(self, size: int) -> Iterator[LawStiffness]:
        """Yield the dynamic stiffness of all laws in N m/rad in blocks of at most ``size`` points."""
        n_f = self.omega.shape[-1]
        # Several variants while all of their frequencies fit, else one in pieces.
        together = max(1, size // max(1, n_f))
        for first in range(0, len(self.stiffness), together):
            variants = slice(first, first + together)
            for start in range(0, max(1, n_f), max(1, size)):
                frequencies = slice(start, start + size)
                yield replace(
                    self,
                    inertia=self.inertia[variants],
                    damping=self.damping[variants],
                    stiffness=self.stiffness[variants],
                    omega=self.omega[frequencies] if self.omega.ndim == 1 else self.omega[variants, frequencies],
                    sampled=tuple((law, values[variants, frequencies]) for law, values in self.sampled),
                    actions=tuple(values[variants, frequencies] for values in self.actions),
                )


def law_stiffness(systems: Sequence[RowSystem], omega: FloatArray) -> LawStiffness:
    """Dynamic stiffness in N m/rad of every law of a drivetrain's variants, at omega in rad/s.

    ``omega`` is (n_f,), or (n_variants, n_f) where every variant has frequencies of its own.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("dmf_rig")
    >>> soft = rig.configured(k_2=100)
    >>> kappa = law_stiffness([rig.assembly.system, soft.assembly.system], np.array([0.0, 1.0]))
    >>> kappa.n_points
    4
    """
    # kappa = J s^2 + c s + k, equation (1.2), by variant and law; tables and actions are sampled.
    J = np.array([system.inertia for system in systems])
    c = np.array([system.damping for system in systems])
    k = np.array([system.stiffness for system in systems])
    laws = dict.fromkeys(law for system in systems for law, _ in system.dynamic)
    sampled = {law: np.zeros((len(systems), omega.shape[-1]), dtype=complex) for law in laws}
    for variant, system in enumerate(systems):
        for law, at in system.dynamic:
            sampled[law][variant] += at.kappa(omega if omega.ndim == 1 else omega[variant])
    actions = tuple(
        np.array(
            [
                action.kappa(1j * np.broadcast_to(omega, (len(systems), omega.shape[-1]))[variant])
                for variant, action in enumerate(alike)
            ]
        )
        for alike in zip(*(system.actions for system in systems), strict=True)
    )
    return LawStiffness(J, c, k, omega, tuple(sampled.items()), actions)


@dataclass(frozen=True)
class Term:
    """Term of a sensor's reading, factor * s^power * (row theta), or with ``law`` factor * kappa_law(s) * (row theta).

    ``columns`` is the row over the ``n_coordinates`` coordinates and, after them, imposed angles: the floats of
    ``exact``.
    """

    columns: Mapping[int, float]
    n_coordinates: int
    exact: Mapping[str, Fraction]
    factor: Fraction
    power: int = 0
    law: int | None = None

    @property
    def row(self) -> FloatArray:
        """Coefficients (n_q,) of the coordinates in the angle of the term, a dense array: not for large systems."""
        row = np.zeros(self.n_coordinates)
        for column, coefficient in self.columns.items():
            if column < self.n_coordinates:
                row[column] = coefficient
        return row


@dataclass(frozen=True)
class Functional:
    """Reading of a sensor as a linear expression of the motion and of the torques applied to nodes.

    ``sensor`` is None for an excitation in the place of a measured input; ``applied`` is empty unless the torque of a
    rigid connection is read. ``actions`` are the factors of the torques of actions that belong to the element read;
    what actions apply to nodes counts with ``applied``.
    """

    name: str
    unit: str
    terms: tuple[Term, ...]
    applied: Mapping[str, Fraction] = field(default_factory=dict)
    actions: Mapping[int, Fraction] = field(default_factory=dict)
    sensor: Sensor | None = None

    @property
    def channel(self) -> Channel:
        """Channel of the reading, with its name and unit."""
        return Channel(self.name, self.unit)

    def direct(self, row: Mapping[str, int]) -> Fraction:
        """Factor from torques on the nodes of a row to the reading without any motion (direct feedthrough)."""
        return sum((share * self.applied.get(node, Fraction(0)) for node, share in row.items()), start=Fraction(0))


def powers_of_s(assembly: Assembly, term: Term) -> tuple[Fraction, Fraction, Fraction]:
    """Coefficients of 1, s and s^2 (SI) in the law of a term; of a term without law, 1 at its power of s and 0 else."""
    if term.law is None:
        return Fraction(term.power == 0), Fraction(term.power == 1), Fraction(term.power == 2)
    law = assembly.laws[term.law]
    return exact(law.stiffness), exact(law.damping), exact(law.inertia)


def functional(drivetrain: AssembledModel, sensor: Sensor, name: str = "") -> Functional:
    """Reading of a sensor of a drivetrain as a linear expression of the motion and of applied torques.

    Raises
    ------
    UsageError
        The node, element or port does not exist or is switched off, or the torque is statically indeterminate.
    """
    assembly, definition = drivetrain.assembly, drivetrain.definition
    on_element = sensor.is_on_element
    known: Collection[str] = drivetrain.elements if on_element else drivetrain.nodes
    for place in (sensor.of,) if on_element else sensor.nodes:
        if place not in known:
            what, declared = "node", all_nodes(definition.elements.values())
            if on_element:
                what, declared = "element", tuple(definition.elements)
            if place in declared:
                text = f'{what} "{place}" is switched off in this configuration; nothing can be measured there'
                raise UsageError(text, kind="switched-off")
            raise UsageError(unknown_name(what, place, known))
    laws = ((owner, law.row) for owner, law in zip(assembly.owners, assembly.laws, strict=True))
    values = Values(drivetrain.exact_values)
    actions = ((action.owner, action.nodes) for action in assembly.system.actions)
    read = reading(sensor, drivetrain.elements, values, laws, assembly.kinematics.constraints, actions)
    whole = Functional(name or str(sensor), UNITS[sensor.quantity], (), sensor=sensor)
    n_coordinates = assembly.system.n_coordinates
    if read.row is not None:  # a motion: s^power times a row over coordinates, theta = T q
        row = exact_row(assembly.kinematics.reduction.reduced(read.row))
        motion = Term(assembly.columns_of(row), n_coordinates, row, factor=Fraction(1), power=read.power)
        return replace(whole, terms=(motion,))
    # A torque: laws that carry it, and through a rigid connection what the balance of torques leaves to it.
    balanced = balance(read, assembly.kinematics, [law.row for law in assembly.laws])
    terms = tuple(
        Term(assembly.law_columns[law], n_coordinates, assembly.exact_rows[law], factor=factor, law=law)
        for law, factor in balanced.laws
        if factor
    )
    own = {number: exact(factor) for number, factor in read.actions.items()}
    return replace(whole, terms=terms, applied=balanced.applied, actions=own)
