"""Poles of a sum of damped exponentials by the matrix pencil, for rising numbers of poles."""

from __future__ import annotations

import numpy as np

from torsionnet.modal.spectral_lines import ComplexArray, FloatArray

PENCIL_SHARE = 0.4
"""Length of the pencil over the number of samples; between a third and a half noise disturbs least."""


def pencil_poles(values: FloatArray, step: float, highest: int) -> list[ComplexArray]:
    """Poles in rad/s of sums of 1, 2, ... ``highest`` damped exponentials at steps in s, one array for each number.

    Y. Hua, T. K. Sarkar, Matrix pencil method for estimating parameters of exponentially damped/undamped sinusoids in
    noise, IEEE Trans. Acoustics, Speech and Signal Processing 38 (1990) 814-824.

    Examples
    --------
    >>> t = np.arange(200) * 0.01
    >>> found = pencil_poles(np.exp(-0.5 * t) * np.cos(2 * np.pi * 5 * t), 0.01, 2)[-1]
    >>> np.sort(found.imag / (2 * np.pi)).round(6).tolist(), found.real.round(6).tolist()
    ([-5.0, 5.0], [-0.5, -0.5])
    """
    length = max(int(PENCIL_SHARE * len(values)), 2)
    rows = np.lib.stride_tricks.sliding_window_view(values, length + 1)
    right = np.linalg.svd(rows, full_matrices=False)[2]
    found = []
    for count in range(1, min(highest, len(right), length) + 1):
        space = right[:count].T
        shifted = np.linalg.lstsq(space[:-1], space[1:], rcond=None)[0]
        inside = np.linalg.eigvals(shifted)
        inside = inside[np.abs(inside) > 0]
        found.append(np.log(inside.astype(complex)) / step)
    return found
