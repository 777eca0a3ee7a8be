"""Residues of given poles by least squares in the frequency domain (LSFD)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from torsionnet.modal.spectral_lines import ComplexArray, FloatArray, Lines, Settings


@dataclass(frozen=True, eq=False)
class Expansion:
    """Modal expansion ``H = s^p (sum R / (s - lambda) + conjugate + lower / s^2 + upper)`` of transfer functions.

    A real pole has one term and a real R.

    Attributes
    ----------
    poles : (n,) complex array
        rad/s.
    residues : (n, n_out, n_in) complex array
    lower, upper : (n_out, n_in) arrays
    """

    poles: ComplexArray
    residues: ComplexArray
    lower: FloatArray
    upper: FloatArray

    def values(self, s: ComplexArray, powers: NDArray[np.int_]) -> ComplexArray:
        """Transfer functions of the expansion at s in rad/s, complex, SI, (n_f, n_out, n_in)."""
        each = s[:, None, None]
        # H = s^p (sum over the modes + U) + L s^(p - 2).
        total = sum((self.term(mode, s) for mode in range(len(self.poles))), start=np.zeros(1)) + self.upper
        with np.errstate(divide="ignore", invalid="ignore"):
            rest = np.where(self.lower == 0, 0, self.lower * each ** (powers - 2))
            return np.asarray(total * each**powers + rest)

    def term(self, mode: int, s: ComplexArray) -> ComplexArray:
        """Contribution of one mode to the transfer functions, in the form of receptances, (n_f, n_out, n_in)."""
        first, second = residue_factors(self.poles[mode], s)
        residue = self.residues[mode]
        return np.asarray(first[:, None, None] * residue.real + second[:, None, None] * residue.imag)


def residue_factors(pole: complex, s: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Factors at s (n_f,) of the real and of the imaginary part of a pole's residue, the latter 0 for a real pole."""
    own = 1 / (s - pole)
    if pole.imag == 0:
        return own, np.zeros_like(own)
    # R/(s - lambda) + R^*/(s - lambda^*) = Re R (a + b) + Im R j (a - b), with a and b the two fractions.
    conjugate = 1 / (s - np.conj(pole))
    return own + conjugate, 1j * (own - conjugate)


def expand(lines: Lines, poles: ComplexArray, settings: Settings, rows: ComplexArray | None = None) -> Expansion:
    """Modal expansion with given poles (rad/s), whose residues and residual terms are fitted by least squares.

    Parameters
    ----------
    lines : Lines
    poles : (n,) complex array
    settings : Settings
    rows : (n, n_in) complex array, optional
        Participations of the inputs: residues are then a shape times these, which separates modes with the
        same pole. Without them every transfer function has residues of its own.
    """
    _, outputs, inputs = lines.values.shape
    residues = np.zeros((len(poles), outputs, inputs), dtype=complex)
    ends = np.zeros((2, outputs, inputs))
    for o in range(outputs):
        if rows is None or inputs == 1:
            for i in range(inputs):
                residues[:, o, i], ends[:, o, i : i + 1] = _residues_of_output(
                    lines, o, [i], poles, np.ones((len(poles), 1), dtype=complex), settings
                )
        else:
            # Residues of rank one: shape of the outputs times participation of the inputs.
            scaled = rows / np.abs(rows).max(axis=1, keepdims=True)
            shape, ends[:, o] = _residues_of_output(lines, o, list(range(inputs)), poles, scaled, settings)
            residues[:, o] = shape[:, None] * scaled
    residues.imag[poles.imag == 0] = 0.0
    return Expansion(poles, residues, ends[0], ends[1])


def _residues_of_output(
    lines: Lines, output: int, inputs: list[int], poles: ComplexArray, rows: ComplexArray, settings: Settings
) -> tuple[ComplexArray, FloatArray]:
    """Shape (n,) of all modes at one output, complex, and residual terms below and above the band (2, n_in)."""
    blocks = [
        _columns(lines, output, i, poles, rows[:, place], settings, place, len(inputs))
        for place, i in enumerate(inputs)
    ]
    weighted = [lines.weights[:, output, i] * lines.values[:, output, i] for i in inputs]
    design, wanted = np.vstack(blocks), np.concatenate(weighted)
    real = np.vstack([design.real, design.imag])
    # Columns of length 1, as those of modes and of residual terms differ by decades.
    size = np.linalg.norm(real, axis=0)
    size[size == 0] = 1.0
    solution = np.linalg.lstsq(real / size, np.concatenate([wanted.real, wanted.imag]))[0] / size
    count = len(poles)
    ends = np.zeros((2, len(inputs)))
    rest = solution[2 * count :].reshape(-1, len(inputs))
    ends[[place for place, has in enumerate((settings.has_lower, settings.has_upper)) if has]] = rest
    return solution[:count] + 1j * solution[count : 2 * count], ends


def _columns(
    lines: Lines,
    output: int,
    input: int,
    poles: ComplexArray,
    rows: ComplexArray,
    settings: Settings,
    place: int,
    inputs: int,
) -> ComplexArray:
    """Columns (n_f, n) of the fit of one transfer function, real and imaginary parts of shapes, then residual terms."""
    s = lines.s
    pairs = [residue_factors(pole, s) for pole in poles]
    # (x + j y)(u + j v) of shape and participation: x comes with u a + v b, y with u b - v a.
    real = [row.real * a + row.imag * b for row, (a, b) in zip(rows, pairs, strict=True)]
    imaginary = [row.real * b - row.imag * a for row, (a, b) in zip(rows, pairs, strict=True)]
    ends = [term for term, has in ((s**-2, settings.has_lower), (np.ones_like(s), settings.has_upper)) if has]
    own = np.zeros((len(s), len(ends), inputs), dtype=complex)
    for number, end in enumerate(ends):
        own[:, number, place] = end
    parts = [np.stack(part, axis=1) for part in (real, imaginary) if part]
    factor = lines.weights[:, output, input] * s ** lines.powers[output, input]
    return np.asarray(factor[:, None] * np.hstack([*parts, own.reshape(len(s), -1)]))


# Residuals of transfer functions with the best residues for a given denominator, and their derivatives.

TRANSIENT_POWERS = np.array([-2, -1, 0, 1, 2])
"""Powers of s, besides the free decay of each mode, by which a record that neither begins nor ends at rest differs from
a periodic one: drift below, and what sampling folds of a decay above."""
SMALLEST_PART = 1e-8
"""Part of a mode's contribution that no other explains, below which it is rounding."""
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
        modes = sum(self.sizes)
        transients = 0 if self.lines.drive is None else modes + len(TRANSIENT_POWERS)
        return int(modes * (1 + pairs) + (len(self._end_powers) + transients) * pairs)

    def residuals(self, logarithms: FloatArray) -> FloatArray:
        """Weighted residuals, one transfer function after the other, (n_equations,), real before imaginary parts."""
        return np.concatenate([residual for _, residual, _ in self._pairs(logarithms)])

    def complex_residuals(self, logarithms: FloatArray) -> ComplexArray:
        """Weighted residuals of all transfer functions as complex numbers, (n_f, n_out, n_in)."""
        _, outputs, inputs = self.lines.values.shape
        parts = self.residuals(logarithms).reshape(outputs, inputs, 2, -1)
        return np.asarray((parts[:, :, 0] + 1j * parts[:, :, 1]).transpose(2, 0, 1))

    def responses(self, logarithms: FloatArray) -> ComplexArray:
        """Transfer functions of the fit at its lines, without the transients of a record, (n_f, n_out, n_in)."""
        lines = self.lines
        columns = np.hstack([self._modes(coefficients_of(logarithms)), lines.s[:, None] ** self._end_powers])
        responses = np.empty(lines.values.shape, dtype=complex)
        pairs = self._pairs(logarithms)
        for (o, i), (_, _, (_, solution)) in zip(np.ndindex(*responses.shape[1:]), pairs, strict=True):
            responses[:, o, i] = lines.s ** lines.powers[o, i] * (columns @ solution[: columns.shape[1]])
        return responses

    def without_transients(self, logarithms: FloatArray) -> Lines:
        """Lines of the responses behind a record, without transients and the higher residual terms of the fit.

        A fit of residues to them has the solution of the fit to the record.
        """
        lines, powers = self.lines, self._end_powers
        assert lines.drive is not None
        modes = self._modes(coefficients_of(logarithms))
        extra = np.where(np.isin(powers, (-2, 0)), 0, lines.s[:, None] ** powers)
        free = np.hstack([modes, lines.s[:, None] ** TRANSIENT_POWERS])
        values, count = lines.values.copy(), modes.shape[1]
        # Y = H X + transients: what is neither mode nor one of the two residual terms is taken out, then the drive.
        for (o, i), (_, _, (_, solution)) in zip(np.ndindex(*values.shape[1:]), self._pairs(logarithms), strict=True):
            driven, rest = np.split(solution[count:], [len(powers)])
            values[:, o, i] -= lines.drive * lines.s ** lines.powers[o, i] * (extra @ driven) + free @ rest
        size = np.abs(lines.drive)[:, None, None]
        return replace(lines, values=values / lines.drive[:, None, None], weights=lines.weights * size, drive=None)

    def jacobian(self, logarithms: FloatArray) -> FloatArray:
        """Derivatives of the residuals by the logarithms (Kaufman's form), (n_equations, n_coefficients)."""
        moved = self._column_derivatives(coefficients_of(logarithms))
        free = slice(sum(self.sizes) + len(self._end_powers), None)
        blocks = []
        for (o, i), (factor, _, (basis, solution)) in zip(
            np.ndindex(*self.lines.values.shape[1:]), self._pairs(logarithms), strict=True
        ):
            # Columns change under fixed residues; what other residues would make up for is projected out below.
            change = np.stack([factor * (columns @ solution[own]) for own, columns in moved], axis=1)
            if self.lines.drive is not None:
                weight, transients = self.lines.weights[:, o, i], solution[free]
                change += np.stack([weight * (columns @ transients[own]) for own, columns in moved], axis=1)
            real = np.vstack([change.real, change.imag])
            blocks.append(-(real - basis @ (basis.T @ real)))
        return np.vstack(blocks)

    def gains(self, logarithms: FloatArray, factors: FloatArray) -> FloatArray:
        """Fall of the squares of the residuals with one more mode each, over their mean, to first order, (n,).

        The score test: chi-squared of two unknowns for each pair and its transient, where there is no such mode.

        Parameters
        ----------
        logarithms : (n_coefficients,) array
            Solution of the problem.
        factors : (n, 2) array
            Coefficients (b, c) of the factor s^2 + b s + c of each mode.
        """
        from scipy.linalg import block_diag

        pairs, known = self._pairs(logarithms), np.linalg.qr(self.jacobian(logarithms))[0]
        left = np.concatenate([residual for _, residual, _ in pairs])
        gains = []
        for factor in factors:
            value = np.polyval([1.0, *factor], self.lines.s)
            columns, blocks = np.stack([1 / value, self.lines.s / value], axis=1), []
            for (o, i), (scale, _, (basis, _)) in zip(np.ndindex(*self.lines.values.shape[1:]), pairs, strict=True):
                scales = [scale] if self.lines.drive is None else [scale, self.lines.weights[:, o, i]]
                design = np.hstack([each[:, None] * columns for each in scales])
                real = np.vstack([design.real, design.imag])
                real /= np.linalg.norm(real, axis=0)
                blocks.append(real - basis @ (basis.T @ real))
            more = block_diag(*blocks)
            # Less what a change of the poles known already would do, too.
            more -= known @ (known.T @ more)
            directions, sizes, _ = np.linalg.svd(more, full_matrices=False)
            gains.append(np.sum((directions[:, sizes > SMALLEST_PART].T @ left) ** 2))
        return np.asarray(np.array(gains) * (len(left) / (left @ left)))

    def _pairs(self, logarithms: FloatArray) -> list[tuple[ComplexArray, FloatArray, tuple[FloatArray, FloatArray]]]:
        """Weight times s^p at the lines, residuals, and orthonormal basis with residues, by transfer function."""
        lines = self.lines
        modes = self._modes(coefficients_of(logarithms))
        columns = np.hstack([modes, lines.s[:, None] ** self._end_powers])
        free = np.hstack([modes, lines.s[:, None] ** TRANSIENT_POWERS])
        pairs = []
        for o, i in np.ndindex(*lines.values.shape[1:]):
            weight = lines.weights[:, o, i]
            factor = weight * lines.s ** lines.powers[o, i] * (1.0 if lines.drive is None else lines.drive)
            design, wanted = factor[:, None] * columns, weight * lines.values[:, o, i]
            if lines.drive is not None:
                design = np.hstack([design, weight[:, None] * free])
            real = np.vstack([design.real, design.imag])
            # Variable projection: residues are linear once the poles are given, and left is data - Q Q^T data.
            size = np.linalg.norm(real, axis=0)
            basis, triangle = np.linalg.qr(real / size)
            data = np.concatenate([wanted.real, wanted.imag])
            inside = basis.T @ data
            solution = np.linalg.lstsq(triangle, inside)[0] / size
            pairs.append((factor, data - basis @ inside, (basis, solution)))
        return pairs

    @property
    def _end_powers(self) -> NDArray[np.int_]:
        """Powers of s of the residual terms of a fit, more of them for a record.

        How the input of a record runs between samples, and a delay, multiply the response by an entire function, which
        leaves the poles in place.
        """
        below, above = ([-2], [0]) if self.lines.drive is None else ([-2, -1], [0, 1, 2])
        return np.array(below * self.settings.has_lower + above * self.settings.has_upper, dtype=int)

    def _modes(self, coefficients: FloatArray) -> ComplexArray:
        """Columns (n_f, n) of the linear fit for the modes, 1/q and s/q of each factor q of the denominator."""
        s, columns = self.lines.s, []
        for own, value in self._factor_values(coefficients):
            columns += [s**degree / value for degree in range(own.stop - own.start)]
        return np.stack(columns, axis=1)

    def _factor_values(self, coefficients: FloatArray) -> list[tuple[slice, ComplexArray]]:
        """Slice of the coefficients of each factor of the denominator, and the factor's value at the lines (n_f,)."""
        s, place, factors = self.lines.s, 0, []
        for size in self.sizes:
            own = slice(place, place + size)
            factors.append((own, np.asarray(np.polyval(np.array([1.0, *coefficients[own]]), s))))
            place += size
        return factors

    def _column_derivatives(self, coefficients: FloatArray) -> list[tuple[slice, ComplexArray]]:
        """Slice and derivatives of the fit's columns (n_f, n), by the logarithm of each coefficient."""
        s, derivatives = self.lines.s, []
        for own, value in self._factor_values(coefficients):
            size = own.stop - own.start
            for number, coefficient in enumerate(coefficients[own]):
                # d(1/D)/d ln c = -c s^n/D^2 for the coefficient c of s^n.
                change = -coefficient * s ** (size - 1 - number) / value**2
                derivatives.append((own, change[:, None] * s[:, None] ** np.arange(size)))
        return derivatives


def coefficients_of(logarithms: FloatArray) -> FloatArray:
    """Coefficients of the denominator from their logarithms, limited because an undefined pole may grow for ever."""
    return np.asarray(np.exp(np.clip(logarithms, -LARGEST_LOGARITHM, LARGEST_LOGARITHM)))
