"""Rayleigh quotient iteration in many digits, for an eigenvalue that is isolated from all others.

    q <- P(z)^-1 P'(z) q,    then the root z of q^T P(z) q next to the last one

P is symmetric, so an error of q enters z squared, and next to the solution the error of a step is the third power of
that before (K. Schreiber, "Nonlinear eigenvalue problems: Newton-type methods and nonlinear Rayleigh functionals",
thesis, TU Berlin 2008). Two eliminations are enough where simultaneous iteration takes eight; but two starts
may run to one root, so that this is for isolated roots only.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.reduction import AnyArray
from torsionnet.linear.modes.ehrlich_aberth import CONVERGED, DIGITS, MatrixPolynomial, eliminate, size_of

ISOLATION = 1e3
"""Least distance of an isolated root from every other root, zero included, in uncertainties of either, so that the
others do not disturb it."""
MOST_STEPS = 6
"""Most steps of the iteration for an isolated root, since each triples the number of right digits and more mean a wrong
start."""


def isolation_radii(roots: AnyArray, errors: FloatArray) -> FloatArray:
    """Radius (n,) in rad/s around each root that certainly holds no other, 0 where the root is too uncertain.

    That is where its uncertainty is near the distance.

    Parameters
    ----------
    roots : (n,) array
        All nonzero roots.
    errors : (n,) array
        Relative errors of the roots.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        blur = np.nan_to_num(ISOLATION * np.abs(roots) * errors, nan=np.inf)
        between = np.abs(np.subtract.outer(roots, roots)) - blur
    np.fill_diagonal(between, np.inf)
    space = np.minimum(between.min(axis=1, initial=np.inf), np.abs(roots))
    return np.where(space > blur, space, 0.0)


def isolated_root(
    p: MatrixPolynomial, start: complex, shape: ComplexArray, space: float
) -> tuple[Any, ComplexArray] | None:
    """Root of det P, as an mpmath number, near a start and alone within ``space``, and its shape (n,), or None.

    It is None where not reached. P is symmetric.
    """
    import mpmath

    with mpmath.workdps(DIGITS):
        z = first = mpmath.mpmathify(start)
        vector: list[Any] = [mpmath.mpmathify(shape[j].item()) for j in np.argsort(p.place)]
        for _ in range(MOST_STEPS):
            _, found = eliminate(p.at(z), p.slope(z, vector))
            largest = max(found, key=size_of, default=None)
            if not largest:
                return None
            vector = [value / largest for value in found]
            last, z = z, _quotient(p, vector, z)
            if z is None or size_of(z - first) > space / 3:
                return None
            if size_of(z - last) <= CONVERGED * size_of(z):
                return z, np.array([complex(vector[j]) for j in p.place])
    return None


def _quotient(p: MatrixPolynomial, vector: list[Any], z: Any) -> Any:
    """Root of q^T P(z) q next to z by Newton's iteration, as an mpmath number, or None without convergence."""
    powers: list[Any] = [0] * max(len(coefficients) for _, _, coefficients in p.entries)
    for i, j, coefficients in p.entries:
        product = vector[i] * vector[j]
        for d, value in enumerate(coefficients):
            powers[d] += value * product
    for _ in range(MOST_STEPS):
        slope = sum(d * value * z ** (d - 1) for d, value in enumerate(powers) if d)
        if not slope:
            return None
        step = sum(value * z**d for d, value in enumerate(powers)) / slope
        z = z - step
        if size_of(step) <= CONVERGED * size_of(z):
            return z
    return None
