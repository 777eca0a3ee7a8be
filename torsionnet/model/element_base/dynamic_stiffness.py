"""Dynamic stiffness that depends on frequency: the part of a law beside J s^2 + c s + k.

A measured dynamic stiffness is known along the imaginary axis alone, as kappa(omega); a formula is known at every s.
Methods take s and the frequency omega of the vibration: a pole lies beside the axis. What a law states over frequency
is then read at ``|Im s|`` and kept, so that k(omega) + s c(omega) acts where it states k and c, and k (1 + j eta) where
it states a loss factor.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Complexes = NDArray[np.complex128]


class DynamicStiffness(ABC):
    """Dynamic stiffness kappa(omega) = k + j omega c of a law in N m/rad, over omega in rad/s.

    Subclasses are frozen dataclasses.

    Its ``coefficients`` are numbers in the algebra of the element that made it. Derivatives to parameters follow from
    ``slopes``, the derivatives to the coefficients.
    """

    @property
    def coefficients(self) -> tuple[Any, ...]:
        """Numbers of the dynamic stiffness that parameters may change."""
        return ()

    def with_coefficients(self, *coefficients: Any) -> Self:
        """Copy of the dynamic stiffness with other coefficients, which may be of another algebra."""
        del coefficients
        return self

    @abstractmethod
    def kappa(self, omega: Floats) -> Complexes:
        """Complex stiffness in N m/rad at omega >= 0 in rad/s, in the shape of ``omega``."""

    @abstractmethod
    def kappa_rate(self, omega: float) -> complex:
        """Derivative of kappa to omega in N m s/rad, at omega in rad/s."""

    def frozen(self, omega: Floats) -> tuple[Complexes, Floats]:
        """Stiffness in N m/rad and damping in N m s/rad that a pole with ``|Im s|`` = omega in rad/s meets.

        By default a stiffness kappa(omega) with its losses, as of a hysteretic spring, and no damping.
        """
        import numpy as np

        return self.kappa(omega), np.zeros(np.shape(omega))

    def frozen_rate(self, omega: float) -> tuple[complex, float]:
        """Derivatives of ``frozen`` to omega, in N m s/rad and N m s^2/rad, at omega in rad/s."""
        return self.kappa_rate(omega), 0.0

    @property
    def rows(self) -> tuple[float, ...]:
        """Frequencies in Hz of the rows between which the dynamic stiffness is interpolated; none of a formula."""
        return ()

    @property
    @abstractmethod
    def is_passive(self) -> bool:
        """Whether the dynamic stiffness can only take energy out of a vibration."""

    @property
    @abstractmethod
    def holds_at_rest(self) -> bool:
        """Whether the dynamic stiffness resists a constant angle."""

    @property
    def is_elastic(self) -> bool:
        """Whether the dynamic stiffness is a spring, even one that vanishes at rest, and not an inertia only."""
        return True

    def at(self, s: Complexes, omega: Floats) -> Complexes:
        """Complex stiffness k + s c in N m/rad at s in rad/s of the upper half plane, in the shape of ``s``.

        By default k and c are those frozen at omega.
        """
        stiffness, damping = self.frozen(omega)
        return stiffness + s * damping

    def rates(self, s: Complexes, omega: Floats) -> tuple[Complexes, Complexes]:
        """Derivatives of the complex stiffness ``at(s, omega)`` to s and to omega, in N m s/rad."""
        import numpy as np

        # d/ds (k + s c) = c, d/domega (k + s c) = k' + s c'
        followed = np.array([self.frozen_rate(frequency) for frequency in omega.tolist()], dtype=complex).reshape(-1, 2)
        return self.frozen(omega)[1].astype(complex), followed[:, 0] + s * followed[:, 1]

    def slopes(self, s: Complexes, omega: Floats) -> Complexes:
        """Derivatives of the complex stiffness to its coefficients, shape (n_coefficients, n_points)."""
        import numpy as np

        del omega
        return np.zeros((0, len(s)), dtype=complex)

    def in_many_digits(self, s: Any) -> Any:
        """Complex stiffness in N m/rad at an mpmath number s, as an mpmath number."""
        import mpmath
        import numpy as np

        return mpmath.mpmathify(complex(self.kappa(np.array([abs(float(mpmath.im(s)))]))[0]))

    @property
    def is_continuous(self) -> bool:
        """Whether the dynamic stiffness stands for a continuous body with infinitely many modes."""
        return False

    def with_loss(self, share: float) -> DynamicStiffness:
        """Copy of the dynamic stiffness with a share of its damping: 0 for none, 1 for all."""
        return WithLoss(self, share)

    @property
    def inertia_at_rest(self) -> float:
        """Inertia J in kg m^2 of the limit k - J omega^2 of the dynamic stiffness at low frequency."""
        return 0.0

    def clamped_modes(self, omega: Floats) -> Floats:
        """Number of internal modes below omega in rad/s with both ends held, in the shape of ``omega``."""
        import numpy as np

        return np.zeros(np.shape(omega))

    def energy(self, s: complex) -> tuple[float, float, float]:
        """Coefficients J, k and k'' (kg m^2, N m/rad) of the energies of a vibration at s.

        Kinetic, strain and dissipated energy.

        These are J |s|^2 |gamma|^2, k |gamma|^2 and k'' |gamma|^2 but for a common factor; by default all that is
        stored is strain.
        """
        import numpy as np

        stiffness, damping = self.frozen(np.array([abs(s.imag)]))
        # k'' = Im k + |s| c: losses of the complex stiffness and of the damping together
        return 0.0, float(stiffness[0].real), float(stiffness[0].imag + abs(s) * damping[0])

    @property
    def label(self) -> str:
        """Subscript of the dynamic stiffness in symbols, where an element has several."""
        return ""

    def formula(self, omega: Any) -> Any:
        """Sympy expression of kappa in omega and the coefficients, or None for measured data."""
        del omega


@dataclass(frozen=True)
class ComplexStiffness(DynamicStiffness):
    """Dynamic stiffness k (1 + j eta) of a hysteretic spring in N m/rad, constant over frequency."""

    value: complex

    def kappa(self, omega: Floats) -> Complexes:
        import numpy as np

        return np.full(np.shape(omega), self.value)

    def kappa_rate(self, omega: float) -> complex:
        del omega
        return 0j

    @property
    def is_passive(self) -> bool:
        return self.value.imag >= 0

    @property
    def holds_at_rest(self) -> bool:
        return self.value.real > 0


@dataclass(frozen=True)
class WithLoss(DynamicStiffness):
    """Dynamic stiffness whose imaginary part is a share of that of another one."""

    of: DynamicStiffness
    share: float

    def kappa(self, omega: Floats) -> Complexes:
        kappa = self.of.kappa(omega)
        return kappa.real + 1j * self.share * kappa.imag

    def kappa_rate(self, omega: float) -> complex:
        rate = self.of.kappa_rate(omega)
        return complex(rate.real, self.share * rate.imag)

    def frozen(self, omega: Floats) -> tuple[Complexes, Floats]:
        stiffness, damping = self.of.frozen(omega)
        return stiffness.real + 1j * self.share * stiffness.imag, self.share * damping

    def frozen_rate(self, omega: float) -> tuple[complex, float]:
        stiffness, damping = self.of.frozen_rate(omega)
        return complex(stiffness.real, self.share * stiffness.imag), self.share * damping

    @property
    def rows(self) -> tuple[float, ...]:
        return self.of.rows

    @property
    def is_passive(self) -> bool:
        return self.of.is_passive

    @property
    def holds_at_rest(self) -> bool:
        return self.of.holds_at_rest

    @property
    def is_elastic(self) -> bool:
        return self.of.is_elastic


@dataclass(frozen=True)
class ScaledStiffness(DynamicStiffness):
    """Dynamic stiffness that is another one times a factor, which may come from a parameter.

    Examples
    --------
    >>> import numpy as np
    >>> from fractions import Fraction
    >>> twice = ScaledStiffness(ComplexStiffness(100 + 5j), Fraction(2))
    >>> twice.kappa(np.array([1.0])), twice.slopes(np.array([1j]), np.array([1.0]))
    (array([200.+10.j]), array([[100.+5.j]]))
    """

    base: DynamicStiffness
    factor: Any
    name: str = ""

    @property
    def coefficients(self) -> tuple[Any, ...]:
        return (self.factor, *self.base.coefficients)

    def with_coefficients(self, *coefficients: Any) -> Self:
        factor, *rest = coefficients
        return replace(self, factor=factor, base=self.base.with_coefficients(*rest))

    def kappa(self, omega: Floats) -> Complexes:
        return float(self.factor) * self.base.kappa(omega)

    def kappa_rate(self, omega: float) -> complex:
        return float(self.factor) * self.base.kappa_rate(omega)

    def frozen(self, omega: Floats) -> tuple[Complexes, Floats]:
        stiffness, damping = self.base.frozen(omega)
        return float(self.factor) * stiffness, float(self.factor) * damping

    def frozen_rate(self, omega: float) -> tuple[complex, float]:
        stiffness, damping = self.base.frozen_rate(omega)
        return float(self.factor) * stiffness, float(self.factor) * damping

    @property
    def rows(self) -> tuple[float, ...]:
        return self.base.rows

    @property
    def is_passive(self) -> bool:
        return self.base.is_passive

    @property
    def holds_at_rest(self) -> bool:
        return self.base.holds_at_rest

    @property
    def is_elastic(self) -> bool:
        return self.base.is_elastic

    @property
    def label(self) -> str:
        return self.name or self.base.label

    def at(self, s: Complexes, omega: Floats) -> Complexes:
        return float(self.factor) * self.base.at(s, omega)

    def rates(self, s: Complexes, omega: Floats) -> tuple[Complexes, Complexes]:
        rate, followed = self.base.rates(s, omega)
        return float(self.factor) * rate, float(self.factor) * followed

    def slopes(self, s: Complexes, omega: Floats) -> Complexes:
        import numpy as np

        own = self.base.at(s, omega)[None]
        return np.concatenate([own, float(self.factor) * self.base.slopes(s, omega)])

    def in_many_digits(self, s: Any) -> Any:
        import mpmath

        factor = mpmath.mpf(self.factor.numerator) / self.factor.denominator
        return factor * self.base.in_many_digits(s)

    def formula(self, omega: Any) -> Any:
        base = self.base.formula(omega)
        return None if base is None else self.factor * base
