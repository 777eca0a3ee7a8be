"""Nonzero eigenvalues in rad/s and shapes of a stack of first-order forms, each with an estimate of its error.

The error is estimated as in :mod:`torsionnet.linear.modes.spectrum`, from the size of the form and the condition of the
eigenvalue, which its symmetry gives without left vectors: with x = (velocities, forces) and S = diag(I, -I) the matrix
S A is symmetric, so that S x is the left vector of x.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.batch.shared_directions import SharedDirections
from torsionnet.linear.batch.stacked_form import Coefficients, stacked_form
from torsionnet.linear.dynamic_stiffness.reduction import AnyArray
from torsionnet.linear.modes.spectrum import on_real_axis

_EPS = float(np.finfo(float).eps)
ERROR_SAFETY = 4.0
"""Safety factor on the error estimate of eigenvalues, a larger value of which sends more variants to the single
solver."""
ERROR_SAFETY_MASSLESS = 100.0
"""Safety factor on the error estimate with massless motions, whose elimination adds rounding errors."""


class StackedVibrations(NamedTuple):
    """Nonzero eigenvalues (n, m) in rad/s by size, their shapes (n, n_q, m), and relative errors (n, m)."""

    values: ComplexArray
    vectors: ComplexArray
    errors: FloatArray

    def columns_of(self, some: NDArray[np.intp], columns: NDArray[np.intp]) -> StackedVibrations:
        """Eigenvalues, shapes and relative errors of some variants in these columns (n, m)."""
        return StackedVibrations(
            np.take_along_axis(self.values[some], columns, axis=1),
            np.take_along_axis(self.vectors[some], columns[:, None, :], axis=2),
            np.take_along_axis(self.errors[some], columns, axis=1),
        )


Some: TypeAlias = tuple[NDArray[np.intp], StackedVibrations]


def undamped_vibrations(directions: SharedDirections, given: Coefficients) -> StackedVibrations:
    """Eigenvalues (n, m) in rad/s and shapes (n, n_q, m) of variants without damping, by rising frequency."""
    form = stacked_form(directions, given)
    _, sigma, vt = np.linalg.svd(form.coupling, full_matrices=False)
    rates, states = sigma[:, ::-1], vt.mT[:, :, ::-1]
    errors = _safety(directions) * _EPS * form.size[:, None] / rates
    return StackedVibrations(1j * rates, (form.recover[:, :, : states.shape[1]] @ states).astype(complex), errors)


def damped_vibrations(directions: SharedDirections, given: Coefficients) -> Iterator[Some]:
    """Yield indices of variants and their damped modes (eigenvalues, shapes, errors), grouped by number of modes."""
    found = _every(directions, given)
    real = on_real_axis(found.values)
    kept = (found.values.imag > 0) | real
    order = np.argsort(np.where(kept, np.abs(found.values), np.inf), axis=1, kind="stable")
    values = _settling(found.values, given)
    values.imag[real] = 0.0
    found = found._replace(values=values)
    counts = kept.sum(axis=1)
    for count in np.unique(counts):
        some = np.flatnonzero(counts == count)
        yield some, found.columns_of(some, order[some, :count])


def hysteretic_vibrations(directions: SharedDirections, given: Coefficients) -> Iterator[Some]:
    """Yield indices of variants and their modes (eigenvalues, shapes, errors) with hysteretic springs, grouped.

    They are grouped by number of real poles, and defined as in ``frozen_stiffness``.

    Real poles are those of the elastic springs. There are as many vibrations as these have; of the eigenvalues above
    the real axis they are the least damped ones, since the loss moves real poles off that axis.
    """
    elastic = given.lossless()
    found = _every(directions, given)
    damping = np.where(found.values.imag > 0, -found.values.imag / np.abs(found.values), np.inf)
    least = np.argsort(damping, axis=1, kind="stable")
    if directions.dissipating.size:
        rest = _every(directions, elastic)
        real = on_real_axis(rest.values)
    else:
        rest, real = found, np.zeros(found.values.shape, dtype=bool)
    first_real = np.argsort(~real, axis=1, kind="stable")
    counts = real.sum(axis=1)
    total = 2 * directions.vibrations if not directions.dissipating.size else found.values.shape[1]
    for count in np.unique(counts):
        some = np.flatnonzero(counts == count)
        vibrating = found.columns_of(some, least[some, : (total - count) // 2])
        still = rest.columns_of(some, first_real[some, :count])
        still.values.imag[:] = 0.0
        both = StackedVibrations(*(np.concatenate(pair, axis=-1) for pair in zip(vibrating, still, strict=True)))
        both = both._replace(values=_settling(both.values, given.of(some)))
        yield some, both.columns_of(np.arange(len(some)), np.argsort(np.abs(both.values), axis=1, kind="stable"))


def _settling(values: ComplexArray, given: Coefficients) -> ComplexArray:
    """Eigenvalues (n, m) in rad/s in which the growth of passive variants, which is rounding, is set to zero."""
    passive = ((given.damping >= 0) & (given.loss >= 0)).all(axis=1, keepdims=True)
    return np.asarray(np.where(passive, np.minimum(values.real, 0.0), values.real) + 1j * values.imag)


def _every(directions: SharedDirections, given: Coefficients) -> StackedVibrations:
    """All nonzero eigenvalues in rad/s of the first-order forms, with shapes and errors, conjugates included."""
    form = stacked_form(directions, given)
    values, states = (np.asarray(found, dtype=complex) for found in np.linalg.eig(form.matrix))
    sign = np.where(np.arange(states.shape[1]) < form.coupling.shape[2], 1.0, -1.0)[:, None]
    condition = np.sum(np.abs(states) ** 2, axis=1) / np.abs(np.sum(sign * states**2, axis=1))
    errors = _safety(directions) * _EPS * form.size[:, None] * condition / np.abs(values)
    return StackedVibrations(values, form.recover @ states, errors)


def _safety(directions: SharedDirections) -> float:
    return ERROR_SAFETY_MASSLESS if directions.damped.size or directions.held.size else ERROR_SAFETY


def residuals(rows: FloatArray, given: Coefficients, found: StackedVibrations) -> FloatArray:
    """Residual torques (n, m) of each mode's equation of motion, over the sum of the magnitudes of their terms."""
    z, motion, sizes = found.values[:, None, :], rows @ found.vectors, np.abs(rows)
    J, c, elastic, loss = (part[:, :, None] for part in given)
    k: AnyArray = elastic
    if given.loss.any():  # real poles are those of elastic springs
        k = np.asarray(elastic + 1j * np.where(z.imag > 0, loss, 0.0), dtype=complex)
    left = rows.T @ ((k + c * z + J * z**2) * motion)
    size = np.abs(z)
    terms = sizes.T @ ((np.abs(k) + np.abs(c) * size + J * size**2) * (sizes @ np.abs(found.vectors)))
    return np.asarray(np.linalg.norm(left, axis=1) / np.linalg.norm(terms, axis=1))
