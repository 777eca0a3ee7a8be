"""Residues of given poles by least squares in the frequency domain (LSFD)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsionnet.modal.settings import Settings
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray, Lines


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
        total = sum((self.term(mode, s) for mode in range(len(self.poles))), start=np.zeros(1)) + self.upper
        with np.errstate(divide="ignore", invalid="ignore"):
            rest = np.where(self.lower == 0, 0, self.lower * each ** (powers - 2))
            return np.asarray(total * each**powers + rest)

    def term(self, mode: int, s: ComplexArray) -> ComplexArray:
        """Contribution of one mode to the transfer functions, in the form of receptances, (n_f, n_out, n_in)."""
        first, second = terms(self.poles[mode], s)
        residue = self.residues[mode]
        return np.asarray(first[:, None, None] * residue.real + second[:, None, None] * residue.imag)


def terms(pole: complex, s: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Factors at s (n_f,) of the real and of the imaginary part of a pole's residue, the latter 0 for a real pole."""
    one = 1 / (s - pole)
    if pole.imag == 0:
        return one, np.zeros_like(one)
    other = 1 / (s - np.conj(pole))
    return one + other, 1j * (one - other)


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
                residues[:, o, i], ends[:, o, i : i + 1] = _solve(
                    lines, o, [i], poles, np.ones((len(poles), 1), dtype=complex), settings
                )
        else:
            scaled = rows / np.abs(rows).max(axis=1, keepdims=True)
            shape, ends[:, o] = _solve(lines, o, list(range(inputs)), poles, scaled, settings)
            residues[:, o] = shape[:, None] * scaled
    residues.imag[poles.imag == 0] = 0.0
    return Expansion(poles, residues, ends[0], ends[1])


def _solve(
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
    size = np.linalg.norm(real, axis=0)
    size[size == 0] = 1.0
    found = np.linalg.lstsq(real / size, np.concatenate([wanted.real, wanted.imag]))[0] / size
    count = len(poles)
    ends = np.zeros((2, len(inputs)))
    rest = found[2 * count :].reshape(-1, len(inputs))
    ends[[place for place, has in enumerate((settings.has_lower, settings.has_upper)) if has]] = rest
    return found[:count] + 1j * found[count : 2 * count], ends


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
    pairs = [terms(pole, s) for pole in poles]
    real = [row.real * a + row.imag * b for row, (a, b) in zip(rows, pairs, strict=True)]
    imaginary = [row.real * b - row.imag * a for row, (a, b) in zip(rows, pairs, strict=True)]
    ends = [term for term, has in ((s**-2, settings.has_lower), (np.ones_like(s), settings.has_upper)) if has]
    own = np.zeros((len(s), len(ends), inputs), dtype=complex)
    for number, end in enumerate(ends):
        own[:, number, place] = end
    parts = [np.stack(part, axis=1) for part in (real, imaginary) if part]
    factor = lines.weights[:, output, input] * s ** lines.powers[output, input]
    return np.asarray(factor[:, None] * np.hstack([*parts, own.reshape(len(s), -1)]))
