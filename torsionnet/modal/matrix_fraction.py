"""Poles by matrix fraction, a quotient of polynomials that is fitted to all transfer functions of a test.

The right matrix fraction ``H = s^p B A^-1 / s^q`` is linear in A and B once multiplied by A. The rows of B
belong to one output each and are eliminated by QR decompositions; the equations left define A, whose roots are the
poles.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from torsionnet.modal.poles import upper_half, without_rounding
from torsionnet.modal.polynomials import Family, orthogonal, powers, roots
from torsionnet.modal.settings import Settings
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray, Lines

MOST_ROUNDS = 20
"""Largest number of rounds in which a fit is reweighted, as poles of noise may never converge."""
POLE_CONVERGENCE = 1e-9
"""Relative change of all poles below which the reweighting of a fit ends, small against any standard error."""
START_CONVERGENCE = 1e-3
"""Relative change of all poles below which that of a record ends, as they are only the start of a refinement."""
TRANSIENT_DEGREES = 3
"""Degrees of the polynomial of a record's transients above those of the denominator, from 1/s^2 on."""
SMALLEST_DENOMINATOR = 1e-12
"""Least size of the denominator over its largest that weights assume, as poles on the imaginary axis would divide by
0."""
NYQUIST_MARGIN = 0.999
"""Frequency of a pole over that of the highest line above which the pole is an artefact of the fold at z = -1."""


def poles_of_orders(lines: Lines, highest: int, settings: Settings) -> Iterator[tuple[ComplexArray, ComplexArray]]:
    """Yield the stable poles (rad/s) and their participations of the inputs, of fits of order 1, 2, 3 and so on.

    Yields
    ------
    poles : (n,) complex array
        rad/s, one of each conjugate pair.
    participations : (n, n_in) complex array
    """
    for found, rows in (_rational if settings.method == "rational" else _lscf)(lines, highest, settings):
        roots = without_rounding(found)
        kept = [place for place in upper_half(roots) if roots[place].real < 0]
        yield roots[kept], rows[kept]


def largest_order(lines: Lines, settings: Settings) -> int:
    """Highest order at which a fit has no more unknowns than equations for each output."""
    extra = 1 + 2 * settings.has_lower
    inputs = lines.values.shape[2]
    return int(max(0, (2 * len(lines.s) - extra - inputs) // (1 + inputs) - 1))


def _rational(lines: Lines, highest: int, settings: Settings) -> Iterator[tuple[ComplexArray, ComplexArray]]:
    scale = np.abs(lines.s).max()
    s = lines.s / scale
    for order in range(1, highest + 1):
        found, rows = _reweighted(replace(lines, s=s), order, settings)
        yield found * scale, rows


def _reweighted(lines: Lines, order: int, settings: Settings) -> tuple[ComplexArray, ComplexArray]:
    """Poles in rad/s scaled by the highest line, and participations, of one order, reweighted by its denominator."""
    s, inputs = lines.s, lines.values.shape[2]
    below = 2 if settings.has_lower else 0
    numerator = max(order - (not settings.has_upper), 0) + below
    driven = lines.drive is not None
    drive = np.ones(len(s), dtype=complex) if lines.drive is None else lines.drive
    numerator += 2 if driven and settings.has_upper else 0
    denominator, before = np.ones(len(s)), None
    for _ in range(MOST_ROUNDS):
        family = orthogonal(s, 1 / denominator, order)
        rest = []
        for power, (receptance, weight) in zip(lines.powers[:, 0], _outputs(lines), strict=True):
            size = weight / denominator
            above = orthogonal(s, size * np.abs(drive) * np.abs(s) ** -below, numerator).values
            columns = size[:, None] * above * (drive * s**-below)[:, None]
            if driven:
                far = orthogonal(s, size * np.abs(s) ** (-2.0 - power), order + TRANSIENT_DEGREES).values
                columns = np.hstack([columns, size[:, None] * far * (s ** (-2.0 - power))[:, None]])
            rest.append(_eliminated(_equations(columns, size, receptance, family), columns.shape[1]))
        coefficients = _denominator(np.vstack(rest), order, inputs)
        found, rows = roots(coefficients, family)
        size = np.abs(np.linalg.det(np.tensordot(family.values, coefficients, axes=1))) ** (1 / inputs)
        denominator = np.maximum(size, SMALLEST_DENOMINATOR * size.max())
        now = np.sort_complex(found)
        if before is not None and np.allclose(
            now, before, rtol=START_CONVERGENCE if driven else POLE_CONVERGENCE, atol=0
        ):
            break
        before = now
    return found, rows


def _denominator(equations: FloatArray, order: int, inputs: int) -> FloatArray:
    """Coefficients of the denominator from its equations, (n + 1, n_in, n_in), of unit length for one input.

    Without that, the columns of A could be multiples of each other, and every number a root.
    """
    if inputs == 1:
        return np.asarray(np.linalg.svd(equations)[2][-1].reshape(order + 1, 1, 1))
    free = order * inputs
    solved = np.linalg.lstsq(equations[:, :free], -equations[:, free:])[0]
    return np.vstack([solved, np.eye(inputs)]).reshape(order + 1, inputs, inputs)


def _lscf(lines: Lines, highest: int, settings: Settings) -> Iterator[tuple[ComplexArray, ComplexArray]]:
    """Yield poles (rad/s) and participations of each order by polynomials in z, which make noise poles unstable.

    Guillaume, Verboven et al., A poly-reference implementation of the least-squares complex frequency-domain estimator
    (IMAC 2003); Cauberghe (2004) on the constraint. The lines are reduced to triangles once, for all orders.
    """
    del settings
    interval = np.pi / np.abs(lines.s).max()
    family = powers(np.exp(lines.s * interval), highest)
    inputs = lines.values.shape[2]
    triangles = [
        _triangle(_equations(weight[:, None] * family.values, weight, values, family))
        for values, weight in _outputs(lines, measured=True)
    ]
    for order in range(1, highest + 1):
        columns = [*range(order + 1), *range(highest + 1, highest + 1 + (order + 1) * inputs)]
        rest = np.vstack([_eliminated(triangle[:, columns], order + 1) for triangle in triangles])
        solved = np.linalg.lstsq(rest[:, inputs:], -rest[:, :inputs])[0]
        coefficients = np.vstack([np.eye(inputs), solved]).reshape(order + 1, inputs, inputs)
        found, rows = roots(coefficients, family)
        with np.errstate(divide="ignore"):
            poles = np.log(found) / interval
        inside = np.isfinite(poles) & (np.abs(poles.imag) < NYQUIST_MARGIN * np.pi / interval) & (poles != 0)
        yield poles[inside], rows[inside]


def _outputs(lines: Lines, *, measured: bool = False) -> Iterator[tuple[ComplexArray, FloatArray]]:
    """Yield, output by output, receptances (n_f, n_in) and the weights of the lines (n_f,)."""
    for o, power in enumerate(lines.powers):
        factor = np.ones((len(lines.s), len(power))) if measured else lines.s[:, None] ** power
        weights = lines.weights[:, o] * np.abs(factor)
        yield lines.values[:, o] / factor, np.sqrt(np.mean(weights**2, axis=1))


def _equations(numerator: ComplexArray, weight: FloatArray, values: ComplexArray, family: Family) -> FloatArray:
    """Real equations ``B - H A = 0`` of one output, with columns of B, then of A by degree and input."""
    weighted = weight[:, None] * values
    denominator = -(family.values[:, :, None] * weighted[:, None, :]).reshape(len(weight), -1)
    both = np.hstack([numerator, denominator])
    return np.vstack([both.real, both.imag])


def _eliminated(equations: FloatArray, numerators: int) -> FloatArray:
    """Equations of one output for the denominator alone, its numerators eliminated by a QR decomposition."""
    return _triangle(equations)[numerators:, numerators:]


def _triangle(equations: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.qr(equations, mode="r"))
