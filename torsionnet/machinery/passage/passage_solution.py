"""Response of a drivetrain to all orders of its excitations along a speed over time, as in passing a resonance.

The speed runs straight between the points given. Time is cut into sections in which amplitudes of orders are
polynomials of the speed and parameters that follow it change evenly; states go on from section to section, and within
one each step is exact for the free motion (:mod:`.exponential_steps`). Sections are halved and points of interpolation
added until the values no longer move, and the last movement is the error that the result states.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.dynamic_stiffness.state_space import first_order, output_matrices
from torsionnet.linear.dynamic_stiffness.transfer_request import resolve_request
from torsionnet.machinery.design.damper_design import viscous_equivalent
from torsionnet.machinery.orders.operating_groups import drivetrains_at_speeds
from torsionnet.machinery.orders.order_line import OrderLine, greatest_common_divisor, near_fraction
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.order_solution import OrderRequest, orders_at_speeds, settled_values
from torsionnet.machinery.orders.synthesis import common_cycle
from torsionnet.machinery.passage.passage_response import PassageResponse
from torsionnet.machinery.passage.passage_torques import (
    ExcitationCase,
    Matrices,
    PassageTorques,
    SteppedForm,
    gauss_points,
    highest_rate,
    lines_that_matter,
)
from torsionnet.model.channels import Channels, Input, Sensor
from torsionnet.model.operating_values import running_notes

STEPS_PER_PERIOD = 16
"""Number of time steps in a period of the highest order: parabolas through three of them miss a crest of it by up to
2e-4."""
SECTION_SHARE = 0.08
"""Largest relative change of the speed within a section of a passage, before sections are halved; a larger one needs
more corrections."""
MOST_HALVINGS = 3
"""Number of halvings of the sections after which the result is taken as it is, with its error."""
ERROR_TOLERANCE = 1e-4
"""Estimated error, relative to the largest value, below which the sections are not halved any more."""
LEAST_ERROR = 1e-6
"""Least error of a passage that is stated, relative to the largest value: that of crests between two steps is not
estimated."""
FEWEST_NODES = 4
"""Number of Gauss points in a time step before sections are halved: with 16 steps in a period of the highest order they
are right to about 1e-9."""
NEGLIGIBLE_ORDERS = 1e-4
"""Share of the largest half range that the highest orders may have together to be left out: most have next to nothing
and would take the shortest steps."""
FEWEST_STEPS = 4
"""Least number of time steps in a section, so that a cubic fits into it."""
MOST_STEPS = 2_000_000
"""Largest number of time steps of a passage, which bounds memory and time: a minute of order 12 at 1000 rpm takes a
fifth of them."""
MOST_SPEED_POINTS = 2000
"""Largest number of points of the speed over time, as each stretch between two takes a section of its own."""
FEWEST_WINDOWS = 20
"""Least number of windows in a passage if these are as long as a common cycle of several shafts or a period of a slip
near synchronism: in longer ones the speed changes too much."""
VISCOUS = (
    "hysteretic and tabulated stiffness: springs and dampers equal to it at {frequency:.4g} Hz, where steady vibration "
    "of {output} is largest"
)
"""Note on laws over frequency, which have no equation in time."""
STEADY_SPEEDS = 61
"""Number of speeds of the steady response that shows the worst case and the resonance of laws over frequency."""


def passage_response(
    drivetrain: AssembledModel,
    output: Channels,
    times: ArrayLike,
    speeds: ArrayLike,
    *,
    speed_of: str | None = None,
    excitation: str | Iterable[str] | None = None,
) -> PassageResponse:
    """Response to all orders along a speed given over time, such as a passage of a resonance or a run-up.

    It starts from steady vibration at the first speed. Amplitudes of orders and parameters have their values at the
    speed of the moment; mean torques are left out. Hysteretic and tabulated laws become springs and dampers equal
    to them at the resonance. Of several cases of excitation the one with the largest steady vibration of the first
    output acts.

    Parameters
    ----------
    output : str, Sensor or sequence of these
        As for :meth:`frequency_response`.
    times : (n,) array
        s, rising.
    speeds : (n,) array
        rad/s, above 0, at these times; straight between them.
    speed_of, excitation : optional
        As for :meth:`order_response`.

    Returns
    -------
    PassageResponse
        ``values`` of shape (n_t, n_out), with an estimate of their error.

    Raises
    ------
    UsageError
        Unknown names, no excitations, or what has no state space: imposed motions, delays, long continuous shafts.

    Examples
    --------
    Through a resonance at 955 rpm in 2 s, which steadily would give 25 N m:

    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "ground"), stiffness=1e4, damping=2)]
    >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["955 rpm"]},
    ...     excitations={"blades": {"type": "harmonic", "node": "a", "orders": {1: {"amplitude": "0.5 N*m"}}}})
    >>> run = fan.passage_response("torque(shaft)", [0, 2], [80, 120])
    >>> print(f"{run.peak().half_range:.1f} N m at {run.peak().rpm:.0f} rpm")
    11.3 N m at 1032 rpm
    """
    return passage_from(0.0, drivetrain, output, (times, speeds), speed_of, excitation)


def passage_from(
    start_angle: float,
    drivetrain: AssembledModel,
    outputs: Channels,
    profile: tuple[ArrayLike, ArrayLike],
    speed_of: str | None,
    excitations: Iterable[str] | None,
) -> PassageResponse:
    """Response along a profile, times in s and speeds in rad/s, from an angle in rad of the node of the speeds."""
    at, run = _checked_profile(*profile)
    asked = [outputs] if isinstance(outputs, str | Sensor) else list(outputs)
    grid = np.linspace(run.min(), run.max(), STEADY_SPEEDS if run.min() < run.max() else 1)
    acting = excitations if excitations is None or isinstance(excitations, str) else tuple(excitations)
    steady = orders_at_speeds(drivetrain, asked, speeds=grid, speed_of=speed_of, excitations=acting)
    case = ExcitationCase.worst(steady)
    notes = [phrase("case of excitation, the worst in steady vibration: {case}", case=case.words)] if case.words else []
    model = drivetrain
    # In time a law over frequency has no equation of its own: it is taken at the resonance, where its damping
    # matters.
    if drivetrain.assembly.system.dynamic:
        hertz, first = _resonance(steady), steady.outputs[0].name
        model = viscous_equivalent(drivetrain, hertz)
        notes.append(phrase(VISCOUS, frequency=hertz, output=first))
    if drivetrain.definition.following:
        notes.append(phrase("parameters that follow the speed have their values at the speed of the moment"))
    notes += (*running_notes(drivetrain.definition), *range_notes(drivetrain.assembly, np.abs(steady.frequencies)))
    request = OrderRequest.of(model, grid, speed_of, acting)
    kept, left_out = lines_that_matter(steady, NEGLIGIBLE_ORDERS)
    lines = tuple(line for line, acts in zip(steady.lines, kept.tolist(), strict=True) if acts)
    walk = _Passage(request, tuple(asked), PassageTorques(request, case, kept), lines, request.loads(grid[:1]).inputs)
    sections = walk.cut(at, run, start_angle)
    response, error = walk.along(sections, 0), math.inf
    # Each round halves the sections and adds a Gauss point: its difference from the round before estimates the error.
    for halving in range(1, MOST_HALVINGS + 1):
        sections = [half for section in sections for half in section.halves()]
        last, response = response, walk.along(sections, halving)
        size = np.abs(response).max(axis=0)
        error = float((np.abs(response - last).max(axis=0) / np.where(size > 0, size, 1.0)).max(initial=0.0))
        if error <= ERROR_TOLERANCE:
            break
    # Orders left out are an error, too.
    error = max(error + left_out, LEAST_ERROR)
    grid_of = [section.grid() for section in sections]
    moments, angles, course = (
        np.concatenate([part[number][:-1] for part in grid_of] + [grid_of[-1][number][-1:]]) for number in range(3)
    )
    cycle = _cycle(steady.lines, float(angles[-1] - angles[0]))
    return PassageResponse(
        moments, course, angles, request.reference, response, steady.outputs, cycle, error,
        drivetrain.title, (*notes, f"estimated error {100 * error:.1g} % of the largest value"),
        _window_angles(steady.lines, cycle, moments, course, angles),
    )  # fmt: skip


@dataclass(frozen=True)
class _Section:
    """Stretch of time in which the speed runs straight from ``first`` to ``last``, rad/s, in even steps.

    ``base`` is the number of the section at first that it is a part of.
    """

    start: float
    duration: float
    angle: float
    first: float
    last: float
    steps: int
    base: int

    def halves(self) -> tuple[_Section, _Section]:
        middle, half = (self.first + self.last) / 2, self.duration / 2
        # The speed is linear in a section: the angle grows by the mean speed times the time.
        angle = self.angle + half * (self.first + middle) / 2
        return (
            replace(self, duration=half, last=middle, steps=self.steps // 2),
            _Section(self.start + half, half, angle, middle, self.last, self.steps // 2, self.base),
        )

    def moments(self, shares: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Times in s, angles in rad and speeds in rad/s at places of the section, as shares of its duration."""
        t = shares * self.duration
        # phi = phi_0 + Omega_0 t + slope t^2/2 at an even rate.
        slope = (self.last - self.first) / self.duration
        return self.start + t, self.angle + self.first * t + slope * t**2 / 2, self.first + slope * t

    def grid(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Times in s, angles in rad and speeds in rad/s at both ends of every step."""
        return self.moments(np.linspace(0, 1, self.steps + 1))


@dataclass(frozen=True, eq=False)
class _Passage:
    """Drivetrain with the outputs asked for and the torques that act on it along a speed."""

    request: OrderRequest
    outputs: tuple[str | Sensor, ...]
    torques: PassageTorques
    lines: tuple[OrderLine, ...]
    inputs: tuple[Input, ...]
    known: dict[float, Matrices] = field(default_factory=dict)

    def cut(self, times: FloatArray, speeds: FloatArray, angle: float) -> list[_Section]:
        """Sections between the points of the speed over time, none with a large change of speed.

        The reference shaft begins at ``angle``, rad.
        """
        relative = [float(line.relative) for line in self.lines]
        fixed = 2 * math.pi * np.array([line.fixed for line in self.lines])
        sections: list[_Section] = []
        whole = FEWEST_STEPS * 2**MOST_HALVINGS
        for start, end, first, last in zip(times[:-1], times[1:], speeds[:-1], speeds[1:], strict=True):
            # A section holds a small change of speed only, in which matrices and amplitudes run nearly straight.
            count = max(1, math.ceil(abs(last - first) / (SECTION_SHARE * min(first, last))))
            ends, course = np.linspace(start, end, count + 1), np.linspace(first, last, count + 1)
            for number in range(count):
                duration, low, high = float(ends[number + 1] - ends[number]), course[number], course[number + 1]
                rate = highest_rate(relative, fixed, float(max(low, high)))
                # A number that can be halved as often as sections are.
                steps = whole * math.ceil(duration * rate * STEPS_PER_PERIOD / (2 * math.pi) / whole)
                place = (float(ends[number]), duration, angle, float(low), float(high))
                sections.append(_Section(*place, steps or whole, len(sections)))
                angle += duration * float(low + high) / 2
        total = sum(section.steps for section in sections)
        if total > MOST_STEPS:
            text = f"the highest order takes {total} steps over {times[-1] - times[0]:g} s, more than {MOST_STEPS}"
            raise UsageError(f"{text}; shorten the time, or leave out high orders", kind="too-large")
        return sections

    def along(self, sections: Sequence[_Section], halvings: int) -> FloatArray:
        """Outputs (n_t, n_out) in SI at all steps, with sections halved ``halvings`` times, from a steady start."""
        nodes, parts = FEWEST_NODES + halvings, 2**halvings
        firsts = [replace(section, last=other.last) for section, other in
                  zip(sections[::parts], sections[parts - 1 :: parts], strict=True)]  # fmt: skip
        ranges = [(min(section.first, section.last), max(section.first, section.last)) for section in firsts]
        acting = self.torques.sections(ranges, nodes)
        forms = self._forms(sorted({speed for section in sections for speed in (section.first, section.last)}))
        shares, courses, states = gauss_points(nodes), [], None
        for section in sections:
            torques, form = acting[section.base], forms(section.first, section.last)
            # Before the passage the drivetrain has been at the first speed for long.
            if states is None:
                states = form.steady(*torques.steady(section.start, section.angle, section.first))
            inner = ((np.arange(section.steps)[:, None] + shares) / section.steps).ravel()
            pushed = torques.at(*section.moments(inner)).reshape(-1, section.steps, nodes)
            values, states = form.steps(states, pushed, torques.at(*section.grid()), section.duration / section.steps)
            courses.append(values)
        whole = [part[:, :-1] for part in courses] + [courses[-1][:, -1:]]
        return np.asarray(np.concatenate(whole, axis=1).T)

    def _forms(self, ends: Sequence[float]) -> Callable[[float, float], SteppedForm]:
        """Function that gives the state space of a section in SI from the speeds in rad/s at its ends."""
        if not self.request.drivetrain.definition.follows_speed:
            matrices = self._matrices(self.request.drivetrain)
            only = SteppedForm.between(matrices, matrices)
            return lambda _, __: only
        self._add([speed for speed in ends if speed not in self.known])
        return lambda first, last: SteppedForm.between(self.known[first], self.known[last])

    def _add(self, speeds: Sequence[float]) -> None:
        """Work out the matrices of the state space at further speeds in rad/s."""
        if not speeds:
            return
        at = replace(self.request, speeds=np.array(speeds))
        for rig, places in drivetrains_at_speeds(at.drivetrain, at.reference, at.speeds, settled_values(at)):
            matrices = self._matrices(rig)
            if any(matrices[0].shape != other[0].shape for other in self.known.values()):
                raise UsageError(
                    "parameters that follow the speed switch inertia or damping on and off along it",
                    kind="unsupported-law",
                )
            self.known.update({speeds[place]: matrices for place in places.tolist()})

    def _matrices(self, rig: AssembledModel) -> Matrices:
        """Matrices A, B, C and D in SI units of a drivetrain from the torques that act to the outputs."""
        request = resolve_request(rig, list(self.outputs), list(self.inputs), None)
        form = first_order(rig.assembly, request.excitations)
        return form.A, form.B, *output_matrices(rig.assembly, request.outputs, request.excitations, form)


def _checked_profile(times: ArrayLike, speeds: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Times (n,) in s, and speeds (n,) in rad/s, as arrays that can be followed."""
    try:
        at, run = np.asarray(times, dtype=float), np.asarray(speeds, dtype=float)
    except (TypeError, ValueError):
        at, run = np.empty(0), np.empty(0)
    if at.ndim != 1 or at.shape != run.shape or len(at) < 2 or not np.isfinite([at, run]).all():
        raise UsageError(
            "a speed over time is two lists of finite numbers, times in s and speeds in rad/s, alike long",
            kind="wrong-form",
        )
    if (np.diff(at) <= 0).any() or (run <= 0).any():
        raise UsageError(
            "times rise, and speeds are above 0 rad/s; begin a run-up at the lowest speed with tables",
            kind="unordered-rows",
        )
    if len(at) > MOST_SPEED_POINTS:
        raise UsageError(
            f"{len(at)} points of speed are more than {MOST_SPEED_POINTS}; thin them out", kind="too-large"
        )
    return at, run


def _resonance(steady: OrderResponse) -> float:
    """Frequency in Hz of the line of largest amplitude of the first output over all speeds."""
    sizes = np.abs(steady.values[:, :, 0])
    speed, line = np.unravel_index(np.argmax(sizes), sizes.shape)
    return float(abs(steady.frequencies[speed, line]))


def _cycle(lines: Sequence[OrderLine], turned: float) -> float:
    """Angle of the reference shaft in rad after which all orders repeat, a revolution without orders.

    Where a passage that turns by an angle in rad holds few common cycles of several shafts, their longest own cycle.
    """
    orders: dict[Fraction, list[Fraction]] = {}
    for line in lines:
        if line.relative and not line.fixed:
            orders.setdefault(line.ratio, []).append(abs(line.relative))
    if not orders:
        return 2 * math.pi
    common = 2 * math.pi / float(greatest_common_divisor(itertools.chain(*orders.values())))
    return common if FEWEST_WINDOWS * common <= turned else 2 * math.pi / min(map(_repetition_rate, orders.values()))


def _repetition_rate(rates: Sequence[Fraction]) -> float:
    """Rate at which a sum of lines with these rates repeats, or that of the slowest line where that takes too long."""
    top = max(rates)
    repeats = common_cycle([rate / top for rate in rates]) is not None
    return float(greatest_common_divisor(rates) if repeats else min(rates))


def _window_angles(
    lines: Sequence[OrderLine], cycle: float, times: FloatArray, speeds: FloatArray, angles: FloatArray
) -> FloatArray:
    """Angle (n_t,) in rad that turns by a cycle while every line repeats, with the shaft where all lines follow it."""
    # Windows per second: of orders, of fixed frequencies together, and of each slip, which falls to 0 at synchronism.
    rates = [speeds / cycle]
    if fixed := [abs(near_fraction(line.fixed)) for line in lines if line.fixed and not line.order]:
        rates.append(np.full(len(times), _repetition_rate(fixed)))
    longest = (times[-1] - times[0]) / FEWEST_WINDOWS
    rates += [np.maximum(np.abs(line.frequency(speeds)), 1 / longest) for line in lines if line.fixed and line.order]
    if len(rates) == 1:
        return angles
    # The longest window counts: its rate over time is integrated by trapezoids, one window being one cycle.
    slowest = np.min(rates, axis=0)
    turned = np.cumsum(np.diff(times) * (slowest[1:] + slowest[:-1]) / 2)
    return np.asarray(angles[0] + cycle * np.concatenate([[0.0], turned]))
