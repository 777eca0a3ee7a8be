"""Fit of modes to the complex orders of a passage through resonances, the swept and not the steady response."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.modal.operational.passage_windows import PassageWindows
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray

# Response of one mode to an order while the speed changes, over time.

Excitation = Literal["constant", "inertia"]
"""Names of laws of the excitation's amplitude over speed: constant, or as its square, as of an inertia torque."""
DERIVATIVES = {"velocity": 1, "acceleration": 2}
"""Number of derivatives over time from an angle to a quantity, by its name; torque and stress follow the angle."""


@dataclass(frozen=True, eq=False)
class SpeedSweep:
    """An order over time at equal steps, with phase, phase in the middle of the steps, and relative excitation.

    Attributes
    ----------
    step : float
        s.
    phase : (n,) array
        Phase of the order at each time, rad.
    middle : (n - 1,) array
        Phase in the middle of each step, rad.
    speed : (n,) array
        Rate of the phase, rad/s.
    excitation : (n,) array
        Amplitude of the excitation over its largest.
    """

    step: float
    phase: FloatArray
    middle: FloatArray
    speed: FloatArray
    excitation: FloatArray

    @cached_property
    def turning(self) -> ComplexArray:
        """Turning unit phasor of the order at each time, shape (n,)."""
        return np.asarray(np.exp(1j * self.phase))

    @cached_property
    def torque(self) -> tuple[ComplexArray, ComplexArray]:
        """Relative excitation times the phasor, at each time (n,) and in the middle of the steps (n - 1,)."""
        g = self.excitation
        return np.asarray(g * self.turning), np.asarray((g[1:] + g[:-1]) / 2 * np.exp(1j * self.middle))


def sweep_of(times: FloatArray, angle: FloatArray, order: float, excitation_law: Excitation = "constant") -> SpeedSweep:
    """Sweep of one order from the angle of the reference shaft in rad at times in s, at equal steps, shape (n,).

    Raises
    ------
    UsageError
        The excitation is neither constant nor that of inertia.
    """
    from scipy.interpolate import CubicSpline

    if excitation_law not in {"constant", "inertia"}:
        raise UsageError(
            f'the excitation is "constant" or "inertia" (as speed squared), got "{excitation_law}"', kind="unknown-word"
        )
    spline = CubicSpline(times, order * angle)
    speed = np.asarray(spline(times, 1))
    # Torques of inertia grow with the square of speed; 1 at the highest one.
    amplitude = np.ones(len(times)) if excitation_law == "constant" else (speed / np.abs(speed).max()) ** 2
    middle = np.asarray(spline((times[1:] + times[:-1]) / 2))
    return SpeedSweep(float((times[-1] - times[0]) / (len(times) - 1)), order * angle, middle, speed, amplitude)


def swept_response(pole: complex, sweep: SpeedSweep, derivative: int = 0) -> ComplexArray:
    """Complex amplitude over time of a mode's response to an order, over the static response to the largest amplitude.

    The response is Re X(t) exp(j phase(t)), that of ``q'' + 2 zeta omega_0 q' + omega_0^2 q = omega_0^2 Re g exp(j
    phase)``, from the steady response at the first speed on. The state of the mode passes from sample to sample by its
    exact solution, the torque within a step by Simpson's rule.

    Parameters
    ----------
    pole : complex
        rad/s, Im > 0.
    sweep : SpeedSweep
    derivative : int
        1 for the velocity of the response, 2 for its acceleration.

    Examples
    --------
    Very slowly, the response is the steady one, here at the natural frequency of a mode of 5 % damping.

    >>> times = np.arange(0, 60, 0.002)
    >>> sweep = sweep_of(times, 2 * np.pi * (9 * times + times**2 / 60), order=1)
    >>> pole = 2 * np.pi * 10 * complex(-0.05, (1 - 0.05**2) ** 0.5)
    >>> response = swept_response(pole, sweep)
    >>> at = int(np.abs(sweep.speed - 2 * np.pi * 10).argmin())
    >>> print(abs(response[at]).round(2))
    10.0
    """
    # q = (z - z')/(2 j Im lambda) of the states z of lambda and z' of its conjugate, each derivative a power of them.
    total = _forced(pole, sweep) * pole**derivative - _forced(pole.conjugate(), sweep) * pole.conjugate() ** derivative
    values = total / (2j * pole.imag) * sweep.turning.conj()
    if derivative == 2:
        # The second derivative has the excitation beside them, q'' = 2 Re(lambda) q' - |lambda|^2 q + g.
        values = values + sweep.excitation
    return np.asarray(abs(pole) ** 2 * values)


def _forced(pole: complex, sweep: SpeedSweep) -> ComplexArray:
    """State z of ``z' = pole z + g exp(j phase)`` over time, shape (n,), from the steady state on."""
    from scipy.signal import lfilter

    h, g = sweep.step, sweep.excitation
    torque, middle = sweep.torque
    # A step's decay exp(lambda h) exactly, the excitation within it by Simpson's rule.
    over = np.exp(pole * h)
    gains = h / 6 * (over * torque[:-1] + 4 * np.exp(pole * h / 2) * middle + torque[1:])
    # Steady state g/(j Omega - lambda) at the beginning, corrected by its own rate of change to first order.
    steady = g[:2] / (1j * sweep.speed[:2] - pole)
    rate = 1j * sweep.speed[0] - pole
    start = (steady[0] - (steady[1] - steady[0]) / h / rate) * sweep.turning[0]
    later, _ = lfilter([1.0], [1.0, -over], gains.astype(complex), zi=np.array([over * start]))
    return np.concatenate([[start], later])


START_FREQUENCIES, START_DAMPING = 30, (0.006, 0.02, 0.06, 0.15)
"""Natural frequencies tried over the band, and damping ratios tried with each, before the fit is refined."""
LARGEST_DAMPING = 0.7
"""Damping ratio from which a mode has no resonance."""
CLEAR_CORRELATION = 2.0
"""Correlation of neighbouring residuals, in its standard errors, above which it widens the intervals."""


@dataclass(frozen=True, eq=False)
class RunUpFit:
    """Modes fitted to a passage, with covariance, fitted amplitudes, and what each mode contributes.

    Attributes
    ----------
    poles : (n_modes,) complex array
        rad/s, rising in size.
    covariance : (2 n_modes, 2 n_modes) array
        Of the logarithms of all natural frequencies, then of all damping ratios.
    fitted : (n_orders, n_windows) complex array
        SI.
    parts : (n_modes, n_orders, n_windows) complex array
        Contribution of each mode, SI.
    misfit : float
        RMS of the residuals over that of the values.
    correlation : float
        Correlation of neighbouring residuals, whitened.
    degrees : int
        Degrees of freedom of the residuals, real and imaginary parts counted.
    """

    poles: ComplexArray
    covariance: FloatArray
    fitted: ComplexArray
    parts: ComplexArray
    misfit: float
    correlation: float
    degrees: int


class _Passage:
    """Columns of the linear part of the fit, for poles that are tried."""

    def __init__(self, windows: PassageWindows, excitation: Excitation, derivative: int, background: int) -> None:
        self.windows, self.derivative = windows, derivative
        self.sweeps = [sweep_of(windows.times, windows.angle, order, excitation) for order in windows.orders]
        self.fixed = [self._fixed(sweep, background) for sweep in self.sweeps]
        self.data = [_times(windows.whitening, row) for row in windows.values]

    def _fixed(self, sweep: SpeedSweep, background: int) -> FloatArray:
        middle, width = sweep.speed.mean(), np.ptp(sweep.speed) / 2 or 1.0
        powers = [sweep.excitation * ((sweep.speed - middle) / width) ** power for power in range(background + 1)]
        return np.asarray(np.stack([self.windows.weights @ power for power in powers], axis=1))

    def mode(self, pole: complex) -> list[ComplexArray]:
        """Response of a mode in each order, (n_orders, n_windows), to the excitation of each order, relative."""
        responses = []
        for sweep in self.sweeps:
            response = swept_response(pole, sweep, self.derivative)
            rows = [
                self.windows.weights @ (response * sweep.turning * other.turning.conj()) if other is not sweep
                else self.windows.weights @ response
                for other in self.sweeps
            ]  # fmt: skip
            responses.append(np.array(rows, dtype=np.complex128))
        return responses

    def columns(self, poles: ComplexArray) -> ComplexArray:
        """Matrix (n_orders n_windows, n_columns) of the fit, not yet whitened."""
        count, size = len(self.sweeps), self.windows.values.shape[1]
        columns = [response.reshape(-1) for pole in poles for response in self.mode(pole)]
        for place, fixed in enumerate(self.fixed):
            for column in fixed.T:
                block = np.zeros((count, size), dtype=complex)
                block[place] = column
                columns.append(block.reshape(-1))
        return np.stack(columns, axis=1)

    def whitened(self, columns: ComplexArray) -> ComplexArray:
        blocks = columns.reshape(len(self.sweeps), -1, columns.shape[1])
        return np.concatenate([_times(self.windows.whitening, block) for block in blocks])


def fit_run_up(
    windows: PassageWindows, excitation: Excitation, derivative: int, modes: int, background: int
) -> RunUpFit:
    """Modes fitted to the orders of a passage by least squares, the linear unknowns eliminated (variable projection).

    Linear unknowns are the amplitude of each mode and each order, and a background that is a polynomial in speed for
    each order: what distant modes add. Without phases they are searched for with the poles.
    """
    passage = _Passage(windows, excitation, derivative, background)
    start = _started(passage, windows, modes)
    solve = _amplitudes if windows.amplitudes_only else _projected
    solution, jacobian, residuals, amplitudes = solve(passage, start)
    poles = _poles(solution)
    columns = passage.columns(poles)
    # Two for each complex amplitude and for each pole; without phases a phase of each order has no effect.
    unknown = 2 * columns.shape[1] + 2 * modes - (len(windows.orders) if windows.amplitudes_only else 0)
    degrees = len(residuals) - unknown
    if degrees < 1:
        raise SolveError(
            f"{len(residuals)} values do not determine {unknown} unknowns: fit fewer modes", kind="too-short"
        )
    correlation, inflation = _correlated(residuals, windows)
    variance = float(residuals @ residuals) / degrees * inflation
    covariance = np.linalg.pinv(jacobian.T @ jacobian)[: 2 * modes, : 2 * modes] * variance
    shape = (len(windows.orders), -1)
    fitted = (columns @ amplitudes).reshape(shape)
    count = len(windows.orders)
    parts = [
        (columns[:, m * count : (m + 1) * count] @ amplitudes[m * count : (m + 1) * count]).reshape(shape)
        for m in range(modes)
    ]
    left = np.abs(windows.values) - np.abs(fitted) if windows.amplitudes_only else windows.values - fitted
    misfit = float(np.sqrt(np.mean(np.abs(left) ** 2) / np.mean(np.abs(windows.values) ** 2)))
    rising = np.argsort(np.abs(poles))
    both = np.concatenate([rising, rising + modes])
    return RunUpFit(
        poles[rising], covariance[np.ix_(both, both)], fitted, np.array(parts)[rising], misfit, correlation, degrees
    )


def _times(whitening: FloatArray, block: ComplexArray) -> ComplexArray:
    """Whitening matrix, or its diagonal alone, times a block of values or columns."""
    if whitening.ndim == 2:
        return np.asarray(whitening @ block)
    return np.asarray(whitening.reshape(-1, *[1] * (block.ndim - 1)) * block)


def _poles(logarithms: FloatArray) -> ComplexArray:
    omega, zeta = np.exp(logarithms).reshape(2, -1)
    return np.asarray(omega * (-zeta + 1j * np.sqrt(1 - zeta**2)))


def _started(passage: _Passage, windows: PassageWindows, modes: int) -> FloatArray:
    """Logarithms of natural frequencies (rad/s) and damping ratios that fit best of a grid, one mode after another."""
    low, high = windows.frequencies.min(), windows.frequencies.max()
    grid = [
        (2 * np.pi * f, zeta) for f in np.linspace(low, high, START_FREQUENCIES + 2)[1:-1] for zeta in START_DAMPING
    ]
    candidates = [
        np.stack([part.reshape(-1) for part in passage.mode(complex(_poles(np.log(g))[0]))], axis=1) for g in grid
    ]
    data = np.concatenate(passage.data)
    columns = passage.whitened(passage.columns(np.zeros(0, dtype=complex)))
    chosen: list[tuple[float, float]] = []
    for _ in range(modes):
        # What the columns chosen so far leave, and the candidate that explains most of it.
        basis = np.linalg.qr(columns)[0]
        left = data - basis @ (basis.conj().T @ data)
        gains = []
        for candidate in candidates:
            new = passage.whitened(candidate)
            new = new - basis @ (basis.conj().T @ new)
            part = np.linalg.qr(new)[0]
            gains.append(float(np.linalg.norm(part.conj().T @ left)))
        best = int(np.argmax(gains))
        chosen.append(grid[best])
        columns = np.concatenate([columns, passage.whitened(candidates[best])], axis=1)
    return np.asarray(np.log(np.array(chosen).T.reshape(-1)))


def _projected(passage: _Passage, start: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, ComplexArray]:
    """Logarithms of frequencies and damping ratios, Jacobian and residuals (real, then imaginary), amplitudes."""
    data = np.concatenate(passage.data)
    scale = np.linalg.norm(data)

    # Variable projection: amplitudes follow from poles by linear least squares, so that poles alone are searched.
    def solved(at: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        columns = passage.whitened(passage.columns(_poles(at)))
        amplitudes = np.linalg.lstsq(columns, data, rcond=None)[0]
        return np.asarray((data - columns @ amplitudes) / scale), np.asarray(amplitudes)

    def residuals(at: FloatArray) -> FloatArray:
        left = solved(at)[0]
        return np.concatenate([left.real, left.imag])

    solution = _least_squares(residuals, start, len(start))
    return np.asarray(solution.x), np.asarray(solution.jac), np.asarray(solution.fun), solved(solution.x)[1]


def _amplitudes(passage: _Passage, start: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, ComplexArray]:
    """Results as of the complex fit, for values without phases: complex amplitudes are unknowns of the search."""
    size = np.abs(np.concatenate(passage.windows.values))
    scale, count = np.linalg.norm(size), len(start)
    # Unknowns are the amplitudes over those at which a column alone is as large as the largest value. The first mode
    # begins so in each order, further modes and the background at a hundredth, with a phase of 0.
    gains = np.max(np.abs(passage.columns(_poles(start))), axis=0)
    relative = np.where(np.arange(len(gains)) < len(passage.sweeps), 1.0, 0.01)

    def amplitudes(at: FloatArray) -> ComplexArray:
        real, imag = at[count:].reshape(2, -1)
        return np.asarray((real + 1j * imag) / gains * size.max())

    def residuals(at: FloatArray) -> FloatArray:
        fitted = passage.columns(_poles(at[:count])) @ amplitudes(at)
        return np.asarray((size - np.abs(fitted)) / scale)

    solution = _least_squares(residuals, np.concatenate([start, relative, np.zeros(len(gains))]), count)
    return np.asarray(solution.x[:count]), np.asarray(solution.jac), np.asarray(solution.fun), amplitudes(solution.x)


def _least_squares(residuals: Any, start: FloatArray, count: int) -> Any:
    """Result of scipy's least squares, the first ``count`` unknowns logarithms of frequencies and damping ratios."""
    from scipy.optimize import least_squares

    lower, upper = np.full(len(start), -np.inf), np.full(len(start), np.inf)
    upper[count // 2 : count] = np.log(LARGEST_DAMPING)
    return least_squares(
        residuals, np.minimum(start, upper - 1e-6), bounds=(lower, upper), jac="2-point", x_scale="jac",
        xtol=1e-10, ftol=1e-12, gtol=1e-14, max_nfev=200,
    )  # fmt: skip


def _correlated(residuals: FloatArray, windows: PassageWindows) -> tuple[float, float]:
    """Correlation of neighbouring residuals, and how many times larger it makes the variance of what is fitted."""
    size = windows.values.shape[1]
    rows = residuals.reshape(-1, size)
    products = float(np.sum(rows[:, 1:] * rows[:, :-1]))
    power = float(np.sum(rows**2))
    correlation = products / power if power else 0.0
    # Of n values a correlation scatters by 1/sqrt(n): only a clear one widens the intervals.
    clear = correlation > CLEAR_CORRELATION / np.sqrt(rows.size)
    return correlation, (1 + correlation) / (1 - correlation) if clear else 1.0
