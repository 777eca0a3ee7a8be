"""Simulation of drivetrains, linear ones in one way from rest and those with laws of motion from event to event."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.phrases import phrase
from torsionnet.base.threads import one_thread
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import functional
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.between_samples import Between
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest
from torsionnet.model.channels import Channels, Sensor
from torsionnet.motion.contact_states import Contact, MotionStart, start_state
from torsionnet.motion.driving import Driving, Torque, acting_means, driving_of, held_load, require_request, scale_notes
from torsionnet.motion.motion_plant import Layout, has_laws_of_motion, motion_plant, over_time
from torsionnet.motion.motion_record import MotionOverTime
from torsionnet.motion.piece_system import simulate_pieces
from torsionnet.motion.scenarios.scenario import GridTie
from torsionnet.motion.scenarios.time_history import TimeHistory, constant, held_course
from torsionnet.motion.simulate import driven_request, motion_signals, simulate_linear
from torsionnet.motion.smooth_laws import Scale, SplitPlant, split_plant, tied_plant
from torsionnet.motion.smooth_system import BEYOND, RELATIVE, simulate_smooth
from torsionnet.motion.steady_start import nodes_of, steady_start
from torsionnet.motion.torque_courses import TorqueCourses, torque_courses
from torsionnet.signals.recording import Recording

# Agreement of a motion over time with the same motion in steps half as long.

AGREE = 1e-6
"""Share of the largest value of a reading up to which two runs agree: far below what a picture shows, far above what
steps of either length miss before a motion becomes chaotic."""


def agreement_note(values: FloatArray, finer: FloatArray, rate: float) -> str:
    """Note until when readings (n_out, n) agree with those in steps half as long, sampled at ``rate`` Hz.

    >>> agreement_note(np.array([[0.0, 1.0, 2.0]]), np.array([[0.0, 1.0, 2.1]]), 10.0)
    'in steps half as long the first 0.1 s agree to 1e-06 of the largest value, after that contacts make other choices'
    """
    apart = np.abs(values - finer)
    largest = np.abs(finer).max(axis=1, initial=0.0)[:, None]
    beyond = np.flatnonzero((apart > AGREE * largest).any(axis=0))
    if not len(beyond):
        share = float(np.max(apart / np.where(largest > 0, largest, 1.0), initial=0.0))
        return f"in steps half as long all samples agree to {max(share, 1e-15):.1g} of the largest value"
    until = max(int(beyond[0]) - 1, 0) / rate
    text = f"in steps half as long the first {until:.6g} s agree to {AGREE:g} of the largest value"
    return f"{text}, after that contacts make other choices"


POINTS_BETWEEN = 16
"""Straight lines by which a band-limited torque runs from sample to sample where laws of motion act: at a seventh
of the sampling rate they are 0.03 % off."""
REST, OPERATING_POINT = "rest", "operating_point"
NOTHING_TO_CHECK = "linear: exact at all samples, whatever the step"
"""Note on a simulation of a linear drivetrain that is to be checked with a shorter step."""
EVEN = 1e-9
"""Share of the torque over the inertia by which a start counts as accelerating."""


@one_thread()
def simulate_torques(
    drivetrain: AssembledModel,
    outputs: Channels,
    inputs: Mapping[str, Torque],
    sampling_rate: float,
    start: str | MotionStart = REST,
    *,
    duration: float | None = None,
    scales: Mapping[Scale, TimeHistory] | None = None,
    tie: GridTie | None = None,
    check: bool = False,
    between: str | Mapping[str, str] | None = None,
) -> Recording:
    """Recording of torques and simulated motions of a drivetrain, in SI units over time.

    ``scales`` are what scales the torques of elements over time, by element
    and name, as ``("clutch", "clamp")``, and ``tie`` is the torque of a grid, at a place where a torque acts.
    """
    if not isinstance(start, MotionStart) and start not in (REST, OPERATING_POINT):
        text = f'a simulation starts from "{REST}", from the "{OPERATING_POINT}" or from a MotionStart'
        raise UsageError(f'{text}, got "{start}"', kind="unknown-word")
    require_request(inputs, sampling_rate, duration)
    ways: dict[str, Between] = {}
    sampled = not scales and tie is None and not any(isinstance(torque, TimeHistory) for torque in inputs.values())
    if sampled and start == REST and not has_laws_of_motion(drivetrain):
        record = simulate_linear(drivetrain, outputs, inputs, sampling_rate, between)  # type: ignore[arg-type]
        notes = [f"{text}; its law acts in full beside other laws, or from a given start" for text in
                 _linear_notes(drivetrain, laws=True)]  # fmt: skip
        return record.with_notes(*notes, *([NOTHING_TO_CHECK] if check else []))
    lists: dict[str, Any] = {name: torque for name, torque in inputs.items() if not isinstance(torque, TimeHistory)}
    if lists:
        courses = torque_courses(lists, between)
        ways = dict(zip(lists, courses.between, strict=True))
        if "band_limited" in courses.between:
            more: dict[str, Any] = {"duration": duration, "scales": scales, "tie": tie, "check": check}
            return _band_limited(drivetrain, outputs, (inputs, courses, ways), sampling_rate, start, more)
        stepped = {name: held_course(values, sampling_rate) for (name, way), values in
                   zip(ways.items(), courses.samples, strict=True) if way == "held"}  # fmt: skip
        inputs, duration = {**inputs, **stepped}, (courses.samples.shape[1] - 1) / sampling_rate
    elif between:
        raise UsageError(
            "between= is for torques that are lists; histories say what they are at every time", kind="needless-entry"
        )
    whole = dict(inputs)
    if start == OPERATING_POINT:  # all other nodes keep their mean torques
        means = acting_means(drivetrain, (nodes_of(drivetrain, place) for place in inputs))
        whole |= {node: constant(torque) for node, torque in means.items()}
    driving, torques = driving_of(whole, sampling_rate, duration, scales or {})
    drivetrain = over_time(drivetrain)
    plant = motion_plant(drivetrain)
    request = driven_request(plant.drivetrain, outputs, whole)
    split = split_plant(drivetrain, plant, tuple(scales or {}))
    begun = _begun(drivetrain, split, dict(zip(whole, driving.first.tolist(), strict=False)), start)
    asked, onto, count = request, None, len(request.outputs)
    if tie is not None and tie.at < driving.duration:
        nodes = nodes_of(drivetrain, tie.place)
        twist = functional(plant.drivetrain, Sensor("angle", nodes[0], against=(*nodes, None)[1]))
        asked = replace(request, outputs=(*request.outputs, twist))
        onto = _onto_grid(split, replace(request, outputs=(twist,)), driving, begun, tie)
        split, driving = onto.split, onto.driving
    motion = _solved(split, asked, driving, begun)
    if tie is not None and onto is not None:
        place = next(number for number, name in enumerate(whole) if nodes_of(drivetrain, name) == nodes)
        torques[place] += tie.samples(motion.values[-1], onto.twist, tie.slip(onto.first), sampling_rate)
    notes = [
        phrase(f"simulated: {{model}}, {begun.words}", model=drivetrain.title),
        *held_load(drivetrain, {*whole} - {*inputs}),
    ]
    if tie is not None and onto is not None:
        notes.append(tie.words(onto.first))
    if start == OPERATING_POINT:
        notes += scale_notes(drivetrain, scales or {})
    if split.smooth:
        names = ", ".join(dict.fromkeys(law.owner for law in split.smooth))
        text = "the torques of {names} by a Runge-Kutta method to {tolerance:g} in each step"
        notes.append(phrase(text, names=names, tolerance=RELATIVE))
        late = ", ".join(f"{law.owner} with {law.lag:.6g} s" for law in split.smooth if law.lag)
        if late:
            text = "from that of its speed" if begun.settled else "from zero at the first sample, as after switching on"
            notes.append(f"torque that follows its curve with a time constant, {text}: {late}")
    notes += _linear_notes(drivetrain, laws=False)
    if check:
        finer = _solved(split, asked, driving, begun, refinement=2)
        notes.append(agreement_note(motion.values[:count], finer.values[:count], sampling_rate))
    every: list[Between] = [ways.get(name, "straight") for name in whole]
    signals = motion_signals(drivetrain, request, whole, torques, motion.values[:count], every)
    return Recording(
        signals, sampling_rate, title=drivetrain.title, notes=tuple(notes), events=motion.events, energy=motion.energy
    )


def _band_limited(
    drivetrain: AssembledModel,
    outputs: Channels,
    driven: tuple[Mapping[str, Torque], TorqueCourses, Mapping[str, Between]],
    rate: float,
    start: str | MotionStart,
    more: Mapping[str, Any],
) -> Recording:
    """Recording under torques of which some are band-limited, as straight ones of many points between samples."""
    inputs, courses, ways = driven
    places = np.arange(POINTS_BETWEEN) / POINTS_BETWEEN
    inside = courses.within(places).reshape(len(ways), -1)
    finer = np.hstack([inside, courses.samples[:, -1:]])
    between = {name: "held" if way == "held" else "straight" for name, way in ways.items()}
    driven_by = {**inputs, **dict(zip(ways, finer, strict=True))}
    recording = simulate_torques(drivetrain, outputs, driven_by, POINTS_BETWEEN * rate, start, between=between, **more)
    every = [ways.get(name, "straight") for name in inputs]
    every += [signal.between for signal in recording.signals[len(every) :]]
    signals = tuple(
        replace(at, values=at.values[::POINTS_BETWEEN], between=way) for at, way in zip(recording, every, strict=True)
    )
    note = f"band-limited torques: in {POINTS_BETWEEN} straight lines between two samples"
    return replace(recording, signals=signals, sampling_rate=rate).with_notes(note)


def _linear_notes(drivetrain: AssembledModel, *, laws: bool) -> list[str]:
    """Notes on elements that are linear about a working point in their entries, of those with or without laws."""
    elements = drivetrain.definition.switched_on
    given = [part for part in elements if any(getattr(part, entry) is not None for entry in part.working_point)]
    in_full = {part.name: part.has_motion_laws or part.over_time is not part for part in given}
    names = [part.name for part in given if in_full[part.name] == laws and (part.has_own_working_point or not laws)]
    return [f"linear about the working point in its entries: {name}" for name in names]


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
        if steady.integrating:
            words += f"; the integrators of {', '.join(steady.integrating)} start from zero"
        return _Begun(steady.z, steady.contact, words)
    at = Layout(len(plant.assembly.system.M), sum(len(action.F) for action in plant.actions), 0, 0)
    given = start if isinstance(start, MotionStart) else MotionStart()
    words = "at rest before the first sample" if start == REST else "from a given state"
    return _Begun(start_state(plant, at, given), None, words, settled=start != REST)


@dataclass(frozen=True, eq=False)
class _OntoGrid:
    """Plant and driving with the torque of a grid, the rotor's angle in rad there and its first speed in rad/s."""

    split: SplitPlant
    driving: Driving
    twist: float
    first: float


def _onto_grid(split: SplitPlant, request: TransferRequest, driving: Driving, begun: _Begun, tie: GridTie) -> _OntoGrid:
    """Plant with the torque of a grid, from the motion before the connection; ``request`` reads the rotor's angle."""
    row = request.outputs[0].terms[0].row
    n_q = len(row)
    twist, first = float(row @ begun.z[:n_q]), float(row @ begun.z[n_q : 2 * n_q])
    # The motion before the connection leads to the angle at which the rotor meets the grid.
    if tie.at > 0:
        before = Driving(driving.entries, 1 / tie.at, 2)
        twist = float(_solved(split, request, before, begun).values[0, -1])
    curves, histories = zip(*tie.laws(twist, tie.slip(first)), strict=True)
    whole = replace(driving, entries=(*driving.entries, *histories))
    return _OntoGrid(tied_plant(split, tie, curves, row), whole, twist, first)


def _even_size(split: SplitPlant, torques: Mapping[str, float]) -> float:
    """Acceleration in rad/s^2 that the torques would give to all inertias."""
    inertia = float(np.abs(split.plant.assembly.system.M).sum()) or 1.0
    return sum(map(abs, torques.values())) / inertia


def _solved(
    split: SplitPlant, request: TransferRequest, driving: Driving, begun: _Begun, refinement: int = 1
) -> MotionOverTime:
    given = (split, request.outputs, request.excitations, driving, begun.z, begun.contact, refinement)
    with np.errstate(over="ignore", invalid="ignore"):
        motion = simulate_smooth(*given, settled=begun.settled) if split.smooth else simulate_pieces(*given)
    lost = np.flatnonzero(~np.isfinite(motion.values).all(axis=0))
    if len(lost):
        raise SolveError(f"after {max(int(lost[0]) - 1, 0) / driving.rate:.6g} s {BEYOND}", kind="no-solution")
    return replace(motion, events=tuple(sorted(motion.events, key=lambda event: event.time)))
