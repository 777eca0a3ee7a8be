"""Where to begin to look for poles of a drivetrain with controllers: eigenvalues of its states, and slow ones beside.

A double root at zero comes out of the states as a pair that is small, and as wrong as it is large: it hides slow poles
that are there. Those come from the characteristic equation without its roots at zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.assembly.rows import ComplexArray
from torsionnet.solve.dynamic_stiffness.state_space import first_order
from torsionnet.solve.modes.active_pencil import EPS, ActivePencil

FIRM = 1e-3
"""Relative error up to which an eigenvalue of the states is a pole, and not what rounding has made of zero."""
BEYOND = 10.0
"""Slow poles are looked for up to so many times the fastest eigenvalue that is not firm."""


@dataclass(frozen=True)
class Pole:
    """A root of the characteristic equation with Im >= 0, and its shape over coordinates and torques of actions."""

    value: complex
    vector: ComplexArray
    error: float
    converged: bool = True

    @property
    def is_real(self) -> bool:
        return self.value.imag == 0

    @property
    def count(self) -> int:
        """How many roots it stands for: with its conjugate, two."""
        return 1 if self.is_real else 2


def upper_starts(pencil: ActivePencil, points: int) -> list[Pole]:
    """Eigenvalues of the states with Im >= 0, rising in size, with an estimate of their errors."""
    from scipy import linalg

    form = first_order(pencil.assembly, (), points)
    if not len(form.A):
        return []
    balanced, back = linalg.matrix_balance(form.A)
    values, right = np.linalg.eig(balanced)
    try:
        with np.errstate(over="ignore"):  # of eigenvectors that are nearly the same
            condition = np.linalg.norm(np.linalg.inv(right), axis=1)
    except np.linalg.LinAlgError:
        condition = np.full(len(values), np.inf)
    states, size = back @ right, float(np.linalg.norm(balanced))
    found = []
    for number in np.argsort(np.abs(values), kind="stable"):
        value, x = complex(values[number]), states[:, number]
        if value.imag < 0:
            continue
        q = form.X @ x
        torques = [
            (one.sensed @ q) * np.polynomial.polynomial.polyval(value, one.at_once) + form.torques[place] @ x
            for place, one in enumerate(form.actions)
        ]
        error = EPS * size * float(condition[number]) / abs(value) if value else np.inf
        found.append(Pole(value, np.concatenate([q, torques]).astype(complex), error))
    return found


def slow_starts(pencil: ActivePencil, loose: list[Pole]) -> list[Pole]:
    """Starts about as slow as those that are not firm, without what rounding makes of zero."""
    fastest = max((abs(pole.value) for pole in loose), default=0.0)
    values = [complex(value) for value in pencil.slowest() if abs(value) <= BEYOND * fastest and value.imag >= 0]
    return [Pole(value, pencil.null_vector(value), 0.1) for value in values]
