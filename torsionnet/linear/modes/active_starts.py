"""Start values for poles of a drivetrain with controllers, from its state matrix and from slow roots.

Rounding turns a double root at zero into a pair of small eigenvalues, which hides slow poles. These are taken from the
characteristic equation without its roots at zero instead.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray
from torsionnet.linear.dynamic_stiffness.state_space import first_order
from torsionnet.linear.modes.active_pencil import EPS, ActivePencil

LARGEST_START_ERROR = 1e-3
"""Relative error up to which an eigenvalue of the state matrix is a pole, as one with more may be a rounded zero."""
SLOW_RANGE = 10.0
"""Range of slow roots that serve as starts, over the largest uncertain eigenvalue, which may be wrong by its size."""


@dataclass(frozen=True)
class Pole:
    """Pole with Im >= 0 in rad/s, its vector over coordinates and action torques, and its relative error."""

    value: complex
    vector: ComplexArray
    error: float
    converged: bool = True

    @property
    def is_real(self) -> bool:
        """Whether the pole is real, so that it has no conjugate."""
        return self.value.imag == 0

    @property
    def count(self) -> int:
        """Number of roots that the pole stands for, 2 for a pole and its conjugate, 1 for a real pole."""
        return 1 if self.is_real else 2


def state_eigenvalues(pencil: ActivePencil, points: int) -> list[Pole]:
    """Eigenvalues of the state matrix as poles in rad/s, Im >= 0, by magnitude, with estimated relative errors.

    Delays have ``points``.
    """
    from scipy import linalg

    form = first_order(pencil.assembly, (), points)
    if not len(form.A):
        return []
    balanced, back = linalg.matrix_balance(form.A)
    values, right = np.linalg.eig(balanced)
    try:
        with np.errstate(over="ignore"):  # eigenvectors are nearly the same
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
    """Slow poles in rad/s as start values, in the range of the uncertain starts ``loose``, without rounded zeros."""
    fastest = max((abs(pole.value) for pole in loose), default=0.0)
    values = [complex(value) for value in pencil.slow_roots() if abs(value) <= SLOW_RANGE * fastest and value.imag >= 0]
    return [Pole(value, pencil.null_vector(value), 0.1) for value in values]
