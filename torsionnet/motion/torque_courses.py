"""Sampled torques of a simulation with their course between samples, and their values at any place there.

Motion over time under torques of straight lines and waves that may decay, exact at every sample. What a torque is made
of follows linear equations of its own: a straight line (v, s) has v' = s, s' = 0, and a wave w' = s w. With these
states after those of the drivetrain, z' = A z, and z(t + h) = exp(A h) z(t) from sample to sample; at a time between
samples at which a torque changes its form, its states start anew.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.between_samples import Between, check_between
from torsionnet.linear.dynamic_stiffness.state_space import first_order, output_matrices
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest
from torsionnet.linear.dynamic_stiffness.triangular import DiagonalBlock
from torsionnet.machinery.passage.passage_torques import gauss_points, step_weights
from torsionnet.motion.scenarios.time_history import TimeHistory, first_sample
from torsionnet.signals.recording import Signal

BEYOND = 256
"""Most samples by which a band-limited torque goes on beyond its ends, reflected about them, and fades out: what it is
there no longer matters between the samples."""
GAUSS_POINTS = 12
"""Gauss points of a sampling interval, which hold half a period, the shortest of a band-limited torque, to rounding."""


@dataclass(frozen=True, eq=False)
class TorqueCourses:
    """Sampled torques (n_in, n) in N m, each with its course between samples."""

    samples: FloatArray
    between: tuple[Between, ...]

    def within(self, places: FloatArray) -> FloatArray:
        """Values (n_in, n - 1, n_places) in N m at places from 0 to 1 in every interval; a step counts after it."""
        first, last = self.samples[:, :-1, None], self.samples[:, 1:, None]
        values = np.repeat(first, len(places), axis=2)
        for number, way in enumerate(self.between):
            if way == "straight":
                values[number] = first[number] * (1 - places) + last[number] * places  # exact at both ends
            elif way == "band_limited":
                values[number] = _band_limited(self.samples[number], places)
        return values

    def gains(self, block: DiagonalBlock, h: float) -> tuple[ComplexArray, ComplexArray]:
        """Matrix exp(T h) of a block of states, and what the torques add to its states in steps of h seconds.

        The shapes are (n_x, n_x) and (n_x, n - 1). Gauss's rule would be exact for straight lines, too; their own
        matrices cost less.
        """
        if "band_limited" in self.between:
            diagonal = block.is_diagonal
            step, weights = step_weights(block.T, h, GAUSS_POINTS, diagonal=diagonal)
            pushed = np.tensordot(block.B, self.within(gauss_points(GAUSS_POINTS)), axes=1)
            added = np.einsum("jk,knj->kn" if diagonal else "jkl,lnj->kn", weights, pushed)
            return (np.diag(step) if diagonal else step), added
        step, before, after = first_order_hold(block.T, block.B, h)
        ends = self.within(np.array([0.0, 1.0]))
        return step, before @ ends[:, :, 0] + after @ ends[:, :, 1]


def torque_courses(
    inputs: Mapping[str, ArrayLike | Signal], between: str | Mapping[str, str] | None = None
) -> TorqueCourses:
    """Sampled torques of a simulation from lists or signals by input, in N m, with their courses between samples.

    Signals run as they say, lists straight, unless ``between`` says otherwise, for all inputs or by name.

    Raises
    ------
    UsageError
        They are no finite numbers, or of unlike lengths; unknown courses or names.
    """
    asked = between if isinstance(between, Mapping) else dict.fromkeys(inputs, between)
    for name in asked:
        if name not in inputs:
            hint = f"{did_you_mean(name, inputs)}; the torques are {', '.join(inputs)}"
            raise UsageError(f'between= names "{name}", which is no torque that acts{hint}', kind="unknown-channel")
    ways = tuple(check_between(asked.get(name) or _own_course(torque)) for name, torque in inputs.items())
    listed = [torque.values if isinstance(torque, Signal) else torque for torque in inputs.values()]
    try:
        torques = np.array([np.asarray(values, dtype=float) for values in listed])
    except (TypeError, ValueError):
        torques = np.array(np.nan)
    if torques.ndim != 2 or not torques.size or not np.isfinite(torques).all():
        raise UsageError(
            "the torques of a simulation are lists of finite numbers in N m by input, all of one length",
            kind="wrong-form",
        )
    return TorqueCourses(torques, ways)


def _own_course(torque: ArrayLike | Signal) -> Between:
    """Course of a list, or of a signal: one brought to another rate is what the filter has left, which is smooth."""
    if not isinstance(torque, Signal):
        return "straight"
    return "band_limited" if torque.course_rate else torque.between


def _band_limited(values: FloatArray, places: FloatArray) -> FloatArray:
    """Values (n - 1, n_places) of a band-limited signal (n,) at places from 0 to 1 in every interval, in its unit."""
    n = len(values)
    beyond = min(n - 1, BEYOND)
    if not beyond:
        return np.zeros((0, len(places)))
    # Beyond its ends the record is reflected about them, which keeps value and slope there, and fades out.
    wide = np.pad(values, beyond, mode="reflect", reflect_type="odd")
    fading = np.sin(np.pi / 2 * np.arange(1, beyond + 1) / (beyond + 1)) ** 2
    wide[:beyond] *= fading
    wide[-beyond:] *= fading[::-1]
    size = int(scipy.fft.next_fast_len(len(wide), real=True))
    spectrum, turns = np.fft.rfft(wide, size), 2j * np.pi * np.fft.rfftfreq(size)
    # A factor e^(j omega place) moves the record by that part of an interval.
    shifted = [np.fft.irfft(spectrum * np.exp(turns * place), size)[beyond : beyond + n - 1] for place in places]
    return np.stack(shifted, axis=1)


def first_order_hold(
    A: FloatArray | ComplexArray, B: FloatArray | ComplexArray, h: float
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Matrices exp(A h), G_0 and G_1 by which a state steps on by h seconds, under torques linear in between."""
    n, n_in = B.shape
    # exp of [[A, B, 0], [0, 0, I], [0, 0, 0]] h holds the integrals over torques that run straight (Van Loan).
    whole = np.zeros((n + 2 * n_in, n + 2 * n_in), dtype=complex)
    whole[:n, :n], whole[:n, n : n + n_in] = A * h, B * h
    whole[n : n + n_in, n + n_in :] = np.eye(n_in)
    power = np.asarray(scipy.linalg.expm(whole), dtype=np.complex128)
    # x(h) = exp(A h) x + G_0 u_0 + G_1 u_1, with u straight from u_0 to u_1.
    after = power[:n, n + n_in :]
    return power[:n, :n], power[:n, n : n + n_in] - after, after


# Motion over time under torques of straight lines and waves that may decay, exact at every sample.

BLOCK = 256
"""Samples that are calculated together: enough that products of matrices cost more than the calls that make them, and
few enough to fit in the cache with some hundred states."""
STEADY_TOLERANCE = 1e-6
"""Residual of a motion without vibration, over the largest of its terms, above which there is no such motion: rounding
in matrices of stiff drivetrains leaves less."""


@dataclass(frozen=True, eq=False)
class DrivenForm:
    """State equations z' = A z, y = C z of a drivetrain with its torques among the states, in SI units.

    Attributes
    ----------
    A : (n_z, n_z) array
    C : (n_out, n_z) array
    n_x : int
        Number of the states of the drivetrain, which come first.
    waves : tuple of (int, complex)
        Input and exponent in 1/s of every wave, whose two states follow those of the straight lines.
    """

    A: FloatArray
    C: FloatArray
    n_x: int
    waves: tuple[tuple[int, complex], ...]

    def started(self, x: FloatArray, histories: Sequence[TimeHistory], time: float) -> FloatArray:
        """State z (n_z,) with the torques as they are from a time in s on, and states x (n_x,) of the drivetrain."""
        z = np.zeros(len(self.A))
        z[: self.n_x] = x
        for number, history in enumerate(histories):
            piece = history.piece_at(time).begun(time)
            z[self.n_x + 2 * number], z[self.n_x + 2 * number + 1] = piece.value, piece.slope
            for wave in piece.waves:
                place = self.n_x + 2 * len(histories) + 2 * self.waves.index((number, wave.exponent))
                z[place] += wave.amplitude.real
                z[place + 1] += wave.amplitude.imag
        return z


def exact_response(
    drivetrain: AssembledModel,
    request: TransferRequest,
    histories: Sequence[TimeHistory],
    rate: float,
    count: int,
    *,
    steady: bool = False,
) -> FloatArray:
    """Readings (n_out, count) in SI units at ``rate`` Hz from 0 s under torques over time in N m, one for each input.

    From rest, or with ``steady`` from the motion without vibration under the torques at 0 s, in which what turns
    freely may gain speed.

    Raises
    ------
    UsageError
        Frequency-dependent laws, delays, or no motion without vibration.
    """
    system = first_order(drivetrain.assembly, request.excitations)
    C, D = output_matrices(drivetrain.assembly, request.outputs, request.excitations, system)
    form = _driven(system.A, system.B, C, D, histories)
    x = np.zeros(form.n_x)
    if steady:
        x = _steady_state(system.A, system.B @ np.array([history.first for history in histories]))
    return _march(form, x, histories, rate, count)


def _driven(A: FloatArray, B: FloatArray, C: FloatArray, D: FloatArray, histories: Sequence[TimeHistory]) -> DrivenForm:
    waving = {
        (number, wave.exponent): None
        for number, history in enumerate(histories)
        for piece in history.pieces
        for wave in piece.waves
    }
    waves, n_x, n_u = tuple(waving), len(A), len(histories)
    whole, read = np.zeros((n_x + 2 * n_u + 2 * len(waves),) * 2), np.zeros((len(C), n_x + 2 * n_u + 2 * len(waves)))
    whole[:n_x, :n_x], read[:, :n_x] = A, C
    # A straight line is a level with level' = slope, slope' = 0.
    for number in range(n_u):
        level = n_x + 2 * number
        whole[:n_x, level], read[:, level] = B[:, number], D[:, number]
        whole[level, level + 1] = 1.0
    # d/dt of (Re, Im) A exp((a + jb) t) = [[a, -b], [b, a]] (Re, Im)
    for place, (number, exponent) in enumerate(waves):
        real = n_x + 2 * n_u + 2 * place
        whole[:n_x, real], read[:, real] = B[:, number], D[:, number]
        own = slice(real, real + 2)
        whole[own, own] = [[exponent.real, -exponent.imag], [exponent.imag, exponent.real]]
    return DrivenForm(whole, read, n_x, waves)


def _march(form: DrivenForm, x: FloatArray, histories: Sequence[TimeHistory], rate: float, count: int) -> FloatArray:
    from scipy.linalg import expm

    def passed(z: FloatArray, time: float) -> FloatArray:
        return np.asarray(expm(form.A * time) @ z) if time else z

    values = np.zeros((len(form.C), count))
    end = (count - 1) / rate
    starts = [0.0, *sorted({time for history in histories for time in history.breaks if 0 < time <= end})]
    # Between breaks of the histories z' = A z, exact by exp(A t); at a break the rows of the histories start anew.
    step = np.asarray(expm(form.A / rate))
    for start, following in zip(starts, [*starts[1:], np.inf], strict=True):
        z = form.started(x, histories, start)
        begin = first_sample(start, rate)
        until = count if following == np.inf else min(count, first_sample(following, rate))
        last, at = start, z
        if until > begin:
            at = passed(z, begin / rate - start)
            values[:, begin:until], at = _marched(form, step, at, until - begin)
            last = (until - 1) / rate
        if following != np.inf:
            x = passed(at, following - last)[: form.n_x]
    return values


def _marched(form: DrivenForm, step: FloatArray, z: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Readings (n_out, count) at samples from a state z on, and the state (n_z,) at the last of them."""
    states, power = z[:, None], step
    # States at n samples times exp(A n / rate) are those at the n after them.
    while states.shape[1] < min(BLOCK, count):
        states = np.hstack([states, power @ states])
        power = power @ power
    width, values = states.shape[1], np.zeros((len(form.C), count))
    for begin in range(0, count, width):
        if begin:
            states = power @ states
        held = min(width, count - begin)
        values[:, begin : begin + held] = form.C @ states[:, :held]
    return values, states[:, (count - 1) % width]


def _steady_state(A: FloatArray, push: FloatArray) -> FloatArray:
    """States (n_x,) from which constant torques, with B u = ``push``, make no vibration.

    That motion is x_0 + x_1 t + x_2 t^2/2 with x_1 = A x_0 + B u, x_2 = A x_1 and A x_2 = 0: at rest, at a steady speed
    or with a steady acceleration.

    Raises
    ------
    UsageError
        There is none, as of a drivetrain that feeds its vibration.
    """
    n = len(A)
    powers = [A, A @ A, A @ A @ A]
    # x_0 with A x_0 = -B u, else A^2 x_0 = -A B u, else A^3 x_0 = -A^2 B u: at rest, a speed, an acceleration.
    for order, power in enumerate(powers):
        scale = np.abs(power).max(axis=1, initial=1e-300)
        aim = -(np.linalg.matrix_power(A, order) @ push)
        x, *_ = np.linalg.lstsq(power / scale[:, None], aim / scale, rcond=None)
        missed = np.abs(power @ x - aim)
        if (missed <= STEADY_TOLERANCE * (np.abs(power) @ np.abs(x) + np.abs(aim)).max(initial=1e-300)).all():
            return np.asarray(x) if n else np.zeros(0)
    raise UsageError(
        "under the torques at its start the drivetrain has no motion without vibration; start from rest",
        kind="no-solution",
    )
