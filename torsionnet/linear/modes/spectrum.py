"""All nonzero eigenvalues in rad/s and shapes of a system with fixed coefficients, each with an error bound."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray, RowSystem
from torsionnet.linear.dynamic_stiffness.reduction import AnyArray, FirstOrder, Subspaces, first_order

if TYPE_CHECKING:
    from torsionnet.linear.modes.ehrlich_aberth import MatrixPolynomial

REFINE_ABOVE = 1e-10
"""Estimated relative error of an eigenvalue above which it is refined in mpmath, well below what results promise."""
POLISH_ABOVE = 1e-11
"""Residual torque of a shape, over the sum of magnitudes of its terms, above which the shape is recomputed in
mpmath."""
REAL_BELOW = 1e-13
"""Imaginary part of an eigenvalue, over its size, up to which it is real, since double precision cannot decide there.
Several equal ones may be calculated as pairs. Rounding splits a double root with one shape by the square root of its
size."""
MAX_OPERATIONS = 60_000
"""Most multiplications of one sparse elimination times roots to refine, about ten seconds of mpmath."""
_EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Spectrum:
    """Nonzero eigenvalues (n,) in rad/s and shapes (n_q, n) of a system with one set of stiffnesses, with errors.

    Attributes
    ----------
    values : (n,) complex array
        Nonzero eigenvalues lambda in rad/s, conjugates included; of an undamped system only those with Im > 0.
    shapes : (n_q, n) array
        Displacement shapes in q, any scale.
    errors : (n,) array
        Estimated relative error of each eigenvalue.
    undamped : bool
        Whether damping was left out, so that eigenvalues are imaginary.
    """

    values: ComplexArray
    shapes: AnyArray
    errors: FloatArray
    undamped: bool
    system: RowSystem
    spaces: Subspaces
    stiffness: AnyArray


@dataclass(frozen=True)
class Mode:
    """Eigenvalue in rad/s of one mode, with its shape (n_q,), relative error and convergence."""

    value: complex
    shape: ComplexArray
    error: float = 0.0
    converged: bool = True
    iterations: int = 1


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
            spectrum.shapes[:, kept].astype(complex),
            real,
            spectrum.errors[kept],
            np.ones(count, dtype=bool),
            np.ones(count, dtype=int),
        )

    @classmethod
    def of_modes(cls, modes: Sequence[Mode], n_q: int) -> Eigenpairs:
        """Eigenvalues (rad/s) and shapes over n_q coordinates of single modes."""
        values = np.array([mode.value for mode in modes], dtype=complex)
        return cls(
            values,
            np.array([mode.shape for mode in modes], dtype=complex).reshape(len(modes), n_q).T,
            values.imag == 0,
            np.array([mode.error for mode in modes], dtype=float),
            np.array([mode.converged for mode in modes], dtype=bool),
            np.array([mode.iterations for mode in modes], dtype=int),
        )


def solve_spectrum(system: RowSystem, spaces: Subspaces, stiffness: AnyArray, *, undamped: bool) -> Spectrum:
    """Nonzero eigenvalues (n,) in rad/s and shapes (n_q, n) of a system, in double precision, with errors.

    They come from singular values if undamped, else from eigenvalues of the first-order form.

    The error estimate of an eigenvalue is eps ||A|| / |lambda| times its condition number.
    """
    damping = np.zeros_like(system.damping) if undamped else system.damping
    form = first_order(system, spaces, stiffness, damping)
    # Undamped, A = [[0, -F^T], [F, 0]]: its eigenvalues are +-j times the singular values of F, each to its last digit.
    values, shapes, condition = _singular(form) if undamped else _standard(form)
    # First-order perturbation |d lambda| <= cond(lambda) ||dA||, with dA a few roundings of the largest entries.
    safety = 4.0 if not (spaces.damped.size or spaces.held.size) else 100.0
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        errors = safety * _EPS * form.size * condition / np.abs(values)
    errors = np.where(np.isfinite(errors), errors, np.inf)
    return Spectrum(values, shapes, errors, undamped, system, spaces, stiffness)


def _singular(form: FirstOrder) -> tuple[ComplexArray, AnyArray, FloatArray]:
    """Eigenvalues (n,) in rad/s, shapes (n_q, n), real for real stiffness, and condition numbers of the eigenvalues."""
    _, sigma, vt = np.linalg.svd(form.coupling, full_matrices=False)
    return 1j * sigma, form.recover[:, : vt.shape[1]] @ vt.T, np.ones(len(sigma))


def _standard(form: FirstOrder) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """Eigenvalues (n,) in rad/s, shapes (n_q, n) and condition numbers of the eigenvalues."""
    values, states = np.linalg.eig(form.matrix)
    basis, upper = states, np.flatnonzero(values.imag > 0)
    if np.isrealobj(form.matrix):  # conjugates are neighbours: their plane has a real basis, the two parts of a shape
        basis = states.real.copy()
        basis[:, upper + 1] = states.imag[:, upper]
    try:
        condition = np.linalg.norm(np.linalg.inv(basis), axis=1)
    except np.linalg.LinAlgError:  # exactly defective, as critical damping can be
        condition = np.full(len(values), np.inf)
    if basis is not states:  # the row to x + jy is that to x less j times that to y, halved
        condition[upper] = condition[upper + 1] = np.hypot(condition[upper], condition[upper + 1]) / 2
    return values.astype(complex), _real_times(form.recover, states), condition


def _real_times(matrix: AnyArray, vectors: AnyArray) -> ComplexArray:
    """Product of a matrix, mostly real, with complex vectors, whose parts are then columns of one real product."""
    vectors = np.ascontiguousarray(vectors, dtype=complex)
    if np.iscomplexobj(matrix):
        return np.asarray(matrix @ vectors)
    return np.asarray((matrix @ vectors.view(float)).view(complex))


def refined_spectrum(spectrum: Spectrum, wanted: NDArray[np.bool_] | None = None) -> Spectrum:
    """Eigenvalues and shapes with the uncertain ones of the wanted solved in mpmath, as far as work allows."""
    squared = spectrum.undamped
    # det(lambda^2 M + lambda C + K) = 0 over exact rows; undamped in lambda^2, which halves the degree.
    starts, coefficients = _polynomial_problem(spectrum)
    wanted = np.ones(len(starts), dtype=bool) if wanted is None else wanted
    chosen = wanted & (spectrum.errors > REFINE_ABOVE)
    blurred = wanted & (_residuals(spectrum, starts, coefficients) > POLISH_ABOVE)
    if not np.any(chosen | blurred):
        return spectrum
    import torsionnet.linear.modes.ehrlich_aberth as ehrlich_aberth

    # Isolated roots first, each by itself; what is left in clusters needs all roots at once (Ehrlich-Aberth).
    p = ehrlich_aberth.polynomial(spectrum.system.law_rows, coefficients)
    limit = MAX_OPERATIONS // max(p.operations, 1)
    chosen = most_uncertain(chosen, spectrum.errors, limit)
    spectrum, settled = _with_isolated_roots(spectrum, p, np.flatnonzero(chosen | blurred)[:limit])
    chosen, blurred = chosen & ~settled, blurred & ~settled
    if not np.any(chosen | blurred):
        return spectrum
    starts, _ = _polynomial_problem(spectrum)
    zeros = spectrum.spaces.rigid.shape[1] + (0 if squared else spectrum.spaces.undamped_rigid)
    roots, done = ehrlich_aberth.refine_roots(p, starts, chosen, zeros, spectrum.errors)
    values = np.where(chosen, ehrlich_aberth.to_complex(roots, square_root=squared), spectrum.values)
    errors = np.where(chosen, ehrlich_aberth.CONVERGED, spectrum.errors)
    if not (done and (squared or np.iscomplexobj(spectrum.stiffness) or not np.all(wanted) or has_pairs(values))):
        return spectrum
    shapes = spectrum.shapes.astype(complex)
    for j in np.flatnonzero(chosen | blurred)[:limit]:
        shapes[:, j] = ehrlich_aberth.refine_vector(p, roots[j], shapes[:, j])
    return replace(spectrum, values=values, shapes=shapes, errors=errors)


def _with_isolated_roots(
    spectrum: Spectrum, p: MatrixPolynomial, some: NDArray[np.intp]
) -> tuple[Spectrum, NDArray[np.bool_]]:
    """Spectrum with isolated ones of ``some`` eigenvalues exact to double precision, and mask (n,) of these."""
    from torsionnet.linear.modes.ehrlich_aberth import CONVERGED, isolated_root, isolation_radii, to_complex

    starts, _ = _polynomial_problem(spectrum)
    space = isolation_radii(starts, spectrum.errors)
    values, shapes, errors = spectrum.values.copy(), spectrum.shapes.astype(complex), spectrum.errors.copy()
    settled = np.zeros(len(starts), dtype=bool)
    # With real coefficients the root below the real axis is the conjugate of the one just before it.
    conjugates = not (spectrum.undamped or np.iscomplexobj(spectrum.stiffness))
    for j in some:
        if conjugates and values[j].imag < 0 and settled[j - 1]:
            values[j], shapes[:, j], errors[j], settled[j] = (
                values[j - 1].conj(),
                shapes[:, j - 1].conj(),
                CONVERGED,
                True,
            )
        elif space[j] and (met := isolated_root(p, starts[j].item(), shapes[:, j], space[j])) is not None:
            values[j], shapes[:, j] = to_complex([met[0]], square_root=spectrum.undamped)[0], met[1]
            errors[j], settled[j] = CONVERGED, True
    return replace(spectrum, values=values, shapes=shapes, errors=errors), settled


def has_pairs(values: ComplexArray) -> bool:
    """Whether as many eigenvalues lie above the real axis as below, as those of a real system do."""
    sides = np.sign(values.imag)[~on_real_axis(values)]
    return bool(np.sum(sides) == 0)


def on_real_axis(values: ComplexArray) -> NDArray[np.bool_]:
    """Mask (n,) of the eigenvalues that are real within rounding."""
    return np.asarray(np.abs(values.imag) <= REAL_BELOW * np.abs(values))


def _polynomial_problem(spectrum: Spectrum) -> tuple[AnyArray, list[AnyArray]]:
    """Roots z and coefficients (n_laws,) of laws, z = lambda with (k, c, J), or omega^2 with (k, -J) undamped."""
    system = spectrum.system
    if spectrum.undamped:
        return spectrum.values.imag**2, [spectrum.stiffness, -system.inertia]
    return spectrum.values, [spectrum.stiffness, system.damping, system.inertia]


def _residuals(spectrum: Spectrum, z: AnyArray, coefficients: list[AnyArray]) -> FloatArray:
    """Residual torque |D q| (n,) of each shape, over the sum of the magnitudes of its terms."""
    rows, sizes, shapes = spectrum.system.rows, np.abs(spectrum.system.rows), spectrum.shapes
    # Conjugates, which are neighbours, leave the same: the second of each two waits.
    second = np.zeros(len(z), dtype=bool)
    if not (spectrum.undamped or np.iscomplexobj(spectrum.stiffness)):
        second[1:] = z[:-1].conj() == z[1:]
        second &= z.imag < 0
        z, shapes = z[~second], shapes[:, ~second]
    powers = [z**d for d in range(len(coefficients))]
    laws = sum(np.multiply.outer(c, power) for c, power in zip(coefficients, powers, strict=True))
    terms = sum(np.multiply.outer(np.abs(c), np.abs(power)) for c, power in zip(coefficients, powers, strict=True))
    left = np.linalg.norm(_real_times(rows.T, laws * _real_times(rows, shapes)), axis=0)
    scale = np.linalg.norm(sizes.T @ (terms * (sizes @ np.abs(shapes))), axis=0)
    return np.asarray((left / np.where(scale > 0, scale, 1.0))[np.cumsum(~second) - 1])


def most_uncertain(chosen: NDArray[np.bool_], errors: FloatArray, count: int) -> NDArray[np.bool_]:
    """Mask (n,) of the ``count`` most uncertain of the chosen eigenvalues.

    Eigenvalues with equal errors, as conjugates, go together.
    """
    if np.count_nonzero(chosen) <= count:
        return chosen
    limit = np.sort(errors[chosen])[::-1][count] if count else np.inf
    return np.asarray(chosen & (errors > limit))


def one_per_pair(spectrum: Spectrum) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Indices of one eigenvalue per conjugate pair and of every real one, and mask of the real ones among them."""
    real = on_real_axis(spectrum.values)
    kept = np.flatnonzero(real | (spectrum.values.imag > 0))
    return kept, np.asarray(real[kept])
