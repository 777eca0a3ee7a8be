"""Motion over time under sampled torques, exact for each course that these may have from sample to sample.

Each triangular block of the first-order system is stepped by its own matrix exponential, the last state first:

    z[n+1] = exp(T h) z[n] + G_0 u[n] + G_1 u[n+1]

where torques are straight, and with u[n] alone where they are held; band-limited ones are read at Gauss points. This is
a recursive filter for every state, driven by the states after it. No step size, no iteration, no drift.

Motion over time of a drivetrain where torques of controllers act with a delay. The torque of a delayed controller
follows from the motion one delay ago, so that it is known in advance and acts like a torque from outside (the method of
steps). States go from point to point by the exact transition for torques that run straight between points; delayed
torques are read between points by cubics. The error falls with the square of the step: it is taken out by extrapolation
from two steps, and what that leaves is estimated from a third.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError, warn_user
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.between_samples import ASYMPTOTE_RATES, Between
from torsionnet.linear.dynamic_stiffness.action_states import LawStates, refuse_delayed_acceleration, undelayed_states
from torsionnet.linear.dynamic_stiffness.state_space import (
    NEGLIGIBLE_COEFFICIENT,
    StateSpaceForm,
    first_order,
    output_matrices,
)
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, resolve_request
from torsionnet.linear.dynamic_stiffness.triangular import DiagonalBlock, blocks
from torsionnet.linear.responses.by_spectrum import by_spectrum
from torsionnet.linear.responses.transfer import responses
from torsionnet.model.channels import Channels, Sensor
from torsionnet.motion.torque_courses import TorqueCourses, first_order_hold, torque_courses
from torsionnet.signals.recording import Recording, Signal

# Motion over time of a drivetrain where torques of controllers act with a delay.

MOST_TIME_STEPS = 400_000
"""Most time steps of all passes of a simulation with delays together, which bounds its duration since steps run one by
one in Python."""
FEWEST_STEPS_PER_DELAY = 3
"""Fewest time steps in the shortest delay, so that the cubic that reads a delayed torque ends before the current
point."""
ERROR_TOLERANCE = 1e-6
"""Estimated error of a simulation with delays, over the largest reading, at which the time step is halved no more."""
ERROR_WARNED = 1e-4
"""Estimated error of a simulation with delays, over the largest reading, above which a warning gives it."""


@dataclass(frozen=True)
class DelayedForm:
    """State space in SI with delayed torques T, x' = A x + B [u, T], y = C x + D [u, T], and the matrices for T itself.

    These give T(t + delay) = E x + F [u, T].
    """

    A: FloatArray
    B: FloatArray
    C: FloatArray
    D: FloatArray
    E: FloatArray
    F: FloatArray
    delays: FloatArray


def delayed_response(
    drivetrain: AssembledModel, request: TransferRequest, torques: TorqueCourses, sampling_rate: float
) -> FloatArray:
    """Readings (n_out, n) in SI units over time under torques (n_in, n) in N m, with delayed controllers.

    Raises
    ------
    UsageError
        The delays are too short against the time asked for, or a law has no motion over time.
    """
    form, h, n = _form(drivetrain, request), 1 / sampling_rate, torques.samples.shape[1]
    fineness = max(1, math.ceil(FEWEST_STEPS_PER_DELAY * h / form.delays.min()))
    used = 3 * fineness * n
    if used > MOST_TIME_STEPS:
        text = (
            f"the shortest delay, {form.delays.min():.3g} s, needs more than {MOST_TIME_STEPS} steps over {n * h:.3g} s"
        )
        raise UsageError(f"{text}; simulate a shorter time", kind="too-large")
    last = _delayed_steps(form, torques, h, fineness)
    best, error = last, math.inf
    while error > ERROR_TOLERANCE and used <= MOST_TIME_STEPS:
        fineness *= 2
        finer = _delayed_steps(form, torques, h, fineness)
        # Richardson: the error falls as h^2, so that x_h/2 + (x_h/2 - x_h)/3 is free of that term.
        extrapolated = finer + (finer - last) / 3
        sizes = np.abs(extrapolated).max(axis=1, keepdims=True)
        error = float((np.abs(extrapolated - best) / np.where(sizes > 0, sizes, 1.0)).max(initial=0.0))
        last, best, used = finer, extrapolated, used + 2 * fineness * n
    if error > ERROR_WARNED:
        text = f"with delays, readings are right to about {100 * error:.2g} % of their largest value"
        warn_user(f"{text}; a higher sampling rate or a shorter time gives more digits")
    return best


def _form(drivetrain: AssembledModel, request: TransferRequest) -> DelayedForm:
    assembly = drivetrain.assembly
    laws = [undelayed_states(assembly, law) for law in assembly.system.actions]
    opened = [law for law in laws if law.action.delay]
    for law in opened:
        refuse_delayed_acceleration(law)
    form = first_order(
        assembly, request.excitations, closing=[law for law in laws if not law.action.delay], opened=opened
    )
    # Below the drivetrain's states those of each delayed controller, z' = F z + G (y, y')^T.
    sizes = np.cumsum([len(form.A), *(len(law.F) for law in opened)])
    A, B = np.zeros((sizes[-1], sizes[-1])), np.zeros((sizes[-1], form.B.shape[1]))
    n = len(form.A)
    A[:n, :n], B[:n] = form.A, form.B
    E, F = np.zeros((len(opened), sizes[-1])), np.zeros((len(opened), form.B.shape[1]))
    for place, law in enumerate(opened):
        own = slice(sizes[place], sizes[place + 1])
        y, direct, rate, rate_direct = _sensed(law, form)
        A[own, own] = law.F
        A[own, :n] = np.outer(law.G[:, 0], y) + np.outer(law.G[:, 1], rate)
        B[own] = np.outer(law.G[:, 0], direct) + np.outer(law.G[:, 1], rate_direct)
        # Its torque before the delay is H z + the shares of y and y' that act at once.
        E[place, own], E[place, :n] = law.H, law.at_once[0] * y + law.at_once[1] * rate
        F[place] = law.at_once[0] * direct + law.at_once[1] * rate_direct
    C, D = output_matrices(assembly, request.outputs, request.excitations, form, opened)
    C = np.hstack([C, np.zeros((len(C), sizes[-1] - n))])
    return DelayedForm(A, B, C, D, E, F, np.array([float(law.action.delay) for law in opened]))


def _sensed(law: LawStates, form: StateSpaceForm) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Sensed angle y and its rate y' of a controller, as rows over states and over torques (y_x, y_u, y'_x, y'_u)."""
    y, direct = law.sensed @ form.X, law.sensed @ form.U
    uses_rate = law.at_once[1] or law.G[:, 1].any()
    if uses_rate and np.abs(direct).max(initial=0.0) > NEGLIGIBLE_COEFFICIENT * np.abs(form.U).max(initial=0.0):
        text = "senses the rate of a motion without inertia and damper, which follows the rate of a torque"
        raise UsageError(f"{law.action.owner} {text}; give its nodes inertia or dampers", kind="indeterminate-motion")
    return y, direct, y @ form.A, y @ form.B


def _delayed_steps(form: DelayedForm, torques: TorqueCourses, h: float, fineness: int) -> FloatArray:
    """Readings (n_out, n) in SI units at the samples, with ``fineness`` time steps from each to the next."""
    n_in, n = torques.samples.shape
    count, step = (n - 1) * fineness + 1, h / fineness
    inside = torques.within(np.arange(fineness + 1) / fineness)
    drive = np.hstack([inside[:, :, :-1].reshape(n_in, -1), torques.samples[:, -1:]])
    ends = inside[:, :, 1:].reshape(n_in, -1).T
    # x(t + h) = exp(A h) x + weights of u at both ends, exact for inputs that are straight in between.
    passage, before, after = (part.real for part in first_order_hold(form.A, form.B, step))
    weights = [_Between(delay / step) for delay in form.delays]
    x, asked = np.zeros(len(form.A)), np.zeros((count, len(form.delays)))
    u = np.concatenate([drive, np.zeros((len(form.delays), count))]).T.copy()
    states = np.zeros((n, len(x)))
    for point in range(count):
        # Controllers act now with what they asked for one delay ago, which is solved already.
        for number, delayed in enumerate(weights):
            u[point, n_in + number] = delayed.read(asked[:, number], point)
        if point:
            end = np.concatenate([ends[point - 1], u[point, n_in:]])
            x = passage @ x + before @ u[point - 1] + after @ end
        asked[point] = form.E @ x + form.F @ u[point]
        if point % fineness == 0:
            states[point // fineness] = x
    return np.asarray(form.C @ states.T + form.D @ u[::fineness].T)


class _Between:
    """Interpolator of a signal ``ago`` points back in time, by the cubic through four points.

    The signal is zero before the first point.
    """

    def __init__(self, ago: float) -> None:
        whole = math.ceil(ago - 1e-9)
        self.back, self.share = whole, max(0.0, whole - ago)
        self.inner, self.first = _lagrange(self.share + 1), _lagrange(self.share)

    def read(self, signal: FloatArray, point: int) -> float:
        place = point - self.back
        if place < 0:
            return 0.0
        if place == 0:
            return float(self.first @ signal[:4])
        return float(self.inner @ signal[place - 1 : place + 3])


def _lagrange(x: float) -> FloatArray:
    """Weights (4,) of the values at 0, 1, 2 and 3 in the value at x, interpolated by a cubic."""
    return np.array([
        # l_j(x) = product over m != j of (x - m)/(j - m)
        -(x - 1) * (x - 2) * (x - 3) / 6,
        x * (x - 2) * (x - 3) / 2,
        -x * (x - 1) * (x - 3) / 2,
        x * (x - 1) * (x - 2) / 6,
    ])  # fmt: skip


QUANTITIES = {"N*m": "torque", "rad": "angle", "rad/s": "velocity", "rad/s^2": "acceleration", "Pa": "stress"}
"""Quantity of a simulated signal, such as torque, by the unit of its reading."""
DIRECT_SHARE = 0.9
"""Share that is left of a response at twice a very high frequency above which it is constant there; masses halve it."""


def simulate_linear(
    drivetrain: AssembledModel,
    outputs: Channels,
    inputs: Mapping[str, ArrayLike | Signal],
    sampling_rate: float,
    between: str | Mapping[str, str] | None = None,
) -> Recording:
    """Recording of torques and simulated motions of a drivetrain, in SI units over time, from rest.

    See :meth:`torsionnet.Drivetrain.simulate`.
    """
    torques = torque_courses(inputs, between)
    request = driven_request(drivetrain, outputs, inputs)
    motion = response_over_time(drivetrain, request, torques, sampling_rate)
    signals = motion_signals(drivetrain, request, inputs, torques.samples, motion, torques.between)
    read = reading_courses(drivetrain, request, torques.between, sampling_rate)
    read_so = zip(signals[-len(read) :], read, strict=True)
    signals = (*signals[: -len(read)], *(replace(signal, between=way) for signal, way in read_so))
    notes = (
        phrase("simulated: {model}, at rest before the first sample", model=drivetrain.title),
        *read_notes(drivetrain, sampling_rate),
    )
    return Recording(signals, sampling_rate, title=drivetrain.title, notes=notes)


def driven_request(drivetrain: AssembledModel, outputs: Channels, inputs: Iterable[str]) -> TransferRequest:
    """Request of a simulation, whose inputs are torques.

    Raises
    ------
    UsageError
        Unknown names, or inputs that are no torques.
    """
    asked = [outputs] if isinstance(outputs, str | Sensor) else list(outputs)
    request = resolve_request(drivetrain, asked, list(inputs), None)
    if request.is_measured or any(source.quantity != "torque" for source in request.excitations):
        raise UsageError(
            "a simulation is driven by torques: name inputs or nodes on which they act", kind="missing-entry"
        )
    return request


def motion_signals(
    drivetrain: AssembledModel,
    request: TransferRequest,
    inputs: Iterable[str],
    torques: FloatArray,
    motion: FloatArray,
    between: Sequence[Between] = (),
) -> tuple[Signal, ...]:
    """Signals of the torques (n_in, n) and of the readings (n_out, n) of a simulation, in SI units.

    The torques run straight between samples unless ``between`` has their courses.
    """
    names = (
        name if name in drivetrain.inputs else str(source)
        for name, source in zip(inputs, request.excitations, strict=True)
    )
    ways = between or ["straight"] * len(torques)
    every = zip(names, torques, ways, strict=True)
    driven = (Signal(name, "torque", torque, between=way) for name, torque, way in every)
    read = (
        Signal(reading.name, QUANTITIES[reading.unit], values)
        for reading, values in zip(request.outputs, motion, strict=True)
    )
    return (*driven, *read)


def reading_courses(
    drivetrain: AssembledModel, request: TransferRequest, between: Sequence[Between], sampling_rate: float
) -> list[Between]:
    """Courses of the readings between samples: a torque that steps or bends with one that drives runs as that does.

    Others have so little above half the sampling rate as the masses before them let through.
    """
    courses: list[Between] = ["band_limited"] * len(request.outputs)
    torques = [number for number, reading in enumerate(request.outputs) if QUANTITIES[reading.unit] == "torque"]
    if torques and set(between) != {"band_limited"}:
        far = np.abs(responses([drivetrain], request, np.array(ASYMPTOTE_RATES) * sampling_rate, "graph").values[0])
        for number in torques:
            direct = np.flatnonzero(far[1, number] > DIRECT_SHARE * far[0, number])
            courses[number] = between[direct[0]] if len(direct) else "band_limited"
    return courses


def response_over_time(
    drivetrain: AssembledModel, request: TransferRequest, torques: TorqueCourses, sampling_rate: float
) -> FloatArray:
    """Readings (n_out, n) in SI units over time under sampled torques (n_in, n) in N m, from rest."""
    if drivetrain.assembly.system.dynamic:
        return by_spectrum(drivetrain, request, torques.samples, torques.between, sampling_rate)
    if any(action.delay for action in drivetrain.assembly.system.actions):
        return delayed_response(drivetrain, request, torques, sampling_rate)
    system = first_order(drivetrain.assembly, request.excitations)
    C, D = output_matrices(drivetrain.assembly, request.outputs, request.excitations, system)
    motion = D @ torques.samples
    for block in blocks(system.A, system.B, C):
        motion += _stepped(block, torques, 1 / sampling_rate)
    return np.asarray(motion)


def read_notes(drivetrain: AssembledModel, sampling_rate: float) -> tuple[str, ...]:
    """Notes on tables over frequency that end before the spectrum of torques at a sampling rate in Hz does."""
    return range_notes(drivetrain.assembly, [0, sampling_rate / 2])


def _stepped(block: DiagonalBlock, torques: TorqueCourses, h: float) -> FloatArray:
    """Contribution (n_out, n) of one uncoupled block of states to the outputs over time, in SI units."""
    from scipy.signal import lfilter

    step, gains = torques.gains(block, h)
    outputs = np.zeros((len(block.C), torques.samples.shape[1]))
    known: dict[int, ComplexArray] = {}
    for state in range(len(step) - 1, -1, -1):
        drive = np.zeros(outputs.shape[1], dtype=complex)
        drive[1:] = gains[state]
        for other, values in known.items():
            drive[1:] += step[state, other] * values[:-1]
        values = lfilter([1.0], [1.0, -step[state, state]], drive)
        if not block.is_diagonal:
            known[state] = values
        for output, weight in enumerate(block.C[:, state]):
            outputs[output] += weight.real * values.real - weight.imag * values.imag
    return outputs
