"""Weighted residuals of the equation of motion along a record over time: loops, decays, rattling.

A prediction of the whole record slips in phase, and runs away in contacts. The equation holds for the motion that was
measured: it is multiplied by bumps phi that vanish at both ends and summed over time, where derivatives of the motion
become those of phi,

    sum phi tau(gamma, gamma') + (k phi - c phi' + J phi'') gamma - g phi u = 0,

so that noise is not differentiated, and neither states nor phases are to be found.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
import scipy
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.identification.orders.parametric_orders import parameters_of_drivetrain
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.motion_equation import LinearRest, MotionEquation, motion_equation
from torsionnet.identification.residuals.noise import Noise
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.signals.recording import Recording

MOST_ROWS = 800
"""Most equations of a record."""
OVERLAP = 4
"""Bumps that begin within the length of one, where a mass moves."""
POWER = 6
"""Power of the bump (1 - x^2)^6, whose second derivatives are smooth at its ends, so that sums stand for integrals."""
LENGTH, SHORTEST = 1.6, 9
"""Length of a bump with derivatives, in half periods, and fewest samples of it."""
WIDTHS = (5, 9, 15, 25, 41, 65, 101, 161, 257)
"""Samples of the cubics by which the twist is smoothed, of which none takes away more than noise."""
PARTS, AS_NOISE = 8, 1.1
"""Parts of a record, in each of which smoothing takes away no more than this multiple of the noise."""
MEDIAN = 1.4826
"""Standard deviation of normal values over the median of their sizes."""
CLEAR_OF_NOISE = 4.0
"""Rate over its noise below which the twist may be at rest."""
RESTING, MOST_RESTING = 0.05, 0.15
"""Rate over the largest near by below which the twist rests, and the share of a bump at rest from which it is left
out: friction at rest has any torque up to its own."""
JUMPS = 0.3
"""Standard deviation of what friction that turns adds to the rate, over what is known of it."""
OTHER = 0.01
"""Variance that sampling and smoothing leave in each equation by itself, over that by noise."""
ONE_FREQUENCY = 0.02
"""Share of a twist up to which it may miss a motion of one frequency."""
SAME_FREQUENCY = 1.05
"""Ratio of the frequencies of parts of a record up to which they are one."""
NOTED_SHARE = 0.005
"""Share of the stiffness for which the inertia that would take it is told."""
TOO_SHORT = "the twist does not move for long enough to compare it with the equation of motion"
DIFFERENCE = 1e-5
"""Relative step of the unknowns by which residuals are differenced."""


def noise_of_fourth_differences(values: FloatArray) -> float:
    """Standard deviation of the white noise of a smooth signal."""
    # Noise of variance s^2 makes fourth differences of variance (1 + 16 + 36 + 16 + 1) s^2.
    bend = np.diff(values, 4)
    return float(np.sqrt(np.mean(np.clip(bend, *np.quantile(bend, (0.01, 0.99))) ** 2) / 70))


@dataclass(frozen=True, eq=False)
class MeasuredMotion:
    """Twist and torque of a record, with what smoothing leaves of the twist, in SI units.

    Attributes
    ----------
    twist, smooth, rate, bend, torque : (n,) arrays
        rad, rad, rad/s, rad/s^2, N m.
    step : float
        s.
    noise : tuple of float
        Standard deviations of the twist in rad and of the torque in N m from sample to sample.
    ripple : float
        Rate in rad/s that noise makes where nothing moves.
    turning : (n,) array
        Standard deviation of the rate in rad/s by cubics across places where friction turns.
    width, rate_width : int
        Samples of the cubics by which the twist was smoothed, and of those that the rate is from.
    half_period : int
        Samples from a reversal to the next, as a mean.
    """

    twist: FloatArray
    smooth: FloatArray
    rate: FloatArray
    bend: FloatArray
    torque: FloatArray
    step: float
    noise: tuple[float, float]
    ripple: float
    turning: FloatArray
    width: int
    rate_width: int
    half_period: int

    @property
    def frequency(self) -> float:
        """Frequency in Hz of a motion that has one, whatever its amplitudes; 0: it has several."""
        pieces = max(1, min(PARTS, len(self.twist) // (4 * self.half_period)))
        found = [self._frequency(piece) for piece in np.array_split(self.twist, pieces)]
        clear = [frequency for frequency in found if frequency]
        one = len(clear) > pieces / 2 and max(clear) < SAME_FREQUENCY * min(clear)
        return float(np.median(clear)) if one else 0.0

    def _frequency(self, twist: FloatArray) -> float:
        if not np.ptp(twist):
            return 0.0
        around, time = twist - twist.mean(), np.linspace(-1, 1, len(twist))
        # gamma'' = -w^2 (gamma - m) integrated twice, so that noise does not count, beside a mean that moves.
        twice = np.r_[0.0, np.cumsum(np.cumsum(around))[:-1]] * self.step**2
        columns = np.stack([twice / np.abs(twice).max(), *(time**n for n in range(4))], axis=1)
        sizes = np.linalg.lstsq(columns, around, rcond=None)[0]
        left, square = float(np.std(around - columns @ sizes)), -float(sizes[0] / np.abs(twice).max())
        if square <= 0 or left >= np.hypot(ONE_FREQUENCY * float(np.std(around)), 2 * self.noise[0]):
            return 0.0
        # Sums over samples h apart have 2 sin(w h/2)/h in place of w.
        return float(np.arcsin(min(1.0, self.step * np.sqrt(square) / 2))) / (np.pi * self.step)

    @classmethod
    def of(cls, twist: FloatArray, torque: FloatArray, step: float) -> MeasuredMotion:
        noise = noise_of_fourth_differences(twist)
        width = _width(twist, noise)
        smooth = scipy.signal.savgol_filter(twist, width, 3)
        half_period, by_rate = len(twist), width
        for _ in range(2):
            rate, bend = (scipy.signal.savgol_filter(twist, by_rate, 3, deriv=n, delta=step) for n in (1, 2))
            # Slope of a cubic over m samples: variance 75 s^2/(m^3 h^2) in its middle. Slower, the twist may rest.
            ripple = CLEAR_OF_NOISE * float(np.sqrt(75 / by_rate**3)) * noise / step
            moves = np.abs(rate) > ripple
            turns = int(np.count_nonzero(np.diff(np.sign(rate[moves]))))
            half_period = min(half_period, int(np.count_nonzero(moves)) // (turns + 1))
            # The rate tells when friction turns: a third of a half period hardly moves a reversal.
            by_rate = max(width, min(half_period // 6 * 2 + 1, 2 * width - 1))
        # Friction that turns makes a tenth of the fourth differences of a torque large, not half of them.
        spread = noise_of_fourth_differences(torque) if torque.any() else 0.0
        spread = MEDIAN * float(np.median(np.abs(np.diff(torque, 4)))) / 70**0.5 or spread
        # Friction that turns makes a jump B of the acceleration: a cubic over m samples across it adds m h B/30.
        ends = np.arange(len(twist)) + by_rate // 2 * np.array([[1], [-1]])
        after, before = bend[np.clip(ends, 0, len(twist) - 1)]
        added = np.where(np.abs(rate) < np.abs(bend) * step, by_rate * step / 30 * (after - before), 0.0)
        noises, half_period = (noise, spread), max(half_period, 1)
        turning = JUMPS * np.abs(added)
        return cls(
            twist, smooth, rate - added, bend, torque, step, noises, ripple, turning, width, by_rate, half_period
        )


def _through(rows: FloatArray, kernel: FloatArray) -> FloatArray:
    """Weights of noise from weights (n_b, m) of what a filter of odd length makes of it."""
    return np.stack([np.convolve(row, kernel) for row in rows])


def _width(twist: FloatArray, noise: float) -> int:
    """Samples of the cubics by which a twist is smoothed: in no part of it they leave more than its noise."""
    width = WIDTHS[0]
    for narrower, wider in pairwise(WIDTHS):
        left = (twist - scipy.signal.savgol_filter(twist, wider, 3)) if wider < len(twist) // PARTS else None
        if left is None or max(float(np.std(part)) for part in np.array_split(left, PARTS)) > AS_NOISE * noise:
            break
        width = narrower  # with an error by bending a tenth of that of the wider one
    return width


@dataclass(eq=False)
class EquationBlock(MeasurementBlock):
    """Residuals of the equation of motion of an element with laws of motion under bumps along a record.

    Attributes
    ----------
    motion : MeasuredMotion
    places : (n_b,) int array
        First sample of each bump.
    bumps : (4, m) array
        phi for the laws, which adds up to 1; for what stands beside them phi and its derivatives over time.
    """

    has_equations: ClassVar[bool] = True

    motion: MeasuredMotion = field(kw_only=True)
    places: NDArray[np.intp] = field(kw_only=True)
    bumps: FloatArray = field(kw_only=True)
    covariance: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self.covariance = self._noise(self.response.start)

    @property
    def equation(self) -> MotionEquation:
        """Equation of motion of the model."""
        assert isinstance(self.response, MotionEquation)
        return self.response

    @property
    def parts(self) -> int:
        return 1

    @property
    def swings(self) -> FloatArray:
        """Twists in rad, without sign, at which the motion turns back."""
        turns = np.flatnonzero(np.diff(np.sign(self.motion.rate)))
        return np.abs(self.motion.smooth[np.r_[turns, np.argmax(np.abs(self.motion.smooth))]])

    @property
    def without_mass(self) -> bool:
        """Whether no inertia moves in the model, under a torque that is measured."""
        return self.equation.drives and not self.equation.rest_at_start.inertia

    @property
    def remark(self) -> str:
        frequency = self.motion.frequency if self.without_mass else 0.0
        if not frequency:
            return ""
        stiffness, omega = self.typical[2], 2 * np.pi * frequency
        text = (
            f"at one frequency, {frequency:.3g} Hz, a stiffness k is not told from k - J w^2 of an inertia that moves "
            f"between torque and twist: {NOTED_SHARE * stiffness / omega**2:.2g} kg*m^2 would take "
            f"{100 * NOTED_SHARE:g} %; record a second frequency, or give the model the inertia"
        )
        return f"{self.measurement.label}: {text}"

    @property
    def typical(self) -> tuple[float, float, float]:
        """Torque in N m, twist in rad and stiffness in N m/rad that are typical of the record."""
        torque, twist = float(np.abs(self.measured).max()) / 2, float(np.ptp(self.motion.twist)) / 4
        return torque, twist, torque / twist

    @property
    def times(self) -> FloatArray:
        """Times (n_b,) in s of the middles of the bumps."""
        return np.asarray((self.places + self.bumps.shape[1] / 2) * self.motion.step)

    @property
    def frequencies(self) -> FloatArray:
        """Frequency in Hz typical of the motion, for each equation, (n_b,)."""
        return np.full(len(self.places), 0.5 / (self.motion.half_period * self.motion.step))

    @property
    def description(self) -> str:
        return f"{len(self.places)} equations of motion along {len(self.motion.twist) * self.motion.step:.3g} s"

    @cached_property
    def measured(self) -> ComplexArray:
        """Torque of the laws by what was measured, at the start values, N m, (n_b,)."""
        return np.asarray(-self._beside(self.equation.rest_at_start, {}), dtype=complex)

    def predicted(self, values: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        missed, slopes = self._missed(values), np.empty((len(self.places), len(values)))
        for place, value in enumerate(values):
            step = DIFFERENCE * (abs(value) or 1.0)
            if self._names[place] == "delay":
                step = 0.1 * self.motion.step
            ends = [self._missed(np.r_[values[:place], value + move, values[place + 1 :]]) for move in (step, -step)]
            slopes[:, place] = (ends[0] - ends[1]) / (2 * step)
        return self.measured + missed, slopes.astype(complex)

    @property
    def _followed(self) -> FloatArray:
        """Twist (n,) in rad that the laws follow."""
        # Beside a mass, bumps take the noise out. On flanks it would flatten the law that torques are compared with.
        return self.motion.twist if self.bumps[3].any() else self.motion.smooth

    @property
    def _names(self) -> tuple[str, ...]:
        return (*self.response.names, *self.extra)

    def _channel(self, values: FloatArray) -> dict[str, float]:
        return dict(zip(self.extra, values[len(self.response.names) :].tolist(), strict=True))

    def _missed(self, values: FloatArray) -> FloatArray:
        """Torque (n_b,) in N m by which the equation is missed."""
        numbers, motion, extra = values[: len(self.response.names)].tolist(), self.motion, self._channel(values)
        rest = self.equation.rest(numbers)
        # A channel that is late by tau shows x(t - tau): what it stands for is x + tau x', over its gain.
        late, p = extra.get("delay", 0.0), extra.get("gain", 1.0) * rest.output
        twist, rate = (self._followed + late * motion.rate) / p, (motion.rate + late * motion.bend) / p
        laws = self.equation.torque(numbers, twist, rate, motion.step)
        return (self._bumped(laws, 0) + self._beside(rest, extra)) * self._scale(rest, extra)

    def _scale(self, rest: LinearRest, extra: dict[str, float]) -> float:
        """Factor of the equations of a decay: each term grows with inertia and stiffness, and the least is none."""
        at_start = self.equation.rest_at_start
        if self.equation.drives or not at_start.inertia:
            return 1.0
        return float(abs(at_start.inertia / at_start.output * rest.output * extra.get("gain", 1.0) / rest.inertia))

    def _beside(self, rest: LinearRest, extra: dict[str, float]) -> FloatArray:
        """Terms (n_b,) in N m of the linear rest and of the torque."""
        motion = self.motion
        twist = (motion.twist + extra.get("delay", 0.0) * motion.rate) / (extra.get("gain", 1.0) * rest.output)
        terms = -rest.drive * self._bumped(motion.torque, 1)
        for number, factor in enumerate((rest.stiffness, -rest.damping, rest.inertia), 1):
            if factor:
                terms = terms + factor * self._bumped(twist, number)
        if moving := extra.get("moving_inertia", 0.0) / (extra.get("gain", 1.0) * rest.output):
            # Bumps of slow loops have no derivatives.
            terms = terms + moving * self._bumped(self._acceleration, 0)
        return np.asarray(terms)

    @cached_property
    def _acceleration(self) -> FloatArray:
        """Second derivative (n,) of the twist in rad/s^2, of which polynomials of order 5 take hardly any away."""
        motion = self.motion
        return np.asarray(scipy.signal.savgol_filter(motion.twist, max(motion.rate_width, 7), 5, 2, motion.step))

    def _bumped(self, signal: FloatArray, number: int) -> FloatArray:
        return np.asarray(np.correlate(signal, self.bumps[number], "valid")[self.places])

    def _under(self, signal: FloatArray) -> FloatArray:
        """Samples (n_b, m) of a signal under each bump."""
        return np.lib.stride_tricks.sliding_window_view(signal, self.bumps.shape[1])[self.places]

    def _placed(self, rows: FloatArray) -> scipy.sparse.csr_array:
        """Sparse matrix (n_b, n') of rows whose middles are those of the bumps."""
        places = self.places[:, None] + np.arange(rows.shape[1]) + (self.bumps.shape[1] - rows.shape[1]) // 2
        edge, ends = 2 * WIDTHS[-1], np.arange(len(rows) + 1) * rows.shape[1]
        shape = (len(rows), len(self.motion.twist) + 2 * edge)
        return scipy.sparse.csr_array((rows.ravel(), (places + edge).ravel(), ends), shape)

    def _noise(self, numbers: FloatArray, gain: float = 1.0) -> FloatArray:
        """Covariance (n_b, n_b) of the equations by the noise of twist and torque, N^2 m^2."""
        motion, rest = self.motion, self.equation.rest(numbers.tolist())
        by_twist, by_torque = motion.noise
        # Twists of the laws are those measured over p, which the gain of the channel is in.
        output = gain * rest.output
        p = abs(output)
        turning, shift = motion.turning / p, max(by_twist, 1e-6 * float(np.ptp(motion.twist))) / p
        ends = [
            self.equation.torque(numbers.tolist(), self._followed / output + move, motion.rate / output, motion.step)
            for move in (shift, -shift)
        ]
        tangent = (ends[0] - ends[1]) / (2 * shift)
        phi, _, first, second = self.bumps
        weights = (self._under(tangent) + rest.stiffness) * phi - rest.damping * first + rest.inertia * second
        if not self.bumps[3].any():
            # Laws see the smooth twist: neighbours share the noise under its cubics.
            weights = _through(weights, scipy.signal.savgol_coeffs(motion.width, 3))
        # Friction turns when the rate does, which is differenced from the noise, too.
        move = np.hypot(motion.ripple / CLEAR_OF_NOISE / p, turning) + np.finfo(float).tiny ** 0.5
        faster, slower = (
            self.equation.torque(numbers.tolist(), self._followed / output, motion.rate / output + way, motion.step)
            for way in (move, -move)
        )
        slope = (faster - slower) / (2 * move)
        by_rate = _through(
            self._under(slope) * phi, scipy.signal.savgol_coeffs(motion.rate_width, 3, 1, motion.step)[::-1]
        )
        shares: list[Any] = [
            (self._placed(weights) + self._placed(by_rate)) * (by_twist / p),
            self._placed(np.tile(rest.drive * by_torque * phi, (len(weights), 1))),
            self._placed(self._under(slope * turning) * phi),
        ]
        if self.equation.drives:
            # A torque that jumps within the time of a sample is read ahead of the jump or behind it, evenly spread.
            widely = np.abs(motion.bend) * motion.step / p
            ends_of_jump = [
                self.equation.torque(numbers.tolist(), self._followed / output, way, motion.step)
                for way in (motion.rate / output + widely, motion.rate / output - widely)
            ]
            turns = np.abs(motion.rate) < np.abs(motion.bend) * motion.step / 2
            read = np.where(turns, ends_of_jump[0] - ends_of_jump[1], 0.0) / 12**0.5
            shares.append(self._placed(self._under(read) * phi))
        covariance = np.asarray(sum((share @ share.T).toarray() for share in shares))
        least = (1e-9 * float(np.abs(ends[0]).max()) + np.finfo(float).tiny ** 0.5) ** 2
        return covariance + np.diag(OTHER * np.diag(covariance) + least)

    @property
    def deviations(self) -> FloatArray:
        return np.tile(self.sizes, 2)

    @property
    def sizes(self) -> FloatArray:
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @property
    def absolute_scale(self) -> FloatArray:
        return self.sizes

    def residuals(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        predicted, slopes = self.predicted(values)
        # Bumps overlap: L^-1 of the covariance L L^T makes equations of independent noise of them.
        lower = np.linalg.cholesky(self.covariance)
        both = np.column_stack([(predicted - self.measured).real, slopes.real])
        whitened = scipy.linalg.solve_triangular(lower, both, lower=True)
        return np.asarray(whitened[:, 0]), np.asarray(whitened[:, 1:])

    def likely_delay(self, values: FloatArray) -> float:
        del values
        return 0.0  # far below the time of a reversal

    def learn_noise(self, values: FloatArray) -> None:
        """Weigh by the noise of twist and torque at the stiffness, and across turns of the friction, of values."""
        self.covariance = self._noise_at(values)

    def measured_noise(self, values: FloatArray) -> Noise | None:
        """Noise as twist and torque have it from sample to sample, at the stiffness found."""
        return Noise(np.diag(self._noise_at(values)) / np.diag(self.covariance), float(len(self.motion.twist)))

    def _noise_at(self, values: FloatArray) -> FloatArray:
        numbers, extra = values[: len(self.response.names)], self._channel(values)
        scale = self._scale(self.equation.rest(numbers.tolist()), extra)
        return self._noise(numbers, extra.get("gain", 1.0)) * scale**2

    def take_measured_noise(self, noise: Noise) -> None:
        size = np.sqrt(noise.ratio)
        self.covariance = self.covariance * np.outer(size, size)

    def take_noise(self, other: MeasurementBlock, left: float) -> None:
        assert isinstance(other, EquationBlock)
        self.covariance = other.covariance * left

    def with_model(self, rig: AssembledModel, measurement: Measurement, parameters: tuple[str, ...]) -> EquationBlock:
        block = copy(self)
        block.measurement = measurement
        response: Any = _equation(rig, measurement, self.motion, parameters)  # a curve over time, not over frequency
        block.response = response
        return block


def equation_block(
    rig: AssembledModel, measurement: Measurement, data: Recording, parameters: tuple[str, ...]
) -> EquationBlock:
    """Weighted residuals of the equation of motion of a model with laws of motion along a record, ready for a fit.

    Raises
    ------
    UsageError
        Names or a law of motion that the model lacks, more than one mass, or a record without motion.
    """
    twist = data[measurement.output].values
    torque = data[measurement.input].values if measurement.input else np.zeros(len(twist))
    if not (np.isfinite(twist).all() and np.isfinite(torque).all()):
        text = "torque and twist have samples without a value"
        raise UsageError(f"{measurement.label}: {text}", kind="not-finite")
    if len(twist) < 2 * SHORTEST or not np.ptp(twist):
        raise UsageError(f"{measurement.label}: {TOO_SHORT}", kind="too-short")
    motion = MeasuredMotion.of(twist, torque, 1 / data.sampling_rate)
    names = parameters_of_drivetrain(rig, parameters)
    try:
        equation = _equation(rig, measurement, motion, names)
        rest = equation.rest_at_start
    except UsageError as error:
        raise UsageError(f"{measurement.label}: {error}", kind=error.kind) from None
    places, bumps = _bumps(motion, rest, equation.spring)
    places = places[places * motion.step >= measurement.settling]
    places = places[_moves_at(motion, places, bumps.shape[1])]
    if equation.remembers:
        # What the spring held before the record is forgotten once the friction has slipped both ways.
        places = places[places > 2 * motion.half_period]
    if not len(places):
        raise UsageError(f"{measurement.label}: {TOO_SHORT}", kind="too-short")
    response: Any = equation
    return EquationBlock(measurement, response, motion=motion, places=places, bumps=bumps)


def _equation(
    rig: AssembledModel, measurement: Measurement, motion: MeasuredMotion, parameters: tuple[str, ...]
) -> MotionEquation:
    output, into = measurement.model_output or measurement.output, measurement.model_input or measurement.input
    typical = float(np.ptp(motion.twist)) / 2, 0.5 / (motion.half_period * motion.step)
    return motion_equation(rig, output, into, measurement.excitation, parameters, typical)


def _bumps(motion: MeasuredMotion, rest: LinearRest, spring: float) -> tuple[NDArray[np.intp], FloatArray]:
    """First samples of all bumps, and phi with its derivatives; ``spring`` in N m/rad is typical of the laws."""
    n, edge = len(motion.twist), motion.width // 2 + 1
    free = n - 2 * edge
    whole = abs(rest.inertia) + abs(rest.damping) > 0 and not _negligible(motion, rest)
    if not whole:
        m = max(1, -(-free // MOST_ROWS))
        return edge + m * np.arange(free // m), np.outer([1, 1, 0, 0], np.full(m, 1 / m))
    # Where a slow torque drives, a bump as long as a half period of the free vibration tells more of stages.
    own = np.pi * np.sqrt(abs(rest.inertia) / max(spring + rest.stiffness, 1e-300)) / motion.step
    m = min(max(round(LENGTH * min(motion.half_period, own)), SHORTEST), free)
    hop = max(m // OVERLAP, -(-(free - m) // MOST_ROWS), 1)
    x, half = (2 * np.arange(m) + 1 - m) / (m + 1), (m + 1) * motion.step / 2
    phi = np.polynomial.Polynomial([1, 0, -1]) ** POWER
    each = [phi.deriv(n)(x) / half**n for n in range(5)]
    # Laws are means over the time of a sample, and so is, to the second order, all that stands beside them.
    spread = motion.step**2 / 24
    beside = [each[n] + spread * each[n + 2] for n in range(3)]
    return edge + hop * np.arange((free - m) // hop + 1), np.stack([each[0], *beside]) / each[0].sum()


def _negligible(motion: MeasuredMotion, rest: LinearRest) -> bool:
    """Whether no mass moves: its torque is rounding."""
    torques = (rest.inertia * motion.bend, rest.damping * motion.rate)
    return max(float(np.abs(torque).max()) for torque in torques) <= 1e-9 * max(
        float(np.abs(motion.torque).max()), 1e-12
    )


def _moves_at(motion: MeasuredMotion, places: NDArray[np.intp], m: int) -> NDArray[np.bool_]:
    """Whether the twist moves under each bump, but for reversals."""
    speed = np.abs(motion.rate)
    near = scipy.ndimage.maximum_filter1d(speed, 2 * max(motion.half_period, m) + 1)
    rests = speed < np.maximum(RESTING * near, motion.ripple)
    if m < motion.half_period:  # of a triangle, cubics round the corners
        rests = scipy.ndimage.maximum_filter1d(rests, motion.width)
    resting = np.r_[0, np.cumsum(rests)]
    return np.asarray((resting[places + m] - resting[places]) <= MOST_RESTING * m)
