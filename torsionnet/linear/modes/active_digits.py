"""Roots of the characteristic equation in many digits, for poles that double precision does not resolve."""

from __future__ import annotations

from typing import Any

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray, polynomial
from torsionnet.linear.assembly.system import Assembly
from torsionnet.linear.dynamic_stiffness.many_digits import in_many_digits

DIGITS = 60
"""Decimal digits of all sums in a root's equation, enough against cancellation between stiff and soft springs."""
MOST_ITERATIONS = 20
"""Most steps of inverse iteration for a pole in many digits, as a start with some right digits needs a few."""
CONVERGED = 1e-15
"""Relative step at which a pole in many digits counts as found, since the result is rounded to double precision."""


class ManyDigitPencil:
    """Matrix P(s) of a controlled drivetrain's characteristic equation det P(s) = 0, in mpmath numbers.

    It is that of :class:`~torsionnet.linear.modes.active_pencil.ActivePencil`.

    To be used within ``mpmath.workdps(DIGITS)``.
    """

    def __init__(self, assembly: Assembly) -> None:
        import mpmath

        self.actions = assembly.system.actions
        self.index: dict[str, int] = {name: place for place, name in enumerate(assembly.kinematics.coordinates)}
        n = len(self.index)
        self.size: int = n + len(self.actions)
        self.powers: list[Any] = [mpmath.zeros(n, n) for _ in range(3)]
        for law, row in zip(assembly.laws, assembly.exact_rows, strict=True):
            ours = [(self.index[name], in_many_digits(value)) for name, value in row.items() if name in self.index]
            for power, value in zip(self.powers, (law.stiffness, law.damping, law.inertia), strict=True):
                for i, a in ours if value else ():
                    for j, b in ours:
                        power[i, j] += in_many_digits(value) * a * b

    def at(self, s: Any, rate: bool = False) -> Any:
        """Matrix P(s) of the characteristic equation, or its derivative dP/ds, as an mpmath matrix."""
        import mpmath

        K, C, M = self.powers
        n, whole = len(self.index), mpmath.zeros(self.size, self.size)
        whole[:n, :n] = C + 2 * s * M if rate else K + s * (C + s * M)
        for place, action in enumerate(self.actions, n):
            above, below = (
                [in_many_digits(value) for value in part] for part in (action.numerator, action.denominator)
            )
            tau = in_many_digits(action.delay)
            factor, own = polynomial(above, s), polynomial(below, s)
            if rate:
                factor, own = polynomial(_slope(above), s) - tau * factor, polynomial(_slope(below), s)
            for name, value in action.sensed.items():
                if name in self.index:
                    whole[place, self.index[name]] = -factor * mpmath.exp(-s * tau) * in_many_digits(value)
            for name, value in action.row.items() if not rate else ():
                if name in self.index:
                    whole[self.index[name], place] = -in_many_digits(value)
            whole[place, place] = own
        return whole

    def root_near(self, start: complex, vector: ComplexArray) -> tuple[complex, ComplexArray] | None:
        """Pole near a start in rad/s with its vector, right to double precision, or None without convergence."""
        import mpmath

        s, w = mpmath.mpmathify(start), mpmath.matrix([mpmath.mpmathify(complex(value)) for value in vector])
        for _ in range(MOST_ITERATIONS):
            try:
                z = mpmath.lu_solve(self.at(s), self.at(s, rate=True) * w)
            except ZeroDivisionError:
                return complex(s), np.array([complex(value) for value in w])
            largest = max(range(len(w)), key=lambda place: abs(w[place]))
            if not z[largest]:
                return None
            step = w[largest] / z[largest]
            s, w = s - step, z / max(abs(value) for value in z)
            if abs(step) <= CONVERGED * abs(s):
                return complex(s), np.array([complex(value) for value in w])
        return None


def _slope(coefficients: list[Any]) -> list[Any]:
    return [power * value for power, value in enumerate(coefficients)][1:]
