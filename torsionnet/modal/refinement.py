"""Refinement of poles by least weighted squares of the transfer functions themselves, with standard errors.

The linear fits minimise squares of an equation, which noise biases. Here the squares of ``H - model`` are minimised
over the poles, with the residues eliminated (variable projection; Golub and Pereyra 1973, Kaufman 1975). An
oscillatory mode is ``s^2 + b s + c``: as b grows it becomes two real poles without a step.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from torsionnet.modal.projection import Projection, coefficients_of
from torsionnet.modal.settings import Settings
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray, Lines

SMALLEST_VALUE = 1e-12
"""Least coefficient, and least residual over the response, that is assumed, as their logarithm and inverse are
needed."""
LARGEST_CORRELATION = 0.95
"""Largest correlation of residuals at neighbouring lines that is assumed, as at 1 standard errors would be infinite."""
NOISE_SHARE, FEWEST_NEIGHBOURS, MOST_NEIGHBOURS = 40, 10, 100
"""Share of the lines of a record (1/40), with limits, that the noise at each line is the mean of on either side."""
INPUT_SHARES = np.logspace(0, 8, 17)
"""Noise that comes from the input over that of the output, at the largest response, that are tried."""
CLEAR_LIKELIHOOD = 5.0
"""Gain of the logarithm of the likelihood from which noise is put on the input."""
ROUNDS = 2
"""Number of fits in a refinement, the second with weights from the residuals of the first, as more change them
little."""


@dataclass(frozen=True, eq=False)
class RefinedPoles:
    """Refined poles in rad/s, sorted by magnitude, with standard errors of natural frequency and damping ratio.

    Attributes
    ----------
    poles : (n,) complex array
        rad/s.
    frequency_errors, damping_errors : (n,) arrays
        Standard errors of the natural frequency in Hz and of the damping ratio.
    converged : bool
    problem : Projection
        Problem of the last round, over lines whose s is divided by the highest.
    logarithms : (n_coefficients,) array
        Its solution.
    """

    poles: ComplexArray
    frequency_errors: FloatArray
    damping_errors: FloatArray
    converged: bool
    problem: Projection
    logarithms: FloatArray


def refine(lines: Lines, poles: ComplexArray, settings: Settings) -> RefinedPoles:
    """Refined poles (rad/s) and standard errors from stable start poles, with weights from the residuals."""
    scale = float(np.abs(lines.s).max())
    scaled = replace(lines, s=lines.s / scale)
    sizes, start = factors_of(poles / scale)
    for _ in range(ROUNDS):
        problem = Projection(scaled, sizes, settings)
        logarithms, converged = minimised(problem, start)
        start = coefficients_of(logarithms)
        left = problem.complex_residuals(logarithms)
        scaled = reweighted(problem, logarithms)
    covariance = _covariance(Projection(scaled, sizes, settings), logarithms, left)
    roots, slopes = roots_of(sizes, start)
    frequency, damping = _errors(roots, slopes, covariance)
    order = np.argsort(np.abs(roots), kind="stable")
    per_turn = scale / (2 * np.pi)
    return RefinedPoles(
        roots[order] * scale, frequency[order] * per_turn, damping[order], converged, problem, logarithms
    )


def minimised(problem: Projection, start: FloatArray, exact: float = 1e-14) -> tuple[FloatArray, bool]:
    """Logarithms of the denominator's coefficients at the least squares near start coefficients, and success."""
    import scipy.optimize

    found = scipy.optimize.least_squares(
        problem.residuals,
        np.log(np.maximum(start, SMALLEST_VALUE)),
        problem.jacobian,
        method="lm",
        xtol=10 * exact,
        ftol=exact,
        gtol=exact,
    )
    return found.x, bool(found.status > 0)


def factors_of(poles: ComplexArray) -> tuple[tuple[int, ...], FloatArray]:
    """Degrees of the denominator's factors for given poles, and the coefficients of all factors in a row.

    Coefficients are (b, c) of s^2 + b s + c for a conjugate pair or two real poles, (a,) of s + a for a last real pole.
    """
    factors: list[tuple[float, ...]] = [(-2 * pole.real, abs(pole) ** 2) for pole in poles if pole.imag != 0]
    real = sorted(-pole.real for pole in poles if pole.imag == 0)
    factors += [(a + b, a * b) for a, b in zip(real[::2], real[1::2], strict=False)]
    if len(real) % 2:
        factors.append((real[-1],))
    return tuple(len(factor) for factor in factors), np.array([value for factor in factors for value in factor])


def roots_of(sizes: tuple[int, ...], coefficients: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Roots (n,) of a product of polynomials, one of each pair, and derivatives to the logarithms of coefficients."""
    poles: list[complex] = []
    slopes: list[ComplexArray] = []
    place = 0
    for size in sizes:
        own = slice(place, place + size)
        for root in np.roots([1.0, *coefficients[own]]).astype(complex):
            if root.imag >= 0:
                slope = np.zeros(len(coefficients), dtype=complex)
                inner = 2 * root + coefficients[place] if size > 1 else 1.0
                slope[own] = -np.array([root, 1.0])[-size:] / inner * coefficients[own]
                poles.append(root)
                slopes.append(slope)
        place += size
    return np.array(poles, dtype=complex), np.array(slopes).reshape(len(poles), len(coefficients))


def reweighted(problem: Projection, logarithms: FloatArray) -> Lines:
    """Copy of the lines with weights that give the residuals of each transfer function a mean square of 1.

    The lines of a record are many: there the mean is over the neighbours of each line, and noise may have any colour.
    """
    lines, left = problem.lines, problem.complex_residuals(logarithms)
    squares = np.abs(left) ** 2
    if lines.drive is None:
        size = np.sqrt(np.mean(squares, axis=0))
    else:
        passed = np.abs(problem.responses(logarithms) * lines.weights) ** 2
        size = np.empty(left.shape)
        for place in np.ndindex(*left.shape[1:]):
            at = (slice(None), *place)
            size[at] = np.sqrt(_variance(squares[at], passed[at]))
    floor = SMALLEST_VALUE * np.sqrt(np.mean(np.abs(lines.weights * lines.values) ** 2, axis=0))
    return replace(lines, weights=lines.weights / np.maximum(size, floor))


def _variance(squares: FloatArray, passed: FloatArray) -> FloatArray:
    """Variance of the noise at each line of a record from squares of residuals, the mean over its neighbours, (n_f,).

    Noise on the input is as large as the squares of the response, ``passed``, and differs much between neighbours at a
    narrow peak: its share is the most likely one.
    """
    reach = int(np.clip(len(squares) / NOISE_SHARE, FEWEST_NEIGHBOURS, MOST_NEIGHBOURS))
    around = np.ones(2 * reach + 1)
    counts = np.convolve(np.ones(len(squares)), around, "same")
    tiny = np.finfo(float).tiny
    shapes = [np.ones(len(squares)), *(1 + share * passed / max(passed.max(), tiny) for share in INPUT_SHARES)]
    variances: list[FloatArray] = [shape * np.convolve(squares / shape, around, "same") / counts for shape in shapes]
    unlikely = [float(np.sum(np.log(each + tiny) + squares / (each + tiny))) for each in variances]
    place = int(np.argmin(unlikely))
    return variances[place if unlikely[place] < unlikely[0] - CLEAR_LIKELIHOOD else 0]


def _covariance(problem: Projection, point: FloatArray, left: ComplexArray) -> FloatArray:
    """Covariance of the coefficients' logarithms, enlarged where residuals of neighbouring lines correlate."""
    slopes = problem.jacobian(point)
    normal = slopes.T @ slopes
    along = np.sum(left[1:] * left[:-1].conj()).real / max(float(np.sum(np.abs(left) ** 2)), np.finfo(float).tiny)
    correlation = float(np.clip(along, 0, LARGEST_CORRELATION))
    over = problem.residuals(point)
    variance = float(over @ over) / max(1, len(over) - problem.unknowns)
    return np.asarray(np.linalg.pinv(normal, hermitian=True) * variance * (1 + correlation) / (1 - correlation))


def _errors(poles: ComplexArray, slopes: ComplexArray, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Standard errors of ``|lambda|`` and of the damping ratio of each pole, each (n,), from the covariance."""
    size = np.abs(poles)[:, None]
    along = (poles.conj()[:, None] * slopes).real / size
    damping = -slopes.real / size + poles.real[:, None] * along / size**2
    first, second = (
        np.sqrt(np.maximum(np.einsum("np,pq,nq->n", part, covariance, part), 0)) for part in (along, damping)
    )
    return first, second
