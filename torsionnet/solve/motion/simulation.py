"""Simulation of drivetrains, linear ones in one way from rest and those with laws of motion from event to event."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.typing import ArrayLike

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import UsageError
from torsionnet.model.channels import Sensor
from torsionnet.response.motion.motion_start import MotionStart
from torsionnet.response.recording import Recording, is_rate
from torsionnet.solve.motion.motion_plant import has_laws_of_motion, motion_plant
from torsionnet.solve.motion.piece_system import simulate_motion
from torsionnet.solve.running.simulate import driven_request, motion_signals, sampled_torques
from torsionnet.solve.running.simulate import simulate as simulate_linear

REST = "rest"


def simulate(
    drivetrain: AssembledModel,
    outputs: str | Sensor | Sequence[str | Sensor],
    inputs: Mapping[str, ArrayLike],
    sampling_rate: float,
    start: str | MotionStart = REST,
) -> Recording:
    """Recording of torques and simulated motions of a drivetrain, in SI units over time.

    See :meth:`torsionnet.Drivetrain.simulate`.
    """
    if isinstance(start, str) and start != REST:
        raise UsageError(f'a simulation starts from "{REST}" or from a MotionStart, got "{start}"')
    if start == REST and not has_laws_of_motion(drivetrain):
        return simulate_linear(drivetrain, outputs, inputs, sampling_rate)
    torques = sampled_torques(inputs)
    if not is_rate(sampling_rate):
        raise UsageError(f"the sampling rate must be a positive number of Hz, got {sampling_rate}")
    plant = motion_plant(drivetrain)
    request = driven_request(plant.drivetrain, outputs, inputs)
    given = start if isinstance(start, MotionStart) else MotionStart()
    motion = simulate_motion(plant, request.outputs, request.excitations, torques, sampling_rate, start=given)
    signals = motion_signals(drivetrain, request, inputs, torques, motion.values)
    begun = "at rest before the first sample" if start == REST else "from a given state"
    notes = (f"simulated: {drivetrain.title}, {begun}",)
    return Recording(
        signals, sampling_rate, title=drivetrain.title, notes=notes, events=motion.events, energy=motion.energy
    )
