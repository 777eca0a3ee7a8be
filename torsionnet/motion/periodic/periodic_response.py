"""Periodic response of a drivetrain: every steady motion that is found over frequency or speed, and its stability."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.registers import Same
from torsionnet.base.threads import one_thread
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import named_outputs
from torsionnet.linear.responses.shared_response import shared_by_conditions
from torsionnet.model.channels import Channels
from torsionnet.motion.contact_states import MotionStart
from torsionnet.motion.periodic.all_branches import FoundBranch, all_branches
from torsionnet.motion.periodic.branch import BranchPoint, located_fold
from torsionnet.motion.periodic.condensed import CondensedPlant
from torsionnet.motion.periodic.forcing import Forcing, Torques, over_frequency, over_speed
from torsionnet.motion.periodic.harmonic_balance import unpacked
from torsionnet.motion.periodic.peaks import ListedMotion, with_peaks
from torsionnet.motion.periodic.periodic_notes import periodic_notes
from torsionnet.motion.periodic.periodic_problem import (
    MORE,
    Harmonics,
    PeriodicMotion,
    PeriodicProblem,
    peak_to_peak,
)
from torsionnet.motion.periodic.periodic_result import EDGES, FoundMotion, PeriodicResponse
from torsionnet.motion.periodic.stability import Stability, stability_of
from torsionnet.motion.periodic.starts import without_start

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
