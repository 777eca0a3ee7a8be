r"""Exact dynamic stiffness of a uniform round shaft with distributed inertia.

With the stiffness k = G I_p / L and the inertia J = rho I_p L of the whole shaft, K = k (1 + j eta) and
x = omega sqrt(J / K), the torques into the ends are

    [ K x cot x     -K x / sin x ]
    [ -K x / sin x   K x cot x   ] [ theta_1, theta_2 ],     x cot x = x / sin x - x tan(x/2):

a spring K x / sin x between the ends, and -K x tan(x/2) from each of them to ground, which is -J omega^2 / 2 for slow
motions. Both are even in x, so that they are functions of s^2 anywhere in the s-plane.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Self

from torsionnet.model.element_base.dynamic_stiffness import DynamicStiffness

if TYPE_CHECKING:
    from torsionnet.model.element_base.dynamic_stiffness import Complexes, Floats

SERIES_ARGUMENT = 0.1
"""Size of the shaft's argument x below which slopes come from a power series, as differences of sines would cancel."""
DECAYED_ARGUMENT = 300.0
"""Size of Im x above which x / sin x counts as zero, as sin^2 would overflow and e^-300 of a torque passes."""


@dataclass(frozen=True)
class ShaftStiffness(DynamicStiffness):
    """Base class of both dynamic stiffnesses of a shaft with stiffness k, inertia J and loss factor eta."""

    stiffness: Any
    inertia: Any
    loss_factor: Any = 0
    name: str = ""

    @property
    def coefficients(self) -> tuple[Any, ...]:
        return self.stiffness, self.inertia, self.loss_factor

    def with_coefficients(self, *coefficients: Any) -> Self:
        stiffness, inertia, loss_factor = coefficients
        return replace(self, stiffness=stiffness, inertia=inertia, loss_factor=loss_factor)

    def with_loss(self, share: float) -> Self:
        return replace(self, loss_factor=share * float(self.loss_factor))

    @property
    def is_continuous(self) -> bool:
        return True

    @property
    def is_passive(self) -> bool:
        return float(self.loss_factor) >= 0

    def kappa(self, omega: Floats) -> Complexes:
        import numpy as np

        omega = np.asarray(omega, dtype=float)
        return self.at(np.asarray(1j * omega, dtype=complex), omega)

    def kappa_rate(self, omega: float) -> complex:
        import numpy as np

        return complex(1j * self.rates(np.array([1j * omega]), np.array([omega]))[0][0])

    def at(self, s: Complexes, omega: Floats) -> Complexes:
        K, x = self._argument(s, omega)
        return K * self._value(x)

    def rates(self, s: Complexes, omega: Floats) -> tuple[Complexes, Complexes]:
        import numpy as np

        _, x = self._argument(s, omega)
        # With u = x^2 = -s^2 J/K and the part K f(u): d/ds of it is -2 s J f'(u).
        rate = (-2 * float(self.inertia) * s * self._slope(x)).astype(np.complex128)
        return rate, np.zeros(rate.shape, dtype=np.complex128)

    def slopes(self, s: Complexes, omega: Floats) -> Complexes:
        import numpy as np

        K, x = self._argument(s, omega)
        slope = self._slope(x)
        # u goes with 1/K, so that d(K f(u))/dK = f - u f'(u).
        softer = self._value(x) - x * x * slope
        k = float(self.stiffness)
        # To k, J and eta in this order, K being k (1 + j eta).
        return np.array([softer * K / k, -(s**2) * slope, 1j * (np.asarray(omega) > 0) * k * softer])

    def _argument(self, s: Complexes, omega: Floats) -> tuple[Complexes, Complexes]:
        """Complex stiffness K in N m/rad and dimensionless argument x of a shaft, Re x >= 0, in the shape of ``s``."""
        import numpy as np

        # Hysteresis loses in vibration alone: at omega = 0 the stiffness is k.
        lossy = np.asarray(omega) > 0
        K = (float(self.stiffness) * (1 + 1j * float(self.loss_factor) * lossy)).astype(np.complex128)
        return K, np.sqrt(-(np.asarray(s) ** 2) * float(self.inertia) / K)

    @staticmethod
    def _value(x: Complexes) -> Complexes:
        """Dynamic stiffness of a shaft over K, dimensionless, as a function of x."""
        raise NotImplementedError

    @staticmethod
    def _slope(x: Complexes) -> Complexes:
        """Derivative to x^2 of the shaft's dynamic stiffness over K, dimensionless."""
        raise NotImplementedError

    def _forms(self, s: complex) -> tuple[float, float, float, float]:
        return quadratic_forms(complex(self._argument(_array(s), _array(abs(s.imag)).real)[1][0]))

    def in_many_digits(self, s: Any) -> Any:
        import mpmath

        k, J, eta = map(_many_digits, self.coefficients)
        K = k * mpmath.mpc(1, eta)
        return K * self._in_functions(mpmath.sqrt(-(s**2) * J / K), mpmath)

    def formula(self, omega: Any) -> Any:
        import sympy

        K = self.stiffness * (1 + sympy.I * self.loss_factor)
        return K * self._in_functions(omega * sympy.sqrt(self.inertia / K), sympy)

    @staticmethod
    def _in_functions(x: Any, functions: Any) -> Any:
        """Dynamic stiffness of a shaft over its complex stiffness K, by the sine and tangent of a library."""
        raise NotImplementedError

    @property
    def label(self) -> str:
        return self.name


@dataclass(frozen=True)
class ShaftTwist(ShaftStiffness):
    """Dynamic stiffness K x / sin x in N m/rad between the ends of a shaft."""

    @property
    def holds_at_rest(self) -> bool:
        return True

    @staticmethod
    def _value(x: Complexes) -> Complexes:
        import numpy as np

        # x/sin x is 1 at x = 0; beside the real axis it decays with e^-|Im x|.
        near, far = x == 0, np.abs(x.imag) > DECAYED_ARGUMENT
        inside = np.where(near | far, 1.0, x)
        return np.where(near, 1.0, np.where(far, 0.0, inside / np.sin(inside)))

    @staticmethod
    def _slope(x: Complexes) -> Complexes:
        import numpy as np

        near, far = np.abs(x) < SERIES_ARGUMENT, np.abs(x.imag) > DECAYED_ARGUMENT
        inside, u = np.where(near | far, 1.0, x), np.where(near, x * x, 0.0)
        # d(x/sin x)/du with u = x^2, as a series where sin x - x cos x would cancel.
        series = 1 / 6 + u * (7 / 180 + u * (31 / 5040 + u * (127 / 151200 + u * 73 / 684288)))
        sine = np.sin(inside)
        return np.where(near, series, np.where(far, 0.0, (sine - inside * np.cos(inside)) / (2 * inside * sine**2)))

    @staticmethod
    def _in_functions(x: Any, functions: Any) -> Any:
        return x / functions.sin(x)

    def clamped_modes(self, omega: Floats) -> Floats:
        import numpy as np

        x = self._argument((1j * omega).astype(np.complex128), np.zeros(np.shape(omega)))[1].real  # rounded as in kappa
        # A mode with clamped ends is at each x = i pi; the sign of sin x tells on which side of the nearest x lies.
        nearest = np.rint(x / np.pi)
        return np.asarray(nearest - (np.sin(x) * np.where(nearest % 2, -1.0, 1.0) < 0))

    @property
    def inertia_at_rest(self) -> float:
        return -float(self.inertia) / 6

    def energy(self, s: complex) -> tuple[float, float, float]:
        _, crossed, _, strained = self._forms(s)
        k = float(self.stiffness)
        return -float(self.inertia) * crossed, -k * strained, -k * float(self.loss_factor) * strained


@dataclass(frozen=True)
class ShaftEnd(ShaftStiffness):
    """Dynamic stiffness -K x tan(x/2) in N m/rad from an end of a shaft to ground.

    The inertia of half the deforming shaft.
    """

    @property
    def holds_at_rest(self) -> bool:
        return False

    @property
    def is_elastic(self) -> bool:
        return False

    @staticmethod
    def _value(x: Complexes) -> Complexes:
        import numpy as np

        return -x * np.tan(x / 2)

    @staticmethod
    def _slope(x: Complexes) -> Complexes:
        import numpy as np

        far = np.abs(x.imag) > DECAYED_ARGUMENT
        inside = np.where((x == 0) | far, 1.0, x)
        # f = -x tan(x/2): df/d(x^2) = -(sin x + x)/(4 x cos^2(x/2)), which is -1/2 at x = 0.
        slope = -(np.sin(inside) + inside) / (4 * inside * np.cos(inside / 2) ** 2)
        return np.where(x == 0, -0.5, np.where(far, -np.tan(x / 2) / (2 * np.where(far, x, 1.0)), slope))

    @staticmethod
    def _in_functions(x: Any, functions: Any) -> Any:
        return -x * functions.tan(x / 2)

    @property
    def inertia_at_rest(self) -> float:
        return float(self.inertia) / 2

    def energy(self, s: complex) -> tuple[float, float, float]:
        own, crossed, stretched, strained = self._forms(s)
        k = float(self.stiffness)
        inertia, stiffness = float(self.inertia) * (own + crossed), k * (stretched + strained)
        return inertia, stiffness, stiffness * float(self.loss_factor)


def quadratic_forms(x: complex) -> tuple[float, float, float, float]:
    """Coefficients (a, b, c, d), without unit, of mean squares of angle and twist along a shaft in its end angles.

    The mean of |theta|^2 over the length is a (|theta_1|^2 + |theta_2|^2) + 2 b Re(theta_1 theta_2*), and that of
    |dtheta/dxi|^2 the same with c and d.
    """
    import math

    a, b = x.real, x.imag
    if abs(x) < 1e-4:
        # x near 0: the angle is straight along the shaft.
        return 1 / 3, 1 / 6, 1.0, -1.0
    # theta = (theta_1 sin(x (1 - xi)) + theta_2 sin(x xi))/sin x, and the mean of |sin(x xi)|^2 over xi is
    # (sinh(2b)/2b - sin(2a)/2a)/2 with x = a + jb.
    ratio = math.sinh(2 * b) / (2 * b) if b else 1.0
    other = math.sin(2 * a) / (2 * a) if a else 1.0
    # |sin x|^2 = (cosh 2b - cos 2a)/2, which is 0 at a mode with clamped ends.
    size = max((math.cosh(2 * b) - math.cos(2 * a)) / 2, 1e-30)
    first = math.sin(a) / a * math.cosh(b) if a else math.cosh(b)
    second = math.cos(a) * (math.sinh(b) / b if b else 1.0)
    square = abs(x) ** 2
    return (
        (ratio - other) / 2 / size,
        (first - second) / 2 / size,
        square * (ratio + other) / 2 / size,
        -square * (first + second) / 2 / size,
    )


def _array(value: complex) -> Any:
    import numpy as np

    return np.array([value], dtype=complex)


def _many_digits(value: Any) -> Any:
    import mpmath

    exact = Fraction(value)
    return mpmath.mpf(exact.numerator) / exact.denominator
