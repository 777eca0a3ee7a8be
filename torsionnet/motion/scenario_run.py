"""Motion of a drivetrain under a scenario, from rest or from its operating point."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Number
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import functional
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.state_space import active_channels
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest
from torsionnet.linear.modes.natural_modes import natural_modes
from torsionnet.machinery.mean.mean_solution import mean_response, reason_undetermined
from torsionnet.model.channels import Channels, Sensor
from torsionnet.model.operating_point import OperatingPoint
from torsionnet.motion.contact_states import MotionStart
from torsionnet.motion.driving import MOST_SAMPLES, acting_means, held_load
from torsionnet.motion.motion_plant import has_laws_of_motion, motion_plant
from torsionnet.motion.scenario_courses import driving_course, scenario_of
from torsionnet.motion.scenarios.scenario import OPERATING_POINT, REST, STARTS, DrivingCourse, Scenario
from torsionnet.motion.scenarios.time_history import SAMPLE_SLACK, TimeHistory, constant
from torsionnet.motion.simulate import driven_request, motion_signals, read_notes, response_over_time
from torsionnet.motion.simulation import NOTHING_TO_CHECK, simulate_torques
from torsionnet.motion.steady_start import nodes_of
from torsionnet.motion.torque_courses import exact_response, torque_courses
from torsionnet.signals.recording import Recording, Signal, is_rate

SAMPLES_PER_PERIOD, FEWEST_SAMPLES = 100, 1000
"""Samples in a period of the highest vibration, between which peaks are at most 0.05 % of that vibration higher, and
samples of a scenario at least, as a picture shows."""
MOST_DEFAULT_SAMPLES = 200_000
"""Most samples that a scenario has unless its rate is given: vibrations so fast that 100 samples in their period are
more are seldom what a scenario is about."""


@dataclass(frozen=True, eq=False)
class DrivenPlaces:
    """Torques in N m over time that act in a scenario, by input, node or two nodes as ``pulley-block``.

    Attributes
    ----------
    histories : mapping
        Place -> torque over time.
    course : DrivingCourse
        What the scenario does besides.
    start : str or MotionStart
        ``rest``, ``operating_point``, or angles and speeds of nodes.
    means : frozenset of str
        Nodes whose mean torques go on acting.
    """

    histories: Mapping[str, TimeHistory]
    course: DrivingCourse
    start: str | MotionStart
    means: frozenset[str] = frozenset()


def simulate(
    drivetrain: AssembledModel,
    output: Channels | None = None,
    input: Mapping[str, ArrayLike | Signal] | None = None,
    sampling_rate: float | None = None,
    *,
    between: str | Mapping[str, str] | None = None,
    initial_state: str | MotionStart | None = None,
    scenario: str | Scenario | Mapping[str, Any] | None = None,
    duration: float | None = None,
    check: bool = False,
) -> Recording:
    """Motion and torques over time, exact for torques that are straight, held or band-limited between samples.

    Laws of motion, as of clearances and friction, act in full: the result has their events and an energy balance.

    Parameters
    ----------
    output : str, Sensor or sequence of these
        As for :meth:`frequency_response`; in a scenario the model's sensors unless others are named.
    input : mapping
        Name of an input or node -> (n,) torques in N m, or a :class:`~torsionnet.signals.Signal`. That on a node is
        called ``torque on NODE`` in the result.
    sampling_rate : float
        Hz; in a scenario instead of what that says.
    between : {"straight", "held", "band_limited"}, or mapping of these by input, optional
        Course of the torques between samples; by default that of a signal, and straight lines between numbers.
    initial_state : str or MotionStart, optional
        ``"rest"``, ``"operating_point"``, in balance with the torques at the first sample and mean torques on other
        nodes, or angles and speeds of nodes at the first sample. Default: rest, or what the scenario says.
    scenario : str, Scenario or mapping, optional
        Instead of inputs: a scenario of the model, or another one, ``{"type": "torques", "duration": ...}``, whose
        torques act.
    duration : float, optional
        Time in s that is simulated in a scenario, instead of what that says; inputs have its length.
    check : bool
        Repeat the motion in steps half as long, and note until when both agree: contacts make motions chaotic.

    Returns
    -------
    Recording
        The inputs and the outputs, SI units.

    Raises
    ------
    UsageError
        Unknown names, unlike lengths, frequency-dependent laws, or a reading with the rate of an input in it.
    SolveError
        Contacts that close and open without an end, or a twist beyond the rows of its law.

    Examples
    --------
    >>> import torsionnet as tn
    >>> record = tn.load("dmf_rig").simulate(["theta_1", "T_T"], {"T_M": [0.0] + 4000 * [10.0]}, 1e3)
    >>> record.names, round(float(record["T_T"].values[-1]), 6)
    (('T_M', 'theta_1', 'T_T'), 10.0)
    >>> fault = tn.load("turbine_generator_ssr").simulate("T_LPB_G", scenario="three_phases", sampling_rate=2e4)
    >>> fault.events[0].what, round(float(abs(fault["T_LPB_G"].values).max()) / 1e6, 2)
    ('short circuit of 3 phases', 7.95)
    """
    if scenario is not None:
        if input is not None or between is not None:
            text = "a scenario brings its own torques; leave out input and between, or the scenario"
            raise UsageError(text, kind="contradicting-entries")
        return _run_scenario(drivetrain, scenario, output, initial_state, sampling_rate, duration, check=check)
    if output is None or input is None or sampling_rate is None:
        text = "a simulation needs output, input and a sampling rate, or a scenario"
        raise UsageError(text, kind="missing-entry")
    begin = initial_state or REST
    return simulate_torques(
        drivetrain, output, input, sampling_rate, begin, duration=duration, check=check, between=between
    )


def _run_scenario(
    drivetrain: AssembledModel,
    scenario: str | Scenario | Mapping[str, Any],
    outputs: Channels | None,
    start: str | MotionStart | None,
    sampling_rate: float | None,
    duration: float | None,
    *,
    check: bool,
) -> Recording:
    if sampling_rate is not None and not is_rate(sampling_rate):
        raise UsageError(f"the sampling rate must be a positive number of Hz, got {sampling_rate}", kind="out-of-range")
    chosen = scenario_of(drivetrain, scenario)
    if duration is not None:
        chosen = replace(chosen, duration=duration)
    driven = driven_places(drivetrain, chosen, start)
    asked = _outputs(drivetrain) if outputs is None else outputs
    rate = sampling_rate or chosen.rate or _default_rate(drivetrain, chosen, driven)
    count = math.floor(chosen.length * rate + SAMPLE_SLACK) + 1
    if count > MOST_SAMPLES:
        text = f"{chosen.length:g} s at {rate:g} Hz are more than {MOST_SAMPLES} samples"
        raise UsageError(f"{text}; give a lower rate or a shorter duration", kind="too-large")
    given = isinstance(driven.start, MotionStart)
    # From event to event wherever a law acts in full, else as the response of a linear system.
    if given or driven.course.in_full or has_laws_of_motion(drivetrain):
        record = _from_event_to_event(drivetrain, driven, asked, rate, count, check=check)
    else:
        record = _linear(drivetrain, driven, asked, rate, count)
        record = record.with_notes(NOTHING_TO_CHECK) if check else record
    record = record.with_notes(*held_load(drivetrain, driven.means))
    events = sorted((*record.events, *driven.course.events), key=lambda event: event.time)
    return replace(record, events=tuple(events))


def driven_places(
    drivetrain: AssembledModel, scenario: Scenario, start: str | MotionStart | None = None
) -> DrivenPlaces:
    """Torques over time that act on a drivetrain in a scenario, with the mean torques that go on acting."""
    course = driving_course(drivetrain, scenario)
    begins = scenario.begins if start is None else start
    if isinstance(begins, str) and begins not in STARTS:
        raise UsageError(
            f'a scenario starts from {" or ".join(STARTS)}, or from a MotionStart, got "{begins}"', kind="unknown-word"
        )
    means: dict[str, float] = {}
    if begins == OPERATING_POINT:
        in_full = course.in_full or has_laws_of_motion(drivetrain)
        replaced = [nodes_of(drivetrain, place) for place in course.torques]
        means = acting_means(drivetrain, replaced, in_full=in_full)
    histories = {node: constant(torque) for node, torque in means.items()}
    histories |= course.torques
    for place, history in course.added.items():
        known = next((each for each in histories if nodes_of(drivetrain, each) == nodes_of(drivetrain, place)), None)
        histories[known or place] = histories[known] + history if known else history
    unloaded = not any(history.first for history in histories.values())
    if begins == OPERATING_POINT and unloaded and not has_laws_of_motion(drivetrain):
        begins = REST
    return DrivenPlaces(histories, course, begins, frozenset(means))


def _outputs(drivetrain: AssembledModel) -> list[str]:
    """Names of the sensors that read a motion, also those of motions that linear results hold, as a slip."""
    states = [drivetrain]
    if has_laws_of_motion(drivetrain):
        states.append(motion_plant(drivetrain).drivetrain)
    reading = {name for state in states for name in active_channels(state).sensors}
    names = [name for name in drivetrain.sensors if name in reading]
    if not names:
        raise UsageError(
            "the model has no sensors; name outputs, as torque(shaft) or velocity(node)", kind="missing-entry"
        )
    return names


def _default_rate(drivetrain: AssembledModel, scenario: Scenario, driven: DrivenPlaces) -> float:
    """Sampling rate in Hz that shows the highest vibration and the fastest wave of a torque."""
    highest = float(np.max(natural_modes(drivetrain)[0].damped_frequencies, initial=0.0))
    fastest = max([highest, *(history.fastest for history in driven.histories.values())])
    rate = max(SAMPLES_PER_PERIOD * fastest, FEWEST_SAMPLES / scenario.length)
    return float(f"{min(rate, MOST_DEFAULT_SAMPLES / scenario.length):.3g}")


def _linear(
    drivetrain: AssembledModel,
    driven: DrivenPlaces,
    outputs: Channels,
    rate: float,
    count: int,
) -> Recording:
    """Recording of a linear drivetrain: the mean response under the torques at the start, and what changes after it."""
    names, histories = list(driven.histories), list(driven.histories.values())
    torques = np.array([history.samples(rate, count) for history in histories])
    request = driven_request(drivetrain, outputs, dict(zip(names, torques, strict=True)))
    begun = "simulated: {model}, at rest before the first sample"
    offsets: FloatArray | None = np.zeros(len(request.outputs))
    if driven.start == OPERATING_POINT:
        offsets = _mean_readings(drivetrain, driven, request)
        begun = "simulated: {model}, from the mean torques at the start; angles and speeds count from the mean motion"
        if offsets is None:
            begun = (
                "simulated: {model}, the torques at the start are not in balance: it begins in steady acceleration, "
                "without vibration"
            )
    notes = [phrase(begun, model=drivetrain.title)]
    if offsets is not None and driven.start == OPERATING_POINT:
        histories = [history + constant(-history.first) for history in histories]
    # Laws over frequency and delays are solved for sampled torques.
    system = drivetrain.assembly.system
    if system.dynamic or any(action.delay for action in system.actions):
        if offsets is None:
            raise UsageError(
                "with delays or laws over frequency the torques at the start must be in balance",
                kind="unbalanced-torques",
            )
        changes = torque_courses(
            {name: history.samples(rate, count) for name, history in zip(names, histories, strict=True)}
        )
        motion = response_over_time(drivetrain, request, changes, rate)
        notes += ["torques run straight between samples", *read_notes(drivetrain, rate)]
    else:
        motion = exact_response(drivetrain, request, histories, rate, count, steady=offsets is None)
    if offsets is not None:
        motion = motion + offsets[:, None]
    signals = motion_signals(drivetrain, request, dict.fromkeys(names, ()), torques, motion)
    return Recording(signals, rate, title=drivetrain.title, notes=tuple(notes))


def _mean_readings(drivetrain: AssembledModel, driven: DrivenPlaces, request: TransferRequest) -> FloatArray | None:
    """Readings (n_out,) in SI units under the torques at the start, 0 for those that count from the mean motion.

    None where the torques are not in balance.
    """
    torque: dict[str, Number] = {}
    for place, history in driven.histories.items():
        if history.first:
            key = "-".join(nodes_of(drivetrain, place))
            torque[key] = Number(history.first + (float(torque[key].value) if key in torque else 0.0))
    point = OperatingPoint(drivetrain.definition.operating_point.speed, torque)
    loaded = drivetrain.with_definition(replace(drivetrain.definition, load=None, operating_point=point, authored=None))
    readings = np.zeros(len(request.outputs))
    wanted = [
        number
        for number, output in enumerate(request.outputs)
        if output.sensor is not None and reason_undetermined(loaded, output) is None
    ]
    # What mean torques do not determine, as an angle of what turns freely, counts from the mean motion.
    chosen = [sensor for number in wanted if (sensor := request.outputs[number].sensor) is not None]
    asked = chosen or _probe(loaded)
    try:
        means = mean_response(loaded, asked).values[0] if asked else readings
    except UsageError:
        return None
    readings[wanted] = means[: len(wanted)]
    return readings


def _probe(drivetrain: AssembledModel) -> list[Sensor]:
    """Torque sensor on an element whose mean torque is determined, to see whether torques are in balance; or none."""
    for name in drivetrain.elements:
        sensor = Sensor("torque", name)
        try:
            if reason_undetermined(drivetrain, functional(drivetrain, sensor)) is None:
                return [sensor]
        except UsageError:
            continue
    return []


def _from_event_to_event(
    drivetrain: AssembledModel,
    driven: DrivenPlaces,
    outputs: Channels,
    rate: float,
    count: int,
    *,
    check: bool = False,
) -> Recording:
    """Recording of a drivetrain with laws of motion, or from a given state."""
    return simulate_torques(
        drivetrain, outputs, driven.histories, rate, driven.start, duration=(count - 1) / rate,
        scales=driven.course.scales, tie=driven.course.tie, check=check,
    )  # fmt: skip
