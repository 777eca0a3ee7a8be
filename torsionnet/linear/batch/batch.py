"""Variants of a drivetrain with coefficients of all laws in arrays, on rows that all variants share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.action_laws import ActionLaw
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness, DynamicStiffness, ScaledStiffness

if TYPE_CHECKING:
    from torsionnet.linear.assembly.law_stiffness import LawStiffness

# Frequency-dependent stiffness in N m/rad of one law in many variants of a drivetrain.


@dataclass(frozen=True, eq=False)
class BatchedStiffness:
    """Frequency-dependent stiffness of one law in some variants of a batch, in N m/rad.

    Attributes
    ----------
    law : int
        Number of the law.
    places : (n,) array
        Which variants.
    of : DynamicStiffness
        What they have in common.
    coefficients : (n_coefficients, n) array
        The numbers it is made from; none if all have the same ones.
        Of a :class:`ComplexStiffness` real and imaginary part.
    """

    law: int
    places: NDArray[np.intp]
    of: DynamicStiffness
    coefficients: FloatArray

    def single(self, place: int) -> DynamicStiffness:
        """Frequency-dependent stiffness in N m/rad of the law in the variant at this place."""
        values = self.coefficients[:, place].tolist()
        if not values:
            return self.of
        if isinstance(self.of, ComplexStiffness):
            return ComplexStiffness(complex(*values))
        return self.of.with_coefficients(*values)

    def kappa(self, omega: FloatArray) -> ComplexArray:
        """Complex stiffness of the law in N m/rad, shape (n, n_f), at omega (n_f,) >= 0 in rad/s."""
        n = len(self.places)
        if not len(self.coefficients):
            return np.repeat(self.of.kappa(omega)[None], n, axis=0)
        if isinstance(self.of, ComplexStiffness):
            # Hysteretic: kappa = k + j k eta at every omega.
            real, imag = self.coefficients
            return np.repeat((real + 1j * imag)[:, None], len(omega), axis=1)
        if isinstance(self.of, ScaledStiffness) and not self.of.base.coefficients:
            # A scaled table: the samples of its base serve all variants.
            return np.asarray(self.coefficients[0][:, None] * self.of.base.kappa(omega))
        return np.array([self.single(place).kappa(omega) for place in range(n)]).reshape(n, len(omega))

    def part(self, which: NDArray[np.intp], count: int) -> BatchedStiffness:
        """Frequency-dependent stiffness in N m/rad for the variants ``which`` out of ``count``, renumbered from 0."""
        # Where each variant of the whole batch stands among those of this law, -1 if it is none of them.
        places = np.full(count, -1)
        places[self.places] = np.arange(len(self.places))
        mine = places[which]
        there = np.flatnonzero(mine >= 0)
        return replace(self, places=there, coefficients=self.coefficients[:, mine[there]])


@dataclass(frozen=True, eq=False)
class Batch:
    """Variants of a drivetrain with their parameter values and the coefficients of all laws, as arrays in SI units.

    Attributes
    ----------
    drivetrain : AssembledModel
        With its own values; all variants have its rows.
    values : mapping
        Parameter -> (n,) values in SI.
    inertia, damping, stiffness : (n, n_laws) arrays
        kg m^2, N m s/rad, N m/rad of the laws of ``drivetrain.assembly.system``.
    dynamic : tuple of BatchedStiffness
        What laws have beside them.
    impossible : (n,) boolean array
        Variants that :meth:`torsionnet.Drivetrain.configured` refuses; their coefficients say nothing.
    separate : (n,) boolean array
        Variants that have other acting laws, as one whose stiffness vanishes, and so another system of equations: to be
        solved by their :meth:`model`. Their coefficients say nothing.
    moduli : mapping
        Element -> (n,) polar section moduli in m^3 over that of ``drivetrain``, where a varied parameter changes it.
    """

    drivetrain: AssembledModel
    values: Mapping[str, FloatArray]
    inertia: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    dynamic: tuple[BatchedStiffness, ...]
    impossible: NDArray[np.bool_]
    separate: NDArray[np.bool_]
    moduli: Mapping[str, FloatArray]

    def __len__(self) -> int:
        return len(self.impossible)

    @property
    def stacked(self) -> NDArray[np.intp]:
        """Indices of the variants whose coefficients are in the arrays, that is neither impossible nor separate."""
        return np.flatnonzero(~(self.impossible | self.separate))

    def model(self, index: int) -> AssembledModel:
        """Drivetrain model of the variant at this index, at the operating point of the batch's drivetrain.

        Raises
        ------
        ModelError
            Its values are impossible.
        """
        changes = {name: float(column[index]) for name, column in self.values.items()}
        single = self.drivetrain.configured(**changes)
        follow = single.definition.following
        return (
            single.with_operating_values({name: self.drivetrain.parameters[name] for name in follow})
            if follow
            else single
        )

    def part(self, which: Any) -> Batch:
        """Batch of the selected variants, chosen by indices, a slice or a mask."""
        places = np.arange(len(self))[which]
        return Batch(
            self.drivetrain,
            {name: column[places] for name, column in self.values.items()},
            self.inertia[places],
            self.damping[places],
            self.stiffness[places],
            tuple(law.part(places, len(self)) for law in self.dynamic),
            self.impossible[places],
            self.separate[places],
            {name: column[places] for name, column in self.moduli.items()},
        )

    @property
    def _actions(self) -> tuple[ActionLaw, ...]:
        return self.drivetrain.assembly.system.actions

    def law_stiffness(self, omega: FloatArray) -> LawStiffness:
        """Dynamic stiffness of all laws of all variants, in N m/rad, at omega (n_f,) in rad/s."""
        from torsionnet.linear.assembly.law_stiffness import LawStiffness

        laws = dict.fromkeys(batched.law for batched in self.dynamic)
        sampled = {law: np.zeros((len(self), len(omega)), dtype=complex) for law in laws}
        # Each pass over the variants has filled one law for some of them.
        for batched in self.dynamic:
            sampled[batched.law][batched.places] = batched.kappa(omega)
        s = np.asarray(1j * omega, dtype=np.complex128)
        # An action that varies makes no batch, so that kappa(j omega) is the same in all variants.
        actions = tuple(np.repeat(action.kappa(s)[None], len(self), axis=0) for action in self._actions)
        return LawStiffness(self.inertia, self.damping, self.stiffness, omega, tuple(sampled.items()), actions)
