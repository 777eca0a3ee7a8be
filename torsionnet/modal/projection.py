"""What is left of transfer functions after the best residues for a given denominator, and its derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.modal.settings import Settings
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray, Lines

FARTHEST = 30.0
"""Logarithm of a coefficient, for lines up to 1 rad/s, beyond which nothing changes any more."""


@dataclass(frozen=True, eq=False)
class Projection:
    """The problem in the logarithms of the denominator's coefficients: they stay positive, the poles stable.

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
        """Coefficients, residues and residual terms."""
        pairs = self.lines.values.shape[1] * self.lines.values.shape[2]
        ends = self.settings.has_lower + self.settings.has_upper
        return int(sum(self.sizes) * (1 + pairs) + ends * pairs)

    def left(self, logarithms: FloatArray) -> FloatArray:
        """Real parts of all transfer functions, then imaginary parts, pair after pair."""
        return np.concatenate([residual for _, residual, _ in self._pairs(logarithms)])

    def complex_left(self, logarithms: FloatArray) -> ComplexArray:
        """(n_f, n_out, n_in)."""
        _, outputs, inputs = self.lines.values.shape
        parts = self.left(logarithms).reshape(outputs, inputs, 2, -1)
        return np.asarray((parts[:, :, 0] + 1j * parts[:, :, 1]).transpose(2, 0, 1))

    def slopes(self, logarithms: FloatArray) -> FloatArray:
        """Derivative of :meth:`left` in Kaufman's form, (n_equations, n_coefficients)."""
        moved = self._moved(coefficients_of(logarithms))
        blocks = []
        for factor, _, (basis, solution) in self._pairs(logarithms):
            change = np.stack([factor * (columns @ solution[own]) for own, columns in moved], axis=1)
            real = np.vstack([change.real, change.imag])
            blocks.append(-(real - basis @ (basis.T @ real)))
        return np.vstack(blocks)

    def _pairs(self, logarithms: FloatArray) -> list[tuple[ComplexArray, FloatArray, tuple[FloatArray, FloatArray]]]:
        """Of each transfer function: its factor, what is left, an orthonormal basis and the residues."""
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
        """1 / q and s / q of each factor q, then the residual terms."""
        s = self.lines.s
        columns = []
        for own, value in self._values(coefficients):
            columns += [s**degree / value for degree in range(own.stop - own.start)]
        columns += [s**-2] if self.settings.has_lower else []
        columns += [np.ones_like(s)] if self.settings.has_upper else []
        return np.stack(columns, axis=1)

    def _values(self, coefficients: FloatArray) -> list[tuple[slice, ComplexArray]]:
        """Place of each factor among the coefficients, and its value at the lines."""
        s, place, found = self.lines.s, 0, []
        for size in self.sizes:
            own = slice(place, place + size)
            found.append((own, np.asarray(np.polyval(np.array([1.0, *coefficients[own]]), s))))
            place += size
        return found

    def _moved(self, coefficients: FloatArray) -> list[tuple[slice, ComplexArray]]:
        """Derivative of the own columns to the logarithm of every coefficient, with the place of these columns."""
        s, found = self.lines.s, []
        for own, value in self._values(coefficients):
            size = own.stop - own.start
            for number, coefficient in enumerate(coefficients[own]):
                change = -coefficient * s ** (size - 1 - number) / value**2
                found.append((own, change[:, None] * s[:, None] ** np.arange(size)))
        return found


def coefficients_of(logarithms: FloatArray) -> FloatArray:
    """The coefficients; a pole that the lines do not hold can run off without end."""
    return np.asarray(np.exp(np.clip(logarithms, -FARTHEST, FARTHEST)))
