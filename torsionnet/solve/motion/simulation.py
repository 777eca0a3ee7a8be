"""Simulation of drivetrains, linear ones in one way from rest and those with laws of motion from event to event."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.rows import FloatArray
from torsionnet.core.errors import UsageError
from torsionnet.model.channels import Sensor
from torsionnet.model.scenarios.time_history import SAMPLE_SLACK, TimeHistory, constant
from torsionnet.response.motion.motion_start import MotionStart
from torsionnet.response.recording import Recording, is_rate
from torsionnet.solve.dynamic_stiffness.transfer_request import TransferRequest
from torsionnet.solve.motion.contact_states import Contact
from torsionnet.solve.motion.driven_pieces import simulate_pieces
from torsionnet.solve.motion.driving import Driving
from torsionnet.solve.motion.finer_run import agreement_note
from torsionnet.solve.motion.motion_over_time import MotionOverTime
from torsionnet.solve.motion.motion_plant import has_laws_of_motion, motion_plant
from torsionnet.solve.motion.smooth_laws import Scale, SplitPlant, split_plant
from torsionnet.solve.motion.smooth_system import RELATIVE, simulate_smooth
from torsionnet.solve.motion.start_state import start_state
from torsionnet.solve.motion.starting import nodes_of, steady_start
from torsionnet.solve.motion.state_layout import Layout
from torsionnet.solve.running.simulate import driven_request, motion_signals, sampled_torques
from torsionnet.solve.running.simulate import simulate as simulate_linear

REST, OPERATING_POINT = "rest", "operating_point"
NOTHING_TO_CHECK = "linear: exact at all samples, whatever the step"
"""Note on a simulation of a linear drivetrain that is to be checked with a shorter step."""
EVEN = 1e-9
"""Share of the torque over the inertia by which a start counts as accelerating."""

Torque: TypeAlias = ArrayLike | TimeHistory


def simulate(
    drivetrain: AssembledModel,
    outputs: str | Sensor | Sequence[str | Sensor],
    inputs: Mapping[str, Torque],
    sampling_rate: float,
    start: str | MotionStart = REST,
    *,
    duration: float | None = None,
    scales: Mapping[Scale, TimeHistory] | None = None,
    check: bool = False,
) -> Recording:
    """Recording of torques and simulated motions of a drivetrain, in SI units over time.

    See :meth:`torsionnet.Drivetrain.simulate`. ``scales`` are what scales the torques of elements over time, by element
    and name, as ``("clutch", "clamp")``.
    """
    if isinstance(start, str) and start not in (REST, OPERATING_POINT):
        text = f'a simulation starts from "{REST}", from the "{OPERATING_POINT}" or from a MotionStart'
        raise UsageError(f'{text}, got "{start}"')
    sampled = not scales and not any(isinstance(one, TimeHistory) for one in inputs.values())
    if sampled and start == REST and not has_laws_of_motion(drivetrain):
        record = simulate_linear(drivetrain, outputs, inputs, sampling_rate)  # type: ignore[arg-type]
        return record.with_notes(NOTHING_TO_CHECK) if check else record
    if not is_rate(sampling_rate):
        raise UsageError(f"the sampling rate must be a positive number of Hz, got {sampling_rate}")
    whole = _with_mean_torques(drivetrain, inputs) if start == OPERATING_POINT else dict(inputs)
    driving, torques = _driving(whole, sampling_rate, duration, scales or {})
    plant = motion_plant(drivetrain)
    request = driven_request(plant.drivetrain, outputs, whole)  # type: ignore[arg-type]
    split = split_plant(drivetrain, plant, tuple(scales or {}))
    begun = _begun(drivetrain, split, dict(zip(whole, driving.first.tolist(), strict=False)), start)
    motion = _solved(split, request, driving, begun)
    notes = [f"simulated: {drivetrain.title}, {begun.words}"]
    if split.smooth:
        names = ", ".join(dict.fromkeys(one.owner for one in split.smooth))
        notes.append(f"the torques of {names} by a Runge-Kutta method to {RELATIVE:g} in each step")
        late = ", ".join(f"{one.owner} with {one.lag:.6g} s" for one in split.smooth if one.lag)
        if late:
            text = "from that of its speed" if begun.settled else "from zero at the first sample, as after switching on"
            notes.append(f"torque that follows its curve with a time constant, {text}: {late}")
    if check:
        finer = _solved(split, request, driving, begun, refinement=2)
        notes.append(agreement_note(motion.values, finer.values, sampling_rate))
    signals = motion_signals(drivetrain, request, whole, torques, motion.values)  # type: ignore[arg-type]
    return Recording(
        signals, sampling_rate, title=drivetrain.title, notes=tuple(notes), events=motion.events, energy=motion.energy
    )


def _with_mean_torques(drivetrain: AssembledModel, inputs: Mapping[str, Torque]) -> dict[str, Torque]:
    """Inputs with the mean torques of the operating point on all other nodes."""
    driven = {nodes_of(drivetrain, place) for place in inputs}
    means = {node: torque for node, torque in drivetrain.mean_torques.items() if torque and node in drivetrain.nodes}
    return {**inputs, **{node: constant(torque) for node, torque in means.items() if (node,) not in driven}}


def _driving(
    inputs: Mapping[str, Torque], rate: float, duration: float | None, scales: Mapping[Scale, TimeHistory]
) -> tuple[Driving, FloatArray]:
    """Torques and scales over time, and the torques (n_in, n) at the samples.

    Raises
    ------
    UsageError
        Unlike lengths, numbers that are not finite, or histories without a duration.
    """
    listed = {name: one for name, one in inputs.items() if not isinstance(one, TimeHistory)}
    arrays = dict(zip(listed, sampled_torques(listed), strict=True)) if listed or not inputs else {}
    lengths = {len(one) for one in arrays.values()}
    if duration is not None:
        lengths.add(int(np.floor(duration * rate + SAMPLE_SLACK)) + 1)
    if len(lengths) != 1:
        if not lengths:
            raise UsageError("torques as histories have no end: give the duration in s")
        text = " and ".join(map(str, sorted(lengths)))
        raise UsageError(f"the torques have {text} samples; give lists of one length, that of the duration")
    (n,) = lengths
    entries = [arrays.get(name, one) for name, one in inputs.items()]
    driving = Driving((*entries, *scales.values()), rate, n)
    torques = np.array([one.samples(rate, n) if isinstance(one, TimeHistory) else one for one in entries])
    if not np.isfinite(torques).all():
        raise UsageError("the torques of a simulation are finite numbers in N m")
    return driving, torques


@dataclass(frozen=True, eq=False)
class _Begun:
    """State z in which a motion begins, the contact state where it is known, and both in words.

    ``settled`` says whether torques that lag behind their curve have reached it.
    """

    z: FloatArray
    contact: Contact | None
    words: str
    settled: bool = True


def _begun(
    drivetrain: AssembledModel, split: SplitPlant, torques: Mapping[str, float], start: str | MotionStart
) -> _Begun:
    plant = split.plant
    if start == OPERATING_POINT:
        steady = steady_start(drivetrain, split, torques)
        words = "from its operating point under the torques at the first sample"
        if np.abs(steady.accelerations).max(initial=0.0) > EVEN * _even_size(split, torques):
            words += ", which are not in balance: it begins in steady acceleration, without vibration"
        return _Begun(steady.z, steady.contact, words)
    at = Layout(len(plant.assembly.system.M), sum(len(one.F) for one in plant.actions), 0, 0)
    given = start if isinstance(start, MotionStart) else MotionStart()
    words = "at rest before the first sample" if start == REST else "from a given state"
    return _Begun(start_state(plant, at, given), None, words, settled=start != REST)


def _even_size(split: SplitPlant, torques: Mapping[str, float]) -> float:
    """Acceleration in rad/s^2 that the torques would give to all inertias."""
    inertia = float(np.abs(split.plant.assembly.system.M).sum()) or 1.0
    return sum(map(abs, torques.values())) / inertia


def _solved(
    split: SplitPlant, request: TransferRequest, driving: Driving, begun: _Begun, refinement: int = 1
) -> MotionOverTime:
    given = (split, request.outputs, request.excitations, driving, begun.z, begun.contact, refinement)
    found = simulate_smooth(*given, settled=begun.settled) if split.smooth else simulate_pieces(*given)
    return replace(found, events=tuple(sorted(found.events, key=lambda event: event.time)))
