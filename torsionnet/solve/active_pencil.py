"""The characteristic equation of a drivetrain with controllers, exact also with delays.

    P(s) = [ D(s)                 -B    ]
           [ -N(s) e^(-s tau) L    E(s) ]    over coordinates q and torques T of the actions with laws N/E e^(-s tau)

has no poles of its own, so that its roots are all that grows or dies away by itself. How many there are without delays,
and how many of them are zero, is counted modulo a large prime; with delays there are infinitely many, and those in a
circle are counted by the argument principle.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from torsionnet.assembly.action_law import polynomial
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.assembly.system import Assembly
from torsionnet.model.elimination import exact
from torsionnet.solve.action_states import over_coordinates
from torsionnet.solve.modular import determinant, interpolated, primes, residue
from torsionnet.solve.refine import least_fill

MOST_STEPS = 30
EPS = float(np.finfo(float).eps)
ON_CIRCLE, PER_ROOT = 64, 8
"""Points on half a circle to begin with, along which the phase is followed: in all, and for each row."""
FINEST = 1 << 16


@dataclass(frozen=True, eq=False)
class ActivePencil:
    """P(s) of an assembly with actions and constant coefficients.

    ``loss`` (n_laws,) are the k eta of hysteretic laws, for what vibrates with Im s > 0.
    """

    assembly: Assembly
    loss: FloatArray | None = None

    @cached_property
    def _laws(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        system = self.assembly.system
        return system.K, system.C, system.M

    @cached_property
    def _rows(self) -> tuple[FloatArray, FloatArray]:
        """What actions drive and what they sense, (n_act, n_q)."""
        actions, n = self.assembly.system.actions, self.n_coordinates
        driven = [over_coordinates(self.assembly, one.row) for one in actions]
        sensed = [over_coordinates(self.assembly, one.sensed) for one in actions]
        return np.array(driven).reshape(-1, n), np.array(sensed).reshape(-1, n)

    @property
    def n_coordinates(self) -> int:
        return self.assembly.system.n_coordinates

    @property
    def size(self) -> int:
        return self.n_coordinates + len(self.assembly.system.actions)

    def at(self, s: complex) -> ComplexArray:
        """P(s)."""
        K, C, M = self._laws
        laws = K + s * (C + s * M)
        if self.loss is not None:
            rows = self.assembly.system.rows
            laws = laws + 1j * (rows.T @ (self.loss[:, None] * rows))
        return self._with(laws, [self._law(s, number) for number in range(len(self._rows[0]))], -1.0)

    def rate(self, s: complex) -> ComplexArray:
        """dP/ds."""
        _, C, M = self._laws
        return self._with(C + 2 * s * M, [self._law_rate(s, number) for number in range(len(self._rows[0]))], 0.0)

    def sizes(self, s: complex) -> FloatArray:
        """Magnitudes of the terms of P(s), summed up: what its rounding is a share of."""
        system, size = self.assembly.system, abs(s)
        rows = np.abs(system.rows)
        laws = np.abs(system.stiffness) + size * (np.abs(system.damping) + size * np.abs(system.inertia))
        whole = np.zeros((self.size, self.size))
        n = self.n_coordinates
        whole[:n, :n] = rows.T @ (laws[:, None] * rows)
        whole[:n, n:] = np.abs(self._rows[0].T)
        for number, action in enumerate(system.actions):
            above, below = ([abs(float(value)) for value in part] for part in (action.numerator, action.denominator))
            with np.errstate(over="ignore"):
                factor = polynomial(above, size) * np.exp(-s.real * float(action.delay))
            whole[n + number, :n] = factor * np.abs(self._rows[1][number])
            whole[n + number, n + number] = polynomial(below, size)
        return whole

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
        with np.errstate(all="ignore"):  # far to the left nothing comes back
            return polynomial(above, s) * np.exp(-s * float(action.delay)), polynomial(below, s)

    def _law_rate(self, s: complex, number: int) -> tuple[complex, complex]:
        action = self.assembly.system.actions[number]
        above, below = ([float(value) for value in part] for part in (action.numerator, action.denominator))
        tau = float(action.delay)
        slope = polynomial(_derivative(above), s) - tau * polynomial(above, s)
        with np.errstate(all="ignore"):
            return slope * np.exp(-s * tau), polynomial(_derivative(below), s)

    def completed(self, s: complex, shape: ComplexArray) -> ComplexArray:
        """A shape over coordinates with the torques of the actions, (n + n_act,)."""
        torques = []
        for number, sensed in enumerate(self._rows[1]):
            above, below = self._law(s, number)
            torques.append(above * (sensed @ shape) / below if below else 0.0)
        return np.concatenate([shape, np.array(torques, dtype=complex)])

    # --- single roots -----------------------------------------------------------------------------------------------

    def settled(self, start: complex, vector: ComplexArray) -> tuple[complex, ComplexArray, float] | None:
        """The root near a start, its vector (n + n_act,), and the relative error that rounding leaves; or None.

        By nonlinear inverse iteration in coordinates that make the largest entry of every row and column one.
        """
        s, w, last = start, vector, float("inf")
        for _ in range(MOST_STEPS):
            P, rate = self.at(s), self.rate(s)
            if not (np.isfinite(P).all() and np.isfinite(rate).all() and np.isfinite(s)):
                return None
            left, right = equilibrated(np.abs(P) + abs(s) * np.abs(rate))
            scaled, slope = left[:, None] * P * right, left[:, None] * rate * right
            v = w / right
            v = v / np.linalg.norm(v)
            try:
                z = np.linalg.solve(scaled, slope @ v)
            except np.linalg.LinAlgError:
                return s, w, EPS
            if not np.isfinite(z).all():
                return s, w, EPS
            step = (v.conj() @ v) / (v.conj() @ z)
            s, w = complex(s - step), right * z / np.linalg.norm(z)
            if abs(step) <= 4 * EPS * abs(s) or (last <= 1e-9 * abs(s) and abs(step) >= last / 2):
                return s, w, self._error(s, w)
            last = float(abs(step))
        return (s, w, self._error(s, w)) if last <= 0.1 * abs(s) else None

    def _error(self, s: complex, w: ComplexArray) -> float:
        """Relative error of a root: rounding of all terms times the condition of the root."""
        P = self.at(s)
        left, right = equilibrated(np.abs(P) + abs(s) * np.abs(self.rate(s)))
        try:  # next to a root, one step of inverse iteration leaves the left vector alone
            y = left * np.linalg.solve((left[:, None] * P * right).conj().T, w.conj() / np.linalg.norm(w))
        except np.linalg.LinAlgError:
            return EPS
        slope = abs(y.conj() @ self.rate(s) @ w)
        rounding = np.abs(y) @ self.sizes(s) @ np.abs(w)
        return float(EPS * rounding / (slope * abs(s))) if slope and s else np.inf

    # --- counting ---------------------------------------------------------------------------------------------------

    def counts(self) -> tuple[int, int]:
        """How many roots there are without delays, and how many are zero, with multiplicity."""
        prime = next(primes())
        system, kinematics = self.assembly.system, self.assembly.kinematics
        index = {name: place for place, name in enumerate(kinematics.coordinates)}
        entries: dict[tuple[int, int], list[Fraction]] = {}

        def add(i: int, j: int, power: int, value: Fraction) -> None:
            held = entries.setdefault((i, j), [])
            held += [Fraction(0)] * (power + 1 - len(held))
            held[power] += value

        for law, row in zip(self.assembly.laws, self.assembly.exact_rows, strict=True):
            ours = {index[name]: value for name, value in row.items() if name in index}
            for power, value in enumerate((exact(law.stiffness), exact(law.damping), exact(law.inertia))):
                for i, a in ours.items() if value else ():
                    for j, b in ours.items():
                        add(i, j, power, value * a * b)
        degree = 2 * len(index)
        for place, action in enumerate(system.actions, len(index)):
            for name, value in action.row.items():
                if name in index:
                    add(index[name], place, 0, -value)
            for name, value in action.sensed.items():
                for power, factor in enumerate(action.numerator) if name in index else ():
                    add(place, index[name], power, -factor * value)
            for power, factor in enumerate(action.denominator):
                add(place, place, power, factor)
            degree += max(len(action.numerator), len(action.denominator)) - 1
        order, _ = least_fill(self.size, entries)
        residues = {place: [residue(value, prime) for value in values] for place, values in entries.items()}

        def value_at(point: int) -> int:
            rows: list[dict[int, int]] = [{} for _ in range(self.size)]
            for (i, j), values in residues.items():
                value = sum(factor * pow(point, power, prime) for power, factor in enumerate(values)) % prime
                if value:
                    rows[i][order[j]] = value
            return determinant(rows, prime)

        coefficients = interpolated([value_at(point) for point in range(degree + 1)], prime)
        zeros = next((power for power, value in enumerate(coefficients) if value), 0)
        return len(coefficients) - 1, zeros

    def within(self, radius: float) -> int | None:
        """How many roots lie within a circle around zero, by the turns of det P along it; None where one is on it."""
        first, n = self._phase(radius, 0.0), max(ON_CIRCLE, PER_ROOT * self.size)
        angles = np.linspace(0, np.pi, n + 1)  # conjugate roots: the lower half turns alike
        phases = [first, *(self._phase(radius, angle) for angle in angles[1:])]
        turned, places = 0.0, list(zip(angles.tolist(), phases, strict=True))
        stack = [(places[i], places[i + 1]) for i in range(n)]
        steps = 0
        while stack:
            (a, p), (b, q) = stack.pop()
            change = np.angle(q / p)
            middle = (a + b) / 2
            half = self._phase(radius, middle)
            one, two = np.angle(half / p), np.angle(q / half)
            if abs(one) < 0.8 and abs(two) < 0.8 and abs(one + two - change) < 1e-6:
                turned += float(change)
                continue
            steps += 1
            if steps > FINEST or not np.isfinite(turned):
                return None
            stack += [((a, p), (middle, half)), ((middle, half), (b, q))]
        count = turned / np.pi
        return round(count) if abs(count - round(count)) < 0.1 else None

    def _phase(self, radius: float, angle: float) -> complex:
        sign, _ = np.linalg.slogdet(self.at(complex(radius * np.exp(1j * angle))))
        return complex(sign)


def _derivative(coefficients: list[float]) -> list[float]:
    return [power * value for power, value in enumerate(coefficients)][1:]


def equilibrated(sizes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Factors of rows and of columns, powers of two, after which all of them are of size one."""
    left, right = np.ones(len(sizes)), np.ones(len(sizes))
    sizes = np.maximum(sizes, 1e-40 * sizes.max(initial=1e-200))
    for _ in range(3):
        now = left[:, None] * sizes * right
        left = left / np.sqrt(np.maximum(now.max(axis=1), 1e-300))
        right = right / np.sqrt(np.maximum(now.max(axis=0), 1e-300))
    return np.exp2(np.round(np.log2(left))), np.exp2(np.round(np.log2(right)))
