"""A quotient of polynomials through all transfer functions of one test, with one denominator.

The right matrix fraction ``H = s^p B A^-1 / s^q`` is linear in A and B once multiplied by A. B belongs to one
output each and is eliminated there by a QR decomposition; what is left decides on A, whose roots are the poles.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from torsionnet.modal.lines import ComplexArray, FloatArray, Lines
from torsionnet.modal.poles import cleaned, upper_half
from torsionnet.modal.polynomials import Family, orthogonal, powers, roots
from torsionnet.modal.settings import Settings

MOST_ROUNDS = 20
SETTLED = 1e-9
NEAR_NYQUIST = 0.999


def poles_of_order(lines: Lines, order: int, settings: Settings) -> tuple[ComplexArray, ComplexArray]:
    """Stable poles of a fit of one order, and how they take part in the inputs.

    Returns
    -------
    poles : (n,) complex array
        rad/s, one of each conjugate pair.
    participations : (n, n_in) complex array
    """
    found, rows = (_rational if settings.method == "rational" else _lscf)(lines, order, settings)
    found = cleaned(found)
    kept = [place for place in upper_half(found) if found[place].real < 0]
    return found[kept], rows[kept]


def largest_order(lines: Lines, settings: Settings) -> int:
    """Order at which the unknowns of one output become as many as its equations."""
    extra = 1 + 2 * settings.has_lower
    inputs = lines.values.shape[2]
    return max(0, (2 * len(lines.s) - extra - inputs) // (1 + inputs) - 1)


def _rational(lines: Lines, order: int, settings: Settings) -> tuple[ComplexArray, ComplexArray]:
    """Polynomials in s, solved with the denominator before as weight until it stays (Sanathanan and Koerner 1963)."""
    scale = np.abs(lines.s).max()
    s = lines.s / scale
    below = 2 if settings.has_lower else 0
    numerator = max(order - (not settings.has_upper), 0) + below
    inputs = lines.values.shape[2]
    denominator, before = np.ones(len(s)), None
    for _ in range(MOST_ROUNDS):
        family = orthogonal(s, 1 / denominator, order)
        rest = []
        for receptance, weight in _outputs(lines):
            size = weight / denominator
            above = orthogonal(s, size * np.abs(s) ** -below, numerator).values * s[:, None] ** -below
            rest.append(_eliminated(size[:, None] * above, size, receptance, family))
        *_, right = np.linalg.svd(np.vstack(rest))
        coefficients = right[-inputs:].T.reshape(order + 1, inputs, inputs)
        found, rows = roots(coefficients, family)
        matrix = np.tensordot(family.values, coefficients, axes=1)
        denominator = np.abs(np.linalg.det(matrix)) ** (1 / inputs)
        denominator = np.maximum(denominator, 1e-12 * denominator.max())
        now = np.sort_complex(found)
        if before is not None and np.allclose(now, before, rtol=SETTLED, atol=0):
            break
        before = now
    return found * scale, rows


def _lscf(lines: Lines, order: int, settings: Settings) -> tuple[ComplexArray, ComplexArray]:
    """Polynomials in z with the lowest coefficient 1, which keeps most computational poles unstable.

    Guillaume, Verboven et al., A poly-reference implementation of the least-squares complex frequency-domain estimator
    (IMAC 2003); Cauberghe (2004) on the constraint.
    """
    del settings
    interval = np.pi / np.abs(lines.s).max()
    family = powers(np.exp(lines.s * interval), order)
    inputs = lines.values.shape[2]
    rest = np.vstack(
        [
            _eliminated(weight[:, None] * family.values, weight, values, family)
            for values, weight in _outputs(lines, measured=True)
        ]
    )
    solved = np.linalg.lstsq(rest[:, inputs:], -rest[:, :inputs])[0]
    coefficients = np.vstack([np.eye(inputs), solved]).reshape(order + 1, inputs, inputs)
    found, rows = roots(coefficients, family)
    with np.errstate(divide="ignore"):
        poles = np.log(found) / interval
    inside = np.isfinite(poles) & (np.abs(poles.imag) < NEAR_NYQUIST * np.pi / interval) & (poles != 0)
    return poles[inside], rows[inside]


def _outputs(lines: Lines, *, measured: bool = False) -> Iterator[tuple[ComplexArray, FloatArray]]:
    """Transfer functions of one output, (n_f, n_in), in the form of receptances, with the weights of their lines."""
    for o, power in enumerate(lines.powers):
        factor = np.ones((len(lines.s), len(power))) if measured else lines.s[:, None] ** power
        weights = lines.weights[:, o] * np.abs(factor)
        yield lines.values[:, o] / factor, np.sqrt(np.mean(weights**2, axis=1))


def _eliminated(numerator: ComplexArray, weight: FloatArray, values: ComplexArray, family: Family) -> FloatArray:
    """Equations in the denominator alone, columns by degree and then input."""
    weighted = weight[:, None] * values
    denominator = -(family.values[:, :, None] * weighted[:, None, :]).reshape(len(weight), -1)
    both = np.hstack([numerator, denominator])
    triangle = np.linalg.qr(np.vstack([both.real, both.imag]), mode="r")
    return np.asarray(triangle[numerator.shape[1] :, numerator.shape[1] :])
