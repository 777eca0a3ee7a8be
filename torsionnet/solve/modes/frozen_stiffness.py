"""Modes with frequency-dependent stiffness, which is frozen at the frequency of the mode, solved, and repeated.

Frozen at the frequency of the mode, solved, and repeated.

Each mode is a fixed point omega = |Im lambda(omega)| of the eigenvalue problem with kappa frozen at omega.
The mode is followed from one problem to the next by the modal assurance criterion of the inertia-weighted shapes,
and the fixed point is approached by secant steps.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.rows import ComplexArray, FloatArray, RowSystem
from torsionnet.core.errors import SolveError
from torsionnet.solve.dynamic_stiffness.reduction import AnyArray, Subspaces
from torsionnet.solve.modes.spectrum import Spectrum, one_per_pair, refined_spectrum, solve_spectrum

FREQUENCY_TOLERANCE = 1e-12
"""Relative change of the frequency of a mode at which the iteration over its frozen stiffness has converged."""
REFINED_BELOW = 1e-6
"""Relative change of a mode's frequency, or error of its eigenvalue if larger, below which the eigenvalue is refined in
many digits."""
MAX_ITERATIONS = 60
"""Most eigenvalue problems for a mode, as secant steps converge in a few unless the frequency jumps."""
SAME_EIGENVALUE = 1e-8
"""Relative difference below which eigenvalues are one multiple eigenvalue, or one mode found twice."""
LEAST_SLOPE = 0.05
"""Least slope, downwards, of (frequency found - frequency assumed) for a secant step, since flatter ones lead too
far."""

Start: TypeAlias = tuple[float, ComplexArray]
"""Frequency in rad/s and shape (n_q,) from which a mode is tracked."""


@dataclass(frozen=True)
class Eigenpairs:
    """Nonzero eigenvalues (n,) in rad/s, one per conjugate pair, with shapes (n_q, n), errors and convergence."""

    values: ComplexArray
    shapes: ComplexArray
    real: NDArray[np.bool_]
    errors: FloatArray
    converged: NDArray[np.bool_]
    iterations: NDArray[np.int_]

    @classmethod
    def all_converged(cls, spectrum: Spectrum, kept: NDArray[np.intp], real: NDArray[np.bool_]) -> Eigenpairs:
        """Eigenvalues (rad/s) and shapes of a spectrum at the indices ``kept``, all marked as converged."""
        count = len(kept)
        return cls(
            spectrum.values[kept],
            spectrum.shapes[:, kept],
            real,
            spectrum.errors[kept],
            np.ones(count, dtype=bool),
            np.ones(count, dtype=int),
        )


@dataclass(frozen=True)
class Mode:
    """Eigenvalue in rad/s of one mode, with its shape (n_q,), relative error and convergence."""

    value: complex
    shape: ComplexArray
    error: float = 0.0
    converged: bool = True
    iterations: int = 1


@dataclass(frozen=True)
class FrozenProblem:
    """Eigenvalue problem of a system with frequency-dependent stiffness frozen at a frequency. Solutions are kept."""

    system: RowSystem
    spaces: Subspaces
    undamped: bool
    known: dict[bytes, Spectrum] = field(default_factory=dict)

    def stiffness(self, omega: float) -> AnyArray:
        """Stiffness (n_laws,) of all laws in N m/rad at omega in rad/s, real where there are no losses."""
        total = self.system.stiffness + self.system.kappa(omega)
        if not np.all(np.isfinite(total)):
            raise SolveError(
                f"a frequency-dependent stiffness is not finite at {omega:.6g} rad/s; correct its values there"
            )
        if self.undamped and np.any(total.real[self.spaces.springs] <= 0):
            text = f"a frequency-dependent stiffness has no positive real part at {omega:.6g} rad/s"
            raise SolveError(f"{text}; correct its values there")
        lossless = self.undamped or not np.any(total.imag)
        return np.asarray(total.real) if lossless else np.asarray(total)

    def at(self, omega: float) -> Spectrum:
        """Eigenvalues in rad/s and shapes with stiffness frozen at omega in rad/s.

        Equal stiffnesses are solved only once.
        """
        stiffness = self.stiffness(omega)
        key = stiffness.tobytes()
        if key not in self.known:
            no_loss = self.undamped or not (np.iscomplexobj(stiffness) or np.any(self.system.damping))
            self.known[key] = solve_spectrum(self.system, self.spaces, stiffness, undamped=no_loss)
        return self.known[key]

    def resemblance(self, shapes: ComplexArray, shape: ComplexArray) -> FloatArray:
        """Modal assurance criterion (n,), weighted with inertia, of each of n shapes with one shape.

        It is |a^H M b|^2 / (a^H M a  b^H M b).
        """
        heavy = self.system.inertia > 0
        weighted = np.sqrt(self.system.inertia[heavy])[:, None] * self.system.rows[heavy]
        a, b = weighted @ shapes, weighted @ shape
        size = np.sum(np.abs(a) ** 2, axis=0) * np.sum(np.abs(b) ** 2)
        return np.asarray(np.abs(a.conj().T @ b) ** 2 / np.where(size > 0, size, 1.0))


def modes(
    system: RowSystem, spaces: Subspaces, starts: Iterable[Start] | None = None, *, undamped: bool = False
) -> Eigenpairs:
    """Eigenvalues in rad/s and shapes of all nonzero modes of a system with frequency-dependent stiffness.

    Real poles are those of the stiffness at rest, Re kappa(0+); other modes are oscillatory. Each is tracked from a
    start (frequency, shape), by default the undamped modes at rest, and where two starts lead to one mode, from the
    other eigenvalues of the problems solved.
    """
    problem = FrozenProblem(system, spaces, undamped)
    rest = _at_rest(system, spaces, undamped=undamped)
    real = [] if undamped else _real_poles(rest)
    count = len(rest.values) if rest.undamped else (len(rest.values) - len(real)) // 2
    found: list[Mode] = []
    for omega, shape in _all_starts(problem, _own_starts(rest) if starts is None else starts, count):
        if len(found) >= count:
            break
        group = _track(problem, omega, shape, count)
        if group and not any(
            abs(group[0].value - other.value) <= SAME_EIGENVALUE * abs(other.value) for other in found
        ):
            found.extend(group)
    return _collect(found[:count], real, system.n_coordinates)


def _at_rest(system: RowSystem, spaces: Subspaces, *, undamped: bool) -> Spectrum:
    stiffness = FrozenProblem(system, spaces, undamped=True).stiffness(0.0)
    return refined_spectrum(solve_spectrum(system, spaces, stiffness, undamped=undamped or not np.any(system.damping)))


def _real_poles(rest: Spectrum) -> list[Mode]:
    kept, real = one_per_pair(rest)
    return [Mode(complex(rest.values[j]), rest.shapes[:, j], float(rest.errors[j])) for j in kept[real]]


def _own_starts(rest: Spectrum) -> list[Start]:
    order = np.argsort(rest.values.imag)
    return [(float(rest.values[j].imag), rest.shapes[:, j]) for j in order]


def _all_starts(problem: FrozenProblem, starts: Iterable[Start], count: int) -> Iterator[Start]:
    yield from starts
    for spectrum in list(problem.known.values()):
        yield from ((float(spectrum.values[j].imag), spectrum.shapes[:, j]) for j in _candidates(spectrum, count))


def _candidates(spectrum: Spectrum, count: int) -> NDArray[np.intp]:
    """Indices of the ``count`` least damped eigenvalues with Im > 0, by rising damping.

    A real pole leaves the real axis under a complex stiffness; the count keeps it out.
    """
    values = spectrum.values
    upper = np.flatnonzero(values.imag > 0)
    least_damped = np.argsort(-values[upper].imag / np.abs(values[upper]), kind="stable")
    return np.asarray(upper[least_damped[:count]])


def _track(problem: FrozenProblem, omega: float, shape: ComplexArray, count: int) -> list[Mode]:
    """Mode whose stiffness is frozen at its own frequency, found from a start, or several of equal frequency.

    Its frequency is the fixed point of omega = |Im lambda(omega)|.
    """
    last: tuple[float, float] | None = None
    group: list[Mode] = []
    for iteration in range(1, MAX_ITERATIONS + 1):
        spectrum = problem.at(omega)
        candidates = _candidates(spectrum, count)
        if not len(candidates):
            return []
        nearest = candidates[np.argmax(problem.resemblance(spectrum.shapes[:, candidates], shape))]
        rough = float(spectrum.values[nearest].imag)
        if abs(rough - omega) <= max(REFINED_BELOW, float(spectrum.errors[nearest])) * rough:
            spectrum = refined_spectrum(spectrum, np.arange(len(spectrum.values)) == nearest)
        shape, found = spectrum.shapes[:, nearest], float(spectrum.values[nearest].imag)
        converged = abs(found - omega) <= FREQUENCY_TOLERANCE * found
        group = _group(spectrum, candidates, nearest, converged=converged, iterations=iteration)
        if converged:
            break
        last, omega = (omega, found - omega), _next_frequency(omega, found, last)
    return group


def _next_frequency(omega: float, found: float, last: tuple[float, float] | None) -> float:
    """Frequency in rad/s to freeze the stiffness at next, by a secant step where safe, else ``found`` itself."""
    if last is None or last[0] == omega:
        return found
    slope = (found - omega - last[1]) / (omega - last[0])
    trial = omega - (found - omega) / slope if slope < -LEAST_SLOPE else found
    return trial if omega / 2 < trial < 2 * omega else found


def _group(
    spectrum: Spectrum, candidates: NDArray[np.intp], nearest: np.intp, *, converged: bool, iterations: int
) -> list[Mode]:
    value = spectrum.values[nearest]
    close = [j for j in candidates if j != nearest and abs(spectrum.values[j] - value) <= SAME_EIGENVALUE * abs(value)]
    return [
        Mode(complex(spectrum.values[j]), spectrum.shapes[:, j], float(spectrum.errors[j]), converged, iterations)
        for j in (nearest, *close)
    ]


def _collect(oscillatory: list[Mode], real: list[Mode], n_q: int) -> Eigenpairs:
    every = [*oscillatory, *real]
    return Eigenpairs(
        np.array([mode.value for mode in every], dtype=complex),
        np.array([mode.shape for mode in every], dtype=complex).reshape(len(every), n_q).T,
        np.arange(len(every)) >= len(oscillatory),
        np.array([mode.error for mode in every], dtype=float),
        np.array([mode.converged for mode in every], dtype=bool),
        np.array([mode.iterations for mode in every], dtype=int),
    )
