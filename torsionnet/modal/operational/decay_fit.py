"""Fit of damped exponentials to a free decay, started by the matrix pencil."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import SolveError
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray

# Poles of a sum of damped exponentials by the matrix pencil, for rising numbers of poles.

PENCIL_SHARE = 0.4
"""Length of the pencil over the number of samples; between a third and a half noise disturbs least."""


def pencil_poles(values: FloatArray, step: float, highest: int) -> list[ComplexArray]:
    """Poles in rad/s of sums of 1, 2, ... ``highest`` damped exponentials at steps in s, one array for each number.

    Y. Hua, T. K. Sarkar, Matrix pencil method for estimating parameters of exponentially damped/undamped sinusoids in
    noise, IEEE Trans. Acoustics, Speech and Signal Processing 38 (1990) 814-824.

    Examples
    --------
    >>> t = np.arange(200) * 0.01
    >>> poles = pencil_poles(np.exp(-0.5 * t) * np.cos(2 * np.pi * 5 * t), 0.01, 2)[-1]
    >>> np.sort(poles.imag / (2 * np.pi)).round(6).tolist(), poles.real.round(6).tolist()
    ([-5.0, 5.0], [-0.5, -0.5])
    """
    length = max(int(PENCIL_SHARE * len(values)), 2)
    rows = np.lib.stride_tricks.sliding_window_view(values, length + 1)
    right = np.linalg.svd(rows, full_matrices=False)[2]
    poles = []
    for count in range(1, min(highest, len(right), length) + 1):
        # From the signal's space at some samples to that at the next: eigenvalues z = exp(lambda dt).
        space = right[:count].T
        shifted = np.linalg.lstsq(space[:-1], space[1:], rcond=None)[0]
        inside = np.linalg.eigvals(shifted)
        inside = inside[np.abs(inside) > 0]
        poles.append(np.log(inside.astype(complex)) / step)
    return poles


MOST_POLES = 16
"""Largest number of poles of the matrix pencil."""
NO_NOISE = 1e-12
"""Power of the residuals over that of the decay below which further poles would fit rounding."""
SAME_FREQUENCY, SAME_DAMPING = 0.01, 0.2
"""Relative changes of frequency and damping up to which a pole is the same with one more pole in the pencil."""
LARGEST_DAMPING = 0.5
"""Damping ratio from which a pole is none of a vibration."""
LEAST_AMPLITUDE = 0.01
"""Amplitude of a mode over the largest below which it is left out where the number of modes is open."""


@dataclass(frozen=True, eq=False)
class ExponentialFit:
    """Damped exponentials fitted to a decay.

    Attributes
    ----------
    poles : (n_modes,) complex array
        rad/s, Im > 0, rising in size.
    covariance : (2 n_modes, 2 n_modes) array
        Of Re lambda of all modes, then Im lambda, (rad/s)^2.
    amplitudes : (n_modes,) complex array
        X of ``Re X exp(lambda t)``, t from the start of the decay, SI.
    rest : (n,) array
        What does not vibrate: a constant and real exponentials, SI.
    residuals : (n,) array
        SI.
    by_count : tuple of arrays
        Poles of the pencil with 1, 2, ... poles, for a stabilisation diagram.
    """

    poles: ComplexArray
    covariance: FloatArray
    amplitudes: ComplexArray
    rest: FloatArray
    residuals: FloatArray
    by_count: tuple[ComplexArray, ...]


def fit_exponentials(times: FloatArray, values: FloatArray, modes: int | None) -> ExponentialFit:
    """Damped vibrations that fit a free decay best, as many as asked for or as the decay bears.

    Raises
    ------
    SolveError
        Nothing vibrates and decays.
    """
    t = times - times[0]
    pencils = pencil_poles(values, float(t[-1] / (len(t) - 1)), min(MOST_POLES, len(t) // 4))
    poles, real = _start_poles(t, values, pencils, modes)
    if not len(poles):
        raise SolveError(
            "nothing in the signal vibrates and decays: give start and end of the decay", kind="no-resonance"
        )
    return _refined(t, values, poles, real, tuple(pencils))


def _start_poles(
    t: FloatArray, values: FloatArray, pencils: list[ComplexArray], modes: int | None
) -> tuple[ComplexArray, FloatArray]:
    """Poles of vibrations and real poles (rad/s) with which information is gained at the lowest cost (Schwarz)."""
    best: tuple[float, ComplexArray, FloatArray] = (np.inf, np.zeros(0, dtype=complex), np.zeros(0))
    power, n = float(np.sum((values - values.mean()) ** 2)), len(values)
    for number, pencil in enumerate(pencils):
        vibrating, real = _sorted(pencil, t)
        if modes is None:
            vibrating = _steady_poles(vibrating, pencils[number + 1 : number + 3], t)
        elif len(vibrating) < modes:
            continue
        columns = _columns(t, vibrating, real)
        amplitudes = np.linalg.lstsq(columns, values, rcond=None)[0]
        sizes = np.hypot(amplitudes[: len(vibrating)], amplitudes[len(vibrating) : 2 * len(vibrating)])
        if modes is None:
            vibrating = vibrating[sizes > LEAST_AMPLITUDE * sizes.max(initial=0.0)]
        else:
            vibrating = vibrating[np.sort(np.argsort(sizes)[::-1][:modes])]
        columns = _columns(t, vibrating, real)
        left = values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0]
        misfit = max(float(left @ left) / power, NO_NOISE)
        # Schwarz criterion n ln(misfit) + unknowns ln(n), of amplitudes and poles.
        unknown = columns.shape[1] + 2 * len(vibrating) + len(real)
        criterion = n * np.log(misfit) + unknown * np.log(n)
        if criterion < best[0]:
            best = (criterion, vibrating, real)
    return best[1], best[2]


def _sorted(poles: ComplexArray, t: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Decaying vibrations with a cycle or more in the record, and decaying real poles, of the poles of a pencil."""
    # From a cycle in the whole record to somewhat below half the sampling rate.
    up = poles[(poles.imag > 2 * np.pi / t[-1]) & (poles.imag < 0.9 * np.pi / (t[1] - t[0]))]
    vibrating = up[(up.real < 0) & (-up.real < LARGEST_DAMPING * np.abs(up))]
    real = poles[np.abs(poles.imag) < 1e-6 * np.abs(poles)].real
    # Decays slower than the record are its mean, those within a few samples are noise.
    slow = real[(real < -1 / t[-1]) & (real > -0.3 / (t[1] - t[0]))]
    return vibrating[np.argsort(np.abs(vibrating))], slow


def _steady_poles(poles: ComplexArray, later: list[ComplexArray], t: FloatArray) -> ComplexArray:
    """Poles that stay with more poles in the pencil."""
    kept = np.ones(len(poles), dtype=bool)
    for pencil in later:
        others = _sorted(pencil, t)[0]
        for place, pole in enumerate(poles):
            frequency = np.abs(np.abs(others) / abs(pole) - 1) < SAME_FREQUENCY
            damping = np.abs(others.real / pole.real - 1) < SAME_DAMPING
            kept[place] &= bool((frequency & damping).any())
    return poles[kept]


def _columns(t: FloatArray, poles: ComplexArray, real: FloatArray) -> FloatArray:
    waves = np.exp(np.outer(t, poles))
    return np.concatenate([waves.real, -waves.imag, np.exp(np.outer(t, real)), np.ones((len(t), 1))], axis=1)


def _refined(
    t: FloatArray, values: FloatArray, poles: ComplexArray, real: FloatArray, pencils: tuple[ComplexArray, ...]
) -> ExponentialFit:
    from scipy.optimize import least_squares

    count = len(poles)
    scale = np.concatenate([np.abs(poles.real), np.abs(poles.real), np.abs(real)])
    origin = np.concatenate([poles.real, poles.imag, real])

    def at(x: FloatArray) -> tuple[ComplexArray, FloatArray]:
        numbers = origin + scale * x
        return numbers[:count] + 1j * numbers[count : 2 * count], numbers[2 * count :]

    def residuals(x: FloatArray) -> FloatArray:
        columns = _columns(t, *at(x))
        return np.asarray(values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0])

    solution = least_squares(residuals, np.zeros(len(origin)), jac="3-point", max_nfev=100)
    final, slow = at(solution.x)
    columns = _columns(t, final, slow)
    linear = np.linalg.lstsq(columns, values, rcond=None)[0]
    unknown = columns.shape[1] + len(origin)
    # The residuals have the amplitudes eliminated: their derivatives give the covariance of the poles alone.
    variance = float(solution.fun @ solution.fun) / max(len(t) - unknown, 1) * _inflation(solution.fun)
    jacobian = np.asarray(solution.jac)
    covariance = np.linalg.pinv(jacobian.T @ jacobian) * variance * np.outer(scale, scale)
    rising = np.argsort(np.abs(final))
    both = np.concatenate([rising, rising + count])
    amplitudes = linear[:count] + 1j * linear[count : 2 * count]
    rest = columns[:, 2 * count :] @ linear[2 * count :]
    return ExponentialFit(
        final[rising], covariance[np.ix_(both, both)], amplitudes[rising], rest, np.asarray(solution.fun), pencils
    )


def _inflation(residuals: FloatArray) -> float:
    """Sum of the autocorrelation of residuals, by which their correlation widens the variance; 1 or more."""
    power = float(residuals @ residuals)
    if not power:
        return 1.0
    correlation = np.correlate(residuals, residuals, "full")[len(residuals) - 1 :] / power
    ends = np.flatnonzero(correlation < 2 / np.sqrt(len(residuals)))
    return float(1 + 2 * correlation[1 : ends[0] if len(ends) else None].sum())
