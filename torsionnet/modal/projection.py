"""Residuals of transfer functions with the best residues for a given denominator, and their derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.modal.settings import Settings
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray, Lines

LARGEST_LOGARITHM = 30.0
"""Logarithm of a denominator coefficient, for lines scaled to 1 rad/s, beyond which a fit no longer depends on it."""


@dataclass(frozen=True, eq=False)
class Projection:
    """Least-squares problem for the logarithms of the denominator's coefficients, which keep the poles stable.

    Attributes
    ----------
    lines : Lines
    sizes : tuple of int
        Degree of each factor of the denominator, 2 or 1.
    settings : Settings
    """

    lines: Lines
    sizes: tuple[int, ...]
    settings: Settings

    @property
    def unknowns(self) -> int:
        """Number of unknowns of the fit, denominator coefficients, residues and residual terms together."""
        pairs = self.lines.values.shape[1] * self.lines.values.shape[2]
        ends = self.settings.has_lower + self.settings.has_upper
        return int(sum(self.sizes) * (1 + pairs) + ends * pairs)

    def residuals(self, logarithms: FloatArray) -> FloatArray:
        """Weighted residuals, one transfer function after the other, (n_equations,), real before imaginary parts."""
        return np.concatenate([residual for _, residual, _ in self._pairs(logarithms)])

    def complex_residuals(self, logarithms: FloatArray) -> ComplexArray:
        """Weighted residuals of all transfer functions as complex numbers, (n_f, n_out, n_in)."""
        _, outputs, inputs = self.lines.values.shape
        parts = self.residuals(logarithms).reshape(outputs, inputs, 2, -1)
        return np.asarray((parts[:, :, 0] + 1j * parts[:, :, 1]).transpose(2, 0, 1))

    def jacobian(self, logarithms: FloatArray) -> FloatArray:
        """Derivatives of the residuals by the logarithms (Kaufman's form), (n_equations, n_coefficients)."""
        moved = self._column_derivatives(coefficients_of(logarithms))
        blocks = []
        for factor, _, (basis, solution) in self._pairs(logarithms):
            change = np.stack([factor * (columns @ solution[own]) for own, columns in moved], axis=1)
            real = np.vstack([change.real, change.imag])
            blocks.append(-(real - basis @ (basis.T @ real)))
        return np.vstack(blocks)

    def _pairs(self, logarithms: FloatArray) -> list[tuple[ComplexArray, FloatArray, tuple[FloatArray, FloatArray]]]:
        """Weight times s^p at the lines, residuals, and orthonormal basis with residues, by transfer function."""
        lines = self.lines
        columns = self._columns(coefficients_of(logarithms))
        found = []
        for o, i in np.ndindex(*lines.values.shape[1:]):
            factor = lines.weights[:, o, i] * lines.s ** lines.powers[o, i]
            design, wanted = factor[:, None] * columns, lines.weights[:, o, i] * lines.values[:, o, i]
            real = np.vstack([design.real, design.imag])
            size = np.linalg.norm(real, axis=0)
            basis, triangle = np.linalg.qr(real / size)
            data = np.concatenate([wanted.real, wanted.imag])
            inside = basis.T @ data
            solution = np.linalg.lstsq(triangle, inside)[0] / size
            found.append((factor, data - basis @ inside, (basis, solution)))
        return found

    def _columns(self, coefficients: FloatArray) -> ComplexArray:
        """Columns (n_f, n) of the linear fit, 1/q and s/q of each factor q, then the residual terms."""
        s = self.lines.s
        columns = []
        for own, value in self._values(coefficients):
            columns += [s**degree / value for degree in range(own.stop - own.start)]
        columns += [s**-2] if self.settings.has_lower else []
        columns += [np.ones_like(s)] if self.settings.has_upper else []
        return np.stack(columns, axis=1)

    def _values(self, coefficients: FloatArray) -> list[tuple[slice, ComplexArray]]:
        """Slice of the coefficients of each factor of the denominator, and the factor's value at the lines (n_f,)."""
        s, place, found = self.lines.s, 0, []
        for size in self.sizes:
            own = slice(place, place + size)
            found.append((own, np.asarray(np.polyval(np.array([1.0, *coefficients[own]]), s))))
            place += size
        return found

    def _column_derivatives(self, coefficients: FloatArray) -> list[tuple[slice, ComplexArray]]:
        """Slice and derivatives of the fit's columns (n_f, n), by the logarithm of each coefficient."""
        s, found = self.lines.s, []
        for own, value in self._values(coefficients):
            size = own.stop - own.start
            for number, coefficient in enumerate(coefficients[own]):
                change = -coefficient * s ** (size - 1 - number) / value**2
                found.append((own, change[:, None] * s[:, None] ** np.arange(size)))
        return found


def coefficients_of(logarithms: FloatArray) -> FloatArray:
    """Coefficients of the denominator from their logarithms, limited because an undefined pole may grow for ever."""
    return np.asarray(np.exp(np.clip(logarithms, -LARGEST_LOGARITHM, LARGEST_LOGARITHM)))
