"""Characteristic equation det P(s) = 0 of a drivetrain with controllers, exact also with delays.

    P(s) = [ D(s)                 -B    ]
           [ -N(s) e^(-s tau) L    E(s) ]    over coordinates q and torques T of the actions with laws N/E e^(-s tau)

has no poles of its own, so that its roots are the poles of the drivetrain. Roots at zero are taken out exactly
(:mod:`.exact_pencil`) before anything is solved or counted in double precision, so that rounding cannot turn them into
slow poles. How many roots there are without delays is counted modulo a large prime; with delays there are
infinitely many, and those in a circle are counted by the argument principle.

Start values for poles of a drivetrain with controllers, from its state matrix and from slow roots. Rounding turns a
double root at zero into a pair of small eigenvalues, which hides slow poles. These are taken from the characteristic
equation without its roots at zero instead.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsionnet.linear.assembly.action_laws import polynomial
from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.state_space import first_order
from torsionnet.linear.modes.exact_pencil import (
    DeflatedColumn,
    ExactPencil,
    deflated_coefficient,
    deflated_columns,
    null_vectors,
)

MOST_ITERATIONS = 30
"""Most steps of inverse iteration for a pole in double precision, as a start with some right digits needs a few."""
CONVERGED = 1e-9
"""Relative step below which a pole counts as found, unless rounding moves it by more and ten times its error is the
limit."""
EPS = float(np.finfo(float).eps)
"""Relative rounding of a number in double precision, 2.2e-16."""
POINTS_ON_CIRCLE, POINTS_PER_ROW = 64, 8
"""Fewest points on half a circle along which the phase of det P is followed, in all, and for each row of the matrix."""
POINTS_PER_DELAY_RADIAN = 4
"""Points on half a circle per radian by which delays turn the phase of det P(s), as fewer could miss whole turns."""
MOST_HALVINGS = 1 << 16
"""Most halvings of steps while the phase of det P is followed, since a root on the circle would need infinitely
many."""


@dataclass(frozen=True, eq=False)
class ActivePencil:
    """Characteristic equation det P(s) = 0 of a drivetrain with controllers, and its roots (poles) in rad/s.

    Coefficients are constant.

    ``loss`` (n_laws,) are the k eta of hysteretic laws, for roots with Im s > 0.
    """

    assembly: Assembly
    loss: FloatArray | None = None

    @cached_property
    def _laws(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        system = self.assembly.system
        return system.K, system.C, system.M

    @cached_property
    def _rows(self) -> tuple[FloatArray, FloatArray]:
        """Coefficients (n_act, n_q) of the motions that controllers drive, and of those that they sense."""
        actions, n = self.assembly.system.actions, self.n_coordinates
        driven = [self.assembly.over_coordinates(action.row) for action in actions]
        sensed = [self.assembly.over_coordinates(action.sensed) for action in actions]
        return np.array(driven).reshape(-1, n), np.array(sensed).reshape(-1, n)

    @property
    def n_coordinates(self) -> int:
        """Number of coordinates in the characteristic equation, after which come the torques of the actions."""
        return self.assembly.system.n_coordinates

    @property
    def size(self) -> int:
        """Number of rows of the characteristic equation, which is that of coordinates and controllers together."""
        return self.n_coordinates + len(self.assembly.system.actions)

    def matrix_at(self, s: complex) -> ComplexArray:
        """Matrix P(s) of the characteristic equation at s in rad/s, (size, size), with roots at zero taken out."""
        whole = self._whole_matrix(s)
        # Columns with roots of det P at zero are replaced by deflated ones, divided by s as often as they vanish there.
        for column in self.columns:
            whole[:, column.place] = column.values_at(s)
            if self.loss is not None:
                strain = 1j * self.assembly.system.rows.T @ (self.loss * column.strain(s))
                whole[: self.n_coordinates, column.place] += strain
        return whole

    def _whole_matrix(self, s: complex) -> ComplexArray:
        """Matrix P(s) of the characteristic equation at s in rad/s, (size, size), with roots at zero left in."""
        K, C, M = self._laws
        # K + C s + M s^2, and j B^T diag(k eta) B of hysteretic springs
        laws = K + s * (C + s * M)
        if self.loss is not None:
            rows = self.assembly.system.rows
            laws = laws + 1j * (rows.T @ (self.loss[:, None] * rows))
        return self._with(laws, [self._law(s, number) for number in range(len(self._rows[0]))], -1.0)

    def derivative(self, s: complex) -> ComplexArray:
        """Derivative of the characteristic equation's matrix :meth:`at` by s in rad/s, shape (size, size)."""
        _, C, M = self._laws
        whole = self._with(C + 2 * s * M, [self._law_rate(s, number) for number in range(len(self._rows[0]))], 0.0)
        for column in self.columns:
            whole[:, column.place] = column.derivative(s)
        return whole

    def term_sizes(self, s: complex) -> FloatArray:
        """Sums (size, size) of the magnitudes of the terms in the matrix :meth:`at`, to estimate rounding by."""
        whole = self._term_sizes(s)
        for column in self.columns:
            whole[:, column.place] = column.size(s)
        return whole

    def _term_sizes(self, s: complex) -> FloatArray:
        system, size = self.assembly.system, abs(s)
        rows = np.abs(system.rows)
        # Magnitudes of all terms, |k| + |c| |s| + |J| |s|^2, of which rounding is a share however they cancel.
        laws = np.abs(system.stiffness) + size * (np.abs(system.damping) + size * np.abs(system.inertia))
        whole = np.zeros((self.size, self.size))
        n = self.n_coordinates
        whole[:n, :n] = rows.T @ (laws[:, None] * rows)
        whole[:n, n:] = np.abs(self._rows[0].T)
        for number, action in enumerate(system.actions):
            above, below = ([abs(float(value)) for value in part] for part in (action.numerator, action.denominator))
            # |e^(-s tau)| = e^(-Re s tau)
            with np.errstate(over="ignore"):
                factor = polynomial(above, size) * np.exp(-s.real * float(action.delay))
            whole[n + number, :n] = factor * np.abs(self._rows[1][number])
            whole[n + number, n + number] = polynomial(below, size)
        return whole

    # --- zero -------------------------------------------------------------------------------------------------------

    @cached_property
    def exact(self) -> ExactPencil:
        """Matrix P(s) of the characteristic equation with rational coefficients."""
        return ExactPencil.of(self.assembly)

    @cached_property
    def columns(self) -> tuple[DeflatedColumn, ...]:
        """Columns of the characteristic equation's matrix with roots at zero taken out, as functions of s."""
        _, right = equilibrating_factors(self._term_sizes(complex(self._typical)))
        return deflated_columns(self.assembly, self.exact, 1 / right)

    @property
    def _typical(self) -> float:
        """Typical frequency of the drivetrain in rad/s, from total stiffness and inertia."""
        system = self.assembly.system
        stiff, heavy = float(np.abs(system.stiffness).sum()), float(system.inertia.sum())
        return float(np.sqrt(stiff / heavy)) if stiff and heavy else 1.0

    @property
    def zeros(self) -> int:
        """Number of roots of the characteristic equation at zero, with multiplicity."""
        return sum(column.order for column in self.columns)

    @cached_property
    def static_shapes(self) -> FloatArray:
        """Basis (n_q, count) of shapes other than zero that can stand still, also under torques of actions."""
        motions, n = [], self.n_coordinates
        for vector in null_vectors(self.exact.coefficient_rows(0)) if self.columns else ():
            basis = np.zeros(self.size)
            basis[list(vector)] = [float(value) for value in vector.values()]
            motions.append(basis[:n])
        shapes = np.array(motions).reshape(-1, n).T
        return np.asarray(shapes[:, np.abs(shapes).max(axis=0, initial=0.0) > 0])

    @np.errstate(all="ignore")  # exponentials of delays overflow far to the left
    def slow_roots(self) -> ComplexArray:
        """Slow roots (n,) in rad/s, approximate and by magnitude, from the first three terms of P(s) at zero."""
        chains, n = {column.place: column.chain for column in self.columns}, self.size
        terms = np.zeros((3, n, n))
        # P(s) = A + B s + C s^2 + ... next to zero
        for power, term in enumerate(terms):
            for i, row in enumerate(deflated_coefficient(self.exact, chains, power)):
                term[i, list(row)] = [float(value) for value in row.values()]
        left, right = equilibrating_factors(np.abs(terms[0]) + np.abs(terms[1]) + np.abs(terms[2]))
        A, B, C = left[:, None] * terms * right
        try:
            follow = -np.linalg.solve(A, np.hstack([B, C]))
        except np.linalg.LinAlgError:  # singular by rounding only
            return np.zeros(0, dtype=complex)
        # 1 / s is an eigenvalue of [[-A^-1 B, -A^-1 C], [I, 0]], so that the slow roots are the largest ones.
        values = np.linalg.eigvals(np.vstack([follow, np.eye(n, 2 * n)]))
        roots = 1 / values
        roots = roots[np.isfinite(roots)]
        return np.asarray(roots[np.argsort(np.abs(roots), kind="stable")], dtype=complex)

    @np.errstate(all="ignore")  # exponentials of delays overflow far to the left
    def null_vector(self, s: complex) -> ComplexArray:
        """Coordinates and torques (size,) of the mode shape at a pole, from the matrix at an s next to the pole."""
        P = self.matrix_at(s)
        left, right = equilibrating_factors(np.abs(P))
        # Of any vector P(s)^-1 leaves the null vector next to a pole.
        start = np.cos(np.arange(self.size) + 1.0)
        try:
            return self._from_columns(s, right * np.linalg.solve(left[:, None] * P * right, start))
        except np.linalg.LinAlgError:
            return self._from_columns(s, start.astype(complex))

    def _from_columns(self, s: complex, vector: ComplexArray) -> ComplexArray:
        """Coordinates and action torques (size,) that a vector over the columns of :meth:`at` stands for."""
        motion = np.array(vector, dtype=complex)
        motion[[column.place for column in self.columns]] = 0.0
        for column in self.columns:
            motion += vector[column.place] * column.motion_at(s)
        return motion

    def _over_columns(self, s: complex, vector: ComplexArray) -> ComplexArray:
        """Vector over the columns of :meth:`at` (size,) that stands for these coordinates and torques.

        It is the inverse of :meth:`_from_columns`.
        """
        unknowns, places = np.array(vector, dtype=complex), [column.place for column in self.columns]
        if places:
            motions = np.array([column.motion_at(s) for column in self.columns]).T
            if not np.isfinite(motions).all():
                return np.full(len(unknowns), np.nan + 0j)
            try:
                shares = np.linalg.solve(motions[places], unknowns[places])
            except np.linalg.LinAlgError:
                return np.full(len(unknowns), np.nan + 0j)
            unknowns = unknowns - motions @ shares
            unknowns[places] = shares
        return unknowns

    # --- matrices ---------------------------------------------------------------------------------------------------

    def _with(self, laws: ComplexArray, actions: list[tuple[complex, complex]], driving: float) -> ComplexArray:
        n, (driven, sensed) = self.n_coordinates, self._rows
        whole = np.zeros((self.size, self.size), dtype=complex)
        whole[:n, :n], whole[:n, n:] = laws, driving * driven.T
        for number, (above, below) in enumerate(actions):
            whole[n + number, :n] = -above * sensed[number]
            whole[n + number, n + number] = below
        return whole

    def _law(self, s: complex, number: int) -> tuple[complex, complex]:
        action = self.assembly.system.actions[number]
        above, below = ([float(value) for value in part] for part in (action.numerator, action.denominator))
        with np.errstate(all="ignore"):
            return polynomial(above, s) * np.exp(-s * float(action.delay)), polynomial(below, s)

    def _law_rate(self, s: complex, number: int) -> tuple[complex, complex]:
        action = self.assembly.system.actions[number]
        above, below = ([float(value) for value in part] for part in (action.numerator, action.denominator))
        tau = float(action.delay)
        # d/ds N e^(-s tau) = (N' - tau N) e^(-s tau)
        slope = polynomial(_derivative(above), s) - tau * polynomial(above, s)
        with np.errstate(all="ignore"):
            return slope * np.exp(-s * tau), polynomial(_derivative(below), s)

    def with_torques(self, s: complex, shape: ComplexArray) -> ComplexArray:
        """Shape (n_q,) with the torques of the actions in N m appended, shape (n_q + n_act,)."""
        torques = []
        for number, sensed in enumerate(self._rows[1]):
            above, below = self._law(s, number)
            torques.append(above * (sensed @ shape) / below if below else 0.0)
        return np.concatenate([shape, np.array(torques, dtype=complex)])

    # --- single roots -----------------------------------------------------------------------------------------------

    @np.errstate(all="ignore")  # exponentials of delays overflow far to the left
    def root_near(self, start: complex, vector: ComplexArray) -> tuple[complex, ComplexArray, float] | None:
        """Pole near a start in rad/s, its vector (n + n_act,) and relative rounding error, or None where there is none.

        By nonlinear inverse iteration in coordinates that make the largest entry of every row and column one.
        """
        s, last = complex(start), float("inf")
        w = self._over_columns(s, vector)
        if not np.isfinite(w).all():  # the start is zero
            return None
        for _ in range(MOST_ITERATIONS):
            P, rate = self.matrix_at(s), self.derivative(s)
            if not (np.isfinite(P).all() and np.isfinite(rate).all() and np.isfinite(s)) or s == 0:
                return None
            left, right = equilibrating_factors(np.abs(P) + abs(s) * np.abs(rate))
            scaled, slope = left[:, None] * P * right, left[:, None] * rate * right
            v = w / right
            v = v / np.linalg.norm(v)
            # z = P^-1 P' v, and s moves by v^H v / v^H z
            try:
                z = np.linalg.solve(scaled, slope @ v)
            except np.linalg.LinAlgError:
                z = np.full(len(v), np.nan)
            if not np.isfinite(z).all():  # on the root itself: beside it there is a solution
                s *= 1 + 8 * EPS
                continue
            step = (v.conj() @ v) / (v.conj() @ z)
            s, w = complex(s - step), right * z / np.linalg.norm(z)
            # Done at rounding, or where steps next to the root no longer become shorter.
            if abs(step) <= 4 * EPS * abs(s) or (last <= CONVERGED * abs(s) and abs(step) >= last / 2):
                return s, self._from_columns(s, w), self._error(s, w)
            last = float(abs(step))
        error = self._error(s, w) if np.isfinite(s) and s else np.inf
        # Not settled: still a pole if the last step is explained by rounding.
        kept = last <= max(CONVERGED, min(10 * error, 0.1)) * abs(s)
        return (s, self._from_columns(s, w), max(error, last / abs(s))) if kept else None

    def _error(self, s: complex, w: ComplexArray) -> float:
        """Relative error of a pole, as rounding of all terms of its equation times the condition of the pole."""
        for beside in (s, s * (1 + 8 * EPS)):
            P, rate = self.matrix_at(beside), self.derivative(beside)
            left, right = equilibrating_factors(np.abs(P) + abs(s) * np.abs(rate))
            try:  # next to a root, one step of inverse iteration leaves the left vector alone
                v = w / right / np.linalg.norm(w / right)
                y = left * np.linalg.solve((left[:, None] * P * right).conj().T, v)
            except np.linalg.LinAlgError:
                continue
            # |ds| = |y|^T |dP| |x| / |y^H P' x|
            slope = abs(y.conj() @ rate @ w)
            rounding = np.abs(y) @ self.term_sizes(s) @ np.abs(w)
            return float(EPS * rounding / (slope * abs(s))) if slope and s else np.inf
        return np.inf

    # --- counting ---------------------------------------------------------------------------------------------------

    def counts(self) -> tuple[int, int]:
        """Number of poles without delays, and of those at zero, counted exactly modulo a large prime."""
        return self.exact.counts(self.zeros + 1)

    @np.errstate(all="ignore")  # exponentials of delays overflow far to the left
    def count_within(self, radius: float) -> int | None:
        """Number of poles within a circle of this radius in rad/s, zeros included, or None with a pole on it."""
        delays = sum(float(action.delay) for action in self.assembly.system.actions)
        n = max(POINTS_ON_CIRCLE, POINTS_PER_ROW * self.size, math.ceil(POINTS_PER_DELAY_RADIAN * radius * delays))
        first = self._phase(radius, 0.0)
        angles = np.linspace(0, np.pi, n + 1)  # conjugate roots: the lower half adds the same phase
        phases = [first, *(self._phase(radius, angle) for angle in angles[1:])]
        total, places = 0.0, list(zip(angles.tolist(), phases, strict=True))
        stack = [(places[i], places[i + 1]) for i in range(n)]
        steps = 0
        while stack:
            (a, p), (b, q) = stack.pop()
            change = np.angle(q / p)
            middle = (a + b) / 2
            # Steps are halved until the phase turns little and evenly, so that no whole turn is missed.
            half = self._phase(radius, middle)
            first_turn, second_turn = np.angle(half / p), np.angle(q / half)
            if abs(first_turn) < 0.8 and abs(second_turn) < 0.8 and abs(first_turn + second_turn - change) < 1e-6:
                total += float(change)
                continue
            steps += 1
            if steps > MOST_HALVINGS or not np.isfinite(total):
                return None
            stack += [((a, p), (middle, half)), ((middle, half), (b, q))]
        # Argument principle: arg det P turns by 2 pi for each root within, by pi on half the circle.
        count = total / np.pi
        return round(count) + self.zeros if abs(count - round(count)) < 0.1 else None

    def _phase(self, radius: float, angle: float) -> complex:
        sign, _ = np.linalg.slogdet(self.matrix_at(complex(radius * np.exp(1j * angle))))
        return complex(sign)


def _derivative(coefficients: list[float]) -> list[float]:
    return [power * value for power, value in enumerate(coefficients)][1:]


def equilibrating_factors(sizes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Factors (n,) of rows and of columns, powers of two, that bring the largest entry of each to about one."""
    left, right = np.ones(len(sizes)), np.ones(len(sizes))
    # Entries of zero must not call for infinite factors.
    sizes = np.maximum(sizes, 1e-40 * sizes.max(initial=1e-200))
    for _ in range(3):
        now = left[:, None] * sizes * right
        left = left / np.sqrt(np.maximum(now.max(axis=1), 1e-300))
        right = right / np.sqrt(np.maximum(now.max(axis=0), 1e-300))
    # Powers of two scale without rounding.
    return np.exp2(np.round(np.log2(left))), np.exp2(np.round(np.log2(right)))


# Start values for poles of a drivetrain with controllers, from its state matrix and from slow roots.

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
    poles = []
    for number in np.argsort(np.abs(values), kind="stable"):
        value, x = complex(values[number]), states[:, number]
        if value.imag < 0:
            continue
        q = form.X @ x
        # Torque of an action: what follows the sensed motion at once, and that of its states.
        torques = [
            (action.sensed @ q) * np.polynomial.polynomial.polyval(value, action.at_once) + form.torques[place] @ x
            for place, action in enumerate(form.actions)
        ]
        # |d lambda| <= eps ||A|| cond(lambda)
        error = EPS * size * float(condition[number]) / abs(value) if value else np.inf
        poles.append(Pole(value, np.concatenate([q, torques]).astype(complex), error))
    return poles


def slow_starts(pencil: ActivePencil, loose: list[Pole]) -> list[Pole]:
    """Slow poles in rad/s as start values, in the range of the uncertain starts ``loose``, without rounded zeros."""
    fastest = max((abs(pole.value) for pole in loose), default=0.0)
    values = [complex(value) for value in pencil.slow_roots() if abs(value) <= SLOW_RANGE * fastest and value.imag >= 0]
    return [Pole(value, pencil.null_vector(value), 0.1) for value in values]
