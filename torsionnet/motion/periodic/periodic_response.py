"""Periodic response of a drivetrain: every steady motion over frequency or speed, and the largest of them by orders.

Several motions may be stable at one speed; which of them is met depends on where the machine comes from. A result that
has one value at a speed, as those of orders and limits, takes for every output the motion of largest half range among
the stable ones, and tells where sweeps jump.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.phrases import phrase
from torsionnet.base.registers import Same
from torsionnet.base.threads import one_thread
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import named_outputs
from torsionnet.linear.responses.shared_response import shared_by_conditions
from torsionnet.machinery.orders.order_line import SUM_SEPARATOR, OrderLine
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.model.channels import Channels
from torsionnet.motion.contact_states import MotionStart
from torsionnet.motion.periodic.all_branches import FoundBranch, ListedMotion, all_branches, with_peaks, without_start
from torsionnet.motion.periodic.branch import BranchPoint, located_fold
from torsionnet.motion.periodic.condensed import CondensedPlant
from torsionnet.motion.periodic.forcing import Forcing, Torques, order_request, over_frequency, over_speed
from torsionnet.motion.periodic.periodic_problem import (
    MORE,
    Harmonics,
    PeriodicMotion,
    PeriodicProblem,
    peak_to_peak,
    unpacked,
)
from torsionnet.motion.periodic.periodic_result import EDGES, FoundMotion, PeriodicResponse, periodic_notes
from torsionnet.motion.periodic.stability import Stability, stability_of

POINTS_READ = 1000
"""Points in a period at which outputs are read for their extremes, besides all corners."""
BEGUN = {"doubling": "doubled", "symmetry": "lopsided"}
"""Words for branches that begin where others fork, by the kind of the fork."""
ENOUGH = 1e-5
"""Share of a swing that the last harmonics may move where laws have steps."""
AROUND = (0.8, 1.25)
"""Range over a single place in which branches are followed: doubled motions begin beside it."""
AMPLITUDES = 16
"""Harmonics of the torques' period whose amplitudes a result keeps."""


def periodic_response(
    drivetrain: AssembledModel,
    output: Channels,
    *,
    frequencies: ArrayLike | None = None,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitation: Torques | str | Iterable[str] | None = None,
    harmonics: Harmonics = "auto",
    subharmonics: int = 1,
    initial_state: str | MotionStart | None = None,
) -> PeriodicResponse:
    """Periodic motions with all laws of motion in full: every branch found, its stability, and where it jumps.

    The unknowns are the twists of the laws of motion; everything else answers with its exact dynamic stiffness. Between
    the places asked for, those are added at which an output swings further than at both beside it.

    Parameters
    ----------
    output : str, Sensor or sequence of these
        As for :meth:`frequency_response`.
    frequencies : (n,) array, optional
        Hz, above 0: of torques given by ``excitation``.
    speeds : (n,) array, optional
        rad/s, above 0: of the excitations of the model, as for :meth:`order_response`; default: those of the model.
    speed_of : str, optional
        The node they belong to; default: that of the model.
    excitation : mapping, str or iterable of str, optional
        Over frequency the torques by input or node, the amplitude in N m, or amplitudes by harmonic with the mean at
        0, as ``{"T_M": {0: 40, 1: 60}}``; over speed the names of excitations, by default all. Nodes without a mean
        keep that of the operating point.
    harmonics : int or "auto"
        ``"auto"`` takes as many as it needs until further ones move less than 1e-6 of the swing. 1 is the method of
        describing functions; a note says how far it is off.
    subharmonics : int
        Most periods of the torques after which a motion may repeat: 2 follows the doubled motions, 4 those doubled
        again. Where motions double is told in any case.
    initial_state : str or MotionStart, optional
        State as for :meth:`simulate`, from which motions are also simulated at both ends and in the middle of the
        range, for branches that no other start leads to.

    Raises
    ------
    UsageError
        Unknown names, mean torques that do not balance, no laws of motion.
    SolveError
        No periodic motion was found, or all lie beyond the table of a law.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.Drivetrain("rig", [tn.Inertia("mass", node="a", inertia=1),
    ...     tn.Spring("spring", nodes=("a", "ground"), stiffness=1, cubic=0.1, damping=0.05)])
    >>> response = rig.periodic_response("a", frequencies=[1.2/6.283185307], excitation={"a": 0.18})
    >>> sorted((round(float(at.highest[0]), 4), at.stability) for at in response.motions_at(1.2/6.283185307))
    [(0.4177, 'stable'), (2.2866, 'unstable: leaves'), (2.5456, 'stable')]
    """
    _require(frequencies, speeds, speed_of, harmonics, subharmonics)
    if excitation is not None and not isinstance(excitation, str | Mapping):
        excitation = tuple(excitation)
    forcing = (
        over_frequency(drivetrain, frequencies, excitation)  # type: ignore[arg-type]
        if frequencies is not None
        else over_speed(drivetrain, speeds, speed_of, excitation)
    )
    plant = CondensedPlant(forcing.drivetrain, forcing.inputs, forcing.reference)
    if not plant.laws:
        text = "the drivetrain has no laws of motion: it is linear, and has a frequency or order response"
        raise UsageError(text, kind="no-effect")
    readings = named_outputs(plant.placed.drivetrain, output)
    plant.require_balance(forcing.drive.loads(float(forcing.parameters[0]))[0].real)
    low, high = float(forcing.parameters[0]), float(forcing.parameters[-1])
    if low == high and subharmonics > 1:
        low, high = low * AROUND[0], high * AROUND[1]
    problem = PeriodicProblem(plant, forcing.drive, high)
    with one_thread():
        branches = _branches(forcing, problem, excitation, (low, high), harmonics, subharmonics, initial_state)
        if branches:
            return _result(forcing, readings, branches, harmonics)
        raise SolveError(without_start(problem, low, "rad/s" if forcing.reference else "Hz"), kind="no-period")


def _branches(
    forcing: Forcing,
    problem: PeriodicProblem,
    excitation: Any,
    ends: tuple[float, float],
    harmonics: Harmonics,
    subharmonics: int,
    state: str | MotionStart | None,
) -> list[FoundBranch]:
    """Branches between two parameters; those over speed are kept, since orders and limits ask for other outputs."""
    if not forcing.reference or state is not None:
        return all_branches(problem, *ends, harmonics, subharmonics, state)
    acting = tuple(map(Same, forcing.drivetrain.definition.excitations.values()))
    key = ("branches", acting, excitation, forcing.reference, ends, harmonics, subharmonics)

    def size(branches: list[FoundBranch]) -> int:
        return sum(4 * point.u.nbytes for branch in branches for point in branch.branch.points)

    return shared_by_conditions(
        forcing.drivetrain, list, key, lambda: all_branches(problem, *ends, harmonics, subharmonics), size
    )


def _require(frequencies: Any, speeds: Any, speed_of: str | None, harmonics: Any, subharmonics: Any) -> None:
    if frequencies is not None and (speeds is not None or speed_of is not None):
        text = "give frequencies, or speeds and the node that they are of, not both"
        raise UsageError(text, kind="contradicting-entries")
    if harmonics != "auto" and not (isinstance(harmonics, int) and harmonics >= 1):
        text = f'harmonics is "auto" or a whole number from 1 on, got {harmonics!r}'
        raise UsageError(text, kind="out-of-range")
    if not (isinstance(subharmonics, int) and subharmonics >= 1 and subharmonics & (subharmonics - 1) == 0):
        text = f"subharmonics is 1, 2, 4 or another power of 2, got {subharmonics!r}"
        raise UsageError(text, kind="out-of-range")


def _result(
    forcing: Forcing, readings: Sequence[Functional], branches: Sequence[FoundBranch], harmonics: Harmonics
) -> PeriodicResponse:
    over: Literal["frequency", "speed"] = "speed" if forcing.reference else "frequency"
    motions: list[FoundMotion] = []
    beyond: list[tuple[int, float, str]] = []
    missed: list[float] = []
    unsure: list[tuple[str, float]] = []
    for number, branch in enumerate(branches):
        listed = list(motions_along(branch, forcing.parameters, harmonics, missed))
        ends = float(forcing.parameters[0]), float(forcing.parameters[-1])
        for each in with_peaks(branch, listed, readings, harmonics, ends):
            left = branch.problem.beyond(each.motion)
            if left:
                beyond.append((number, each.motion.parameter, left))
                continue
            found, why = _motion_read(branch.problem, each.motion, each.turn, number, readings, harmonics)
            motions.append(found)
            if why:
                unsure.append((why, found.at))
    if not motions:
        what = beyond[0][2] if beyond else "no motion was found where one was asked for; ask for more places"
        raise SolveError(what, kind="beyond-table" if beyond else "no-period")
    response = PeriodicResponse(
        over, forcing.reference, forcing.order, tuple(reading.channel for reading in readings), tuple(motions),
        tuple(branch.branch.way for branch in branches), forcing.drivetrain.title,
    )  # fmt: skip
    begun = {
        number: f"{BEGUN[branch.begins.kind]} at {response.shown(branch.begins.motion.parameter):.8g} {response.unit}"
        for number, branch in enumerate(branches)
        if branch.begins is not None
    }
    ways = tuple(begun.get(number, way) for number, way in enumerate(response.ways))
    return replace(response, ways=ways, notes=tuple(periodic_notes(response, branches, beyond, missed, unsure)))


def motions_along(
    branch: FoundBranch, parameters: FloatArray, harmonics: Harmonics, missed: list[float]
) -> Iterator[ListedMotion]:
    """Yield the motions of a branch in its order: those at parameters asked for, and where it turns with the kind.

    Parameters at which the branch passes, but no motion with enough harmonics was found, go to ``missed``.
    """
    crossings: list[tuple[int, PeriodicMotion, str]] = [(each.place, each.motion, each.kind) for each in branch.forks]
    crossings += [(place, motion, "second frequency") for place, motion in branch.second_frequencies]
    for number, (before, after) in enumerate(pairwise(branch.branch.points)):
        lines: list[tuple[float, PeriodicMotion, str]] = []
        lower, upper = sorted((before.p, after.p))
        inside = parameters[(parameters >= lower) & (parameters < upper)] if before.p < after.p else (
            parameters[(parameters > lower) & (parameters <= upper)]
        )  # fmt: skip
        for at in inside.tolist():
            motion = _between(branch.problem, before, after, at, harmonics)
            if motion is None:
                missed.append(at)
            else:
                lines.append((abs(at - before.p), motion, ""))
        lines += [(abs(each.parameter - before.p), each, kind) for place, each, kind in crossings if place == number]
        along = [ListedMotion(number, motion, turn) for _, motion, turn in sorted(lines, key=lambda line: line[0])]
        fold = (
            located_fold(branch.problem, before, after, branch.branch.tracer.n_laws)
            if before.turns * after.turns < 0
            else None
        )
        # What lies between the parameters of two points beside a fold is passed before it only if the branch gets
        # from one to the other in the sense in which it comes.
        ahead = (after.p - before.p) * before.turns > 0
        yield from along if ahead else ()
        if fold is not None:
            yield ListedMotion(number, fold.motion, "fold")
        yield from () if ahead else along


def _between(
    problem: PeriodicProblem, before: BranchPoint, after: BranchPoint, at: float, harmonics: Harmonics
) -> PeriodicMotion | None:
    share = (at - before.p) / (after.p - before.p)
    return problem.solve(at, unpacked(before.u + share * (after.u - before.u), len(problem.forces)), harmonics)


def _motion_read(
    problem: PeriodicProblem, motion: PeriodicMotion, turn: str, branch: int, readings: Sequence[Functional],
    harmonics: Harmonics,
) -> tuple[FoundMotion, str]:  # fmt: skip
    """Motion with its readings, and why its stability is not determined, empty where it is."""
    on_edge = turn in EDGES
    stability = stability_of(problem, motion, on_edge=on_edge)
    if problem.has_steps and harmonics == "auto":
        motion, stability = _with_steps(problem, motion, stability, on_edge=on_edge)
    amplitudes = problem.readings(motion, readings)
    if problem.has_steps and harmonics == "auto" and stability.march is not None and stability.passage is not None:
        amplitudes = stability.march.harmonics(stability.passage, readings, POINTS_READ, len(amplitudes) - 1)
    lowest, highest = _extremes(stability, amplitudes, readings)
    angles, speeds = _node_states(problem, motion, stability)
    words = stability.words
    found = FoundMotion(
        motion.parameter, branch, turn, motion.subharmonics, motion.harmonics, motion.left_out, lowest, highest,
        amplitudes[: AMPLITUDES * motion.subharmonics + 1], stability.multipliers,
        f"on the edge: {turn}" if on_edge and not stability.undetermined else words, angles, speeds,
    )  # fmt: skip
    return found, stability.undetermined


def _with_steps(
    problem: PeriodicProblem, motion: PeriodicMotion, stability: Stability, *, on_edge: bool
) -> tuple[PeriodicMotion, Stability]:
    """Motion of laws with steps, with more harmonics until its contact states close, or the last ones move little.

    Where a torque jumps over time the harmonics of the motion fall slowly; a period that closes is exact.
    """
    while stability.passage is None:
        motion = replace(motion, left_out=max(motion.left_out, problem.moved_by_last(motion)))
        if motion.left_out < ENOUGH or motion.harmonics * MORE > problem.most_harmonics:
            break
        finer = problem.solve(motion.parameter, motion.x, int(motion.harmonics * MORE))
        if finer is None:
            break
        motion, stability = finer, stability_of(problem, finer, on_edge=on_edge)
    return motion, stability


def _extremes(stability: Stability, amplitudes: Any, readings: Sequence[Functional]) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest values (n_out,), over contact states where the motion has a passage through them."""
    ends = np.array([peak_to_peak(column) for column in amplitudes.T]).reshape(-1, 2)
    if stability.march is not None and stability.passage is not None and len(amplitudes) > 2:
        return stability.march.extremes(stability.passage, readings, POINTS_READ)
    return ends[:, 0], ends[:, 1]


def _node_states(
    problem: PeriodicProblem, motion: PeriodicMotion, stability: Stability
) -> tuple[Mapping[str, float], Mapping[str, float]]:
    """Angles in rad and speeds in rad/s of all nodes at the beginning of the period."""
    assembly = problem.plant.assembly
    if stability.march is not None and stability.passage is not None:
        first = stability.passage.stretches[0]
        position, speed, _ = stability.march.states.form(first.contact).motion
        q, v = position @ first.z, speed @ first.z
    else:
        harmonics = problem.coordinates(motion)[0]
        s = 1j * motion.omega * np.arange(len(harmonics))[:, None]
        # At t = 0 every exp(j k omega t) is 1: sums of harmonics, of the rates with j k omega before them.
        q, v = harmonics.sum(axis=0).real, (s * harmonics).sum(axis=0).real
    if problem.plant.turning.any():
        # The free body turns on at the mean speed of the reference node, which the harmonics do not have.
        (turning,) = problem.plant.free.T
        v = v + turning * problem.drive.speed(motion.parameter) / (problem.plant.driven @ turning)
    angles, speeds = assembly.T @ q, assembly.T @ v
    return dict(zip(assembly.nodes, angles.tolist(), strict=True)), dict(
        zip(assembly.nodes, speeds.tolist(), strict=True)
    )


SUBHARMONICS = 4
"""Most periods of the torques after which motions repeat whose orders are looked for."""
EDGE = 0.01
"""Distance from the unit circle of a multiplier that passes it, at a place that is located."""
SMALLEST_ORDER = 1e-6
"""Amplitude of an order, over the largest half range of its output, below which it is left out."""
TAKEN = "laws of motion in full: at every speed the largest motion of each output that is stable"
"""Text of the note on the motions whose orders an order response holds."""
BETWEEN = "between the speeds given those are added at which branches of motions turn or outputs have a peak"
"""Text of the note on the speeds that are added to those of a range."""
UNMET = "{where} no motion found is stable: the values there are of one that is not met"
"""Text of the note on the speeds at which the motion of an order response is not stable."""
OPEN = "{where} it is not determined whether the largest motion is stable"
"""Text of the note on the speeds at which the motion of an order response may not be stable."""


@dataclass(frozen=True, eq=False, repr=False)
class PeriodicOrders(OrderResponse):
    """Orders of periodic motion over speed, at every speed and output those of the largest motion that is stable.

    Lines are orders of the reference shaft, of all excitations together, also those that the motion alone has. Half
    ranges are those of the motions, not of the orders kept.

    Attributes
    ----------
    motions : PeriodicResponse
        All motions found, their stability, and where sweeps jump.
    """

    motions: PeriodicResponse = field(kw_only=True)

    @cached_property
    def taken(self) -> tuple[tuple[FoundMotion, ...], ...]:
        """Motion of every output, speed by speed."""
        places = range(len(self.outputs))
        return tuple(tuple(largest_met(self.motions, at, place) for place in places) for at in self.speeds.tolist())

    @cached_property
    def _known_bounds(self) -> dict[int, FloatArray]:
        half_ranges = np.zeros((2, len(self.speeds), len(self.outputs)))
        for number, row in enumerate(self.taken):
            for place, motion in enumerate(row):
                mean = motion.amplitudes[0, place].real
                half_ranges[:, number, place] = motion.highest[place] - mean, motion.lowest[place] - mean
        return dict(enumerate(np.moveaxis(half_ranges, 2, 0)))

    @property
    def open_notes(self) -> tuple[str, ...]:
        """Notes on speeds at which the motions taken are not stable, or may not be."""
        return tuple(unsettled(self.speeds, self.taken))

    @property
    def unmet(self) -> NDArray[np.bool_]:
        return np.array([any(_stable(motion) is False for motion in row) for row in self.taken])


def periodic_orders(
    drivetrain: AssembledModel,
    output: Channels,
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitation: str | Iterable[str] | None = None,
    between: bool = False,
) -> PeriodicOrders:
    """Orders of the periodic motions of a drivetrain over speed, its laws of motion in full.

    Parameters
    ----------
    output, speeds, speed_of, excitation
        As for :meth:`order_response`.
    between : bool
        Whether those speeds between are added at which branches end, turn or have peaks: there a value is largest.

    Raises
    ------
    UsageError
        As for :meth:`order_response` and :meth:`periodic_response`; excitations with several cases.
    SolveError
        No periodic motion was found at a speed.
    """
    names = excitation if excitation is None or isinstance(excitation, str) else tuple(excitation)
    request = order_request(drivetrain, speeds, speed_of, names)
    at = np.unique(request.speeds)
    searched = _searched(drivetrain, request.reference, at)

    def found_at(those: FloatArray) -> PeriodicResponse:
        return periodic_response(
            drivetrain, output, speeds=np.concatenate([those, searched]), speed_of=request.reference,
            excitation=names, subharmonics=SUBHARMONICS,
        )  # fmt: skip

    response = found_at(at)
    turns = (*response.turns(), *response.peaks)
    turned = np.array([turn.at for turn in turns if between and at[0] < turn.at < at[-1]])
    if len(turned):
        at = np.unique(np.concatenate([at, turned]))
        response = found_at(at)
    taken = [[largest_met(response, speed, place) for place in range(len(response.outputs))] for speed in at.tolist()]
    lines, values = _orders(response, taken, SUM_SEPARATOR.join(request.excitations))
    notes = (TAKEN, *([BETWEEN] if between else []), *response.jump_sentences, *unsettled(at, taken), *response.notes)
    return PeriodicOrders(
        at, request.reference, lines, values, response.outputs, response.title, notes=notes, motions=response,
    )  # fmt: skip


def largest_met(response: PeriodicResponse, at: float, place: int) -> FoundMotion:
    """Motion at a speed in rad/s with the largest half range of an output that is stable, or may be.

    A motion on the edge counts as stable, as the end of those that are. Where none is stable it is the largest of all.

    Raises
    ------
    UsageError
        No motion was found at this speed.
    """
    here = [motion for motion in response.motions if math.isclose(motion.at, at, rel_tol=1e-9)]
    if not here:
        text = "no periodic motion was found; simulate shows what happens there"
        raise UsageError(f"at {response.shown(at):.6g} {response.unit} {text}", kind="no-period")
    met = [motion for motion in here if _stable(motion) is not False] or here
    return max(met, key=lambda motion: float(motion.highest[place] - motion.lowest[place]))


def _stable(motion: FoundMotion) -> bool | None:
    if motion.on_edge:
        return bool((np.abs(motion.multipliers) < 1 + EDGE).all())
    return motion.is_stable


def _searched(drivetrain: AssembledModel, reference: str, at: FloatArray) -> FloatArray:
    """Ends in rad/s of the speeds over which branches are followed: those of the model, that all calls share."""
    given = drivetrain.definition.speeds
    if given is not None and given.of == reference:
        return np.array([min(at[0], *given.values), max(at[-1], *given.values)])
    return at[[0, -1]] if len(at) > 1 else at[0] * np.array(AROUND)


def _orders(
    response: PeriodicResponse, taken: Sequence[Sequence[FoundMotion]], name: str
) -> tuple[tuple[OrderLine, ...], ComplexArray]:
    """Order lines of motions, and amplitudes (n_speeds, n_lines, n_out): of doubled motions half orders, too."""
    motions = [motion for row in taken for motion in row]
    periods = math.lcm(*(motion.periods for motion in motions))
    count = max((len(motion.amplitudes) - 1) * periods // motion.periods for motion in motions)
    values = np.zeros((len(taken), count, len(response.outputs)), dtype=complex)
    sizes = np.zeros(len(response.outputs))
    for number, row in enumerate(taken):
        for place, motion in enumerate(row):
            # Harmonic k of a motion of p periods is harmonic k P/p of P periods.
            each = periods // motion.periods
            values[number, each - 1 : (len(motion.amplitudes) - 1) * each : each, place] = motion.amplitudes[1:, place]
            sizes[place] = max(sizes[place], response.peak_to_peak(motion, response.outputs[place].name) / 2)
    kept = (np.abs(values) > SMALLEST_ORDER * sizes).any(axis=(0, 2))
    base = Fraction(response.order).limit_denominator(10**6) / periods
    lines = tuple(OrderLine(name, float(base * (number + 1)), Fraction(1)) for number in np.flatnonzero(kept).tolist())
    return lines, values[:, kept]


def unsettled(at: FloatArray, taken: Sequence[Sequence[FoundMotion]]) -> Iterator[str]:
    """Sentences on speeds at which the motion taken is unstable, or its stability is not determined."""
    states = [{_stable(motion) for motion in row} for row in taken]
    for state, text in ((False, UNMET), (None, OPEN)):
        speeds = at[[state in each for each in states]] * RPM
        if len(speeds):
            at_one, several = "at {at:.6g} rpm", "from {low:.6g} to {high:.6g} rpm"
            where = phrase(several, low=speeds[0], high=speeds[-1]) if len(speeds) > 1 else phrase(at_one, at=speeds[0])
            yield phrase(text, where=where)
