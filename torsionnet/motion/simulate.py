"""Motion over time under sampled torques, exact for each course that these may have from sample to sample.

Each triangular block of the first-order system is stepped by its own matrix exponential, the last state first:

    z[n+1] = exp(T h) z[n] + G_0 u[n] + G_1 u[n+1]

where torques are straight, and with u[n] alone where they are held; band-limited ones are read at Gauss points. This is
a recursive filter for every state, driven by the states after it. No step size, no iteration, no drift.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.between_samples import ASYMPTOTE_RATES, Between
from torsionnet.linear.dynamic_stiffness.state_space import first_order, output_matrices
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, resolve_request
from torsionnet.linear.dynamic_stiffness.triangular import DiagonalBlock, blocks
from torsionnet.linear.responses.by_spectrum import by_spectrum
from torsionnet.linear.responses.transfer import responses
from torsionnet.model.channels import Channels, Sensor
from torsionnet.motion.delayed_motion import delayed_response
from torsionnet.motion.torque_courses import TorqueCourses, torque_courses
from torsionnet.signals.recording import Recording, Signal

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
        raise UsageError("a simulation is driven by torques: name inputs or nodes on which they act")
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
    found: list[Between] = ["band_limited"] * len(request.outputs)
    torques = [number for number, reading in enumerate(request.outputs) if QUANTITIES[reading.unit] == "torque"]
    if torques and set(between) != {"band_limited"}:
        far = np.abs(responses([drivetrain], request, np.array(ASYMPTOTE_RATES) * sampling_rate, "graph").values[0])
        for number in torques:
            direct = np.flatnonzero(far[1, number] > DIRECT_SHARE * far[0, number])
            found[number] = between[direct[0]] if len(direct) else "band_limited"
    return found


def response_over_time(
    drivetrain: AssembledModel, request: TransferRequest, torques: TorqueCourses, sampling_rate: float
) -> FloatArray:
    """Readings (n_out, n) in SI units over time under sampled torques (n_in, n) in N m, from rest."""
    if drivetrain.assembly.system.dynamic:
        return by_spectrum(drivetrain, request, torques.samples, torques.between, sampling_rate)
    if any(one.delay for one in drivetrain.assembly.system.actions):
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
