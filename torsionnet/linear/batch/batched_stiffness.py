"""Frequency-dependent stiffness in N m/rad of one law in many variants of a drivetrain."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness, DynamicStiffness, ScaledStiffness


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
            real, imag = self.coefficients
            return np.repeat((real + 1j * imag)[:, None], len(omega), axis=1)
        if isinstance(self.of, ScaledStiffness) and not self.of.base.coefficients:
            return np.asarray(self.coefficients[0][:, None] * self.of.base.kappa(omega))
        return np.array([self.single(place).kappa(omega) for place in range(n)]).reshape(n, len(omega))

    def part(self, which: NDArray[np.intp], count: int) -> BatchedStiffness:
        """Frequency-dependent stiffness in N m/rad for the variants ``which`` out of ``count``, renumbered from 0."""
        places = np.full(count, -1)
        places[self.places] = np.arange(len(self.places))
        mine = places[which]
        there = np.flatnonzero(mine >= 0)
        return replace(self, places=there, coefficients=self.coefficients[:, mine[there]])
