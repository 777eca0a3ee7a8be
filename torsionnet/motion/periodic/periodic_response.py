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
from torsionnet.linear.dynamic_stiffness.transfer_request import named_output
from torsionnet.linear.responses.shared_response import shared_by_conditions
from torsionnet.model.channels import Channels, Sensor
from torsionnet.motion.periodic.all_branches import FoundBranch, all_branches
from torsionnet.motion.periodic.branch import BranchPoint, located_fold
from torsionnet.motion.periodic.condensed import CondensedPlant
from torsionnet.motion.periodic.doubling import Doubling
from torsionnet.motion.periodic.forcing import Forcing, Torques, over_frequency, over_speed
from torsionnet.motion.periodic.harmonic_balance import unpacked
from torsionnet.motion.periodic.periodic_problem import Harmonics, PeriodicMotion, PeriodicProblem, peak_to_peak
from torsionnet.motion.periodic.periodic_result import FoundMotion, PeriodicResponse
from torsionnet.motion.periodic.stability import Stability, stability_of

POINTS_READ = 1000
"""Points in a period at which outputs are read for their extremes, besides all corners."""
AMPLITUDES = 16
"""Harmonics of the torques' period whose amplitudes a result keeps."""
FEW_HARMONICS = "with {count} harmonic{s}, further ones would move the twist of a law by up to {share:.1g} of its swing"
MORE = "there may be more: branches that none of these starts leads to are not found"


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
) -> PeriodicResponse:
    """Periodic motions with all laws of motion in full: every branch found, its stability, and where it jumps.

    The unknowns are the twists of the laws of motion; everything else answers with its exact dynamic stiffness.

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

    Raises
    ------
    UsageError
        Unknown names, mean torques that do not balance, no laws of motion.
    SolveError
        No periodic motion was found.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.Drivetrain("rig", [tn.Inertia("mass", node="a", inertia=1),
    ...     tn.Spring("spring", nodes=("a", "ground"), stiffness=1, cubic=0.1, damping=0.05)])
    >>> found = rig.periodic_response("a", frequencies=[1.2/6.283185307], excitation={"a": 0.18})
    >>> sorted((round(float(one.highest[0]), 4), one.stability) for one in found.motions_at(1.2/6.283185307))
    [(0.4177, 'stable'), (2.2866, 'unstable: leaves'), (2.5456, 'stable')]
    """
    _require(frequencies, speeds, harmonics, subharmonics)
    if excitation is not None and not isinstance(excitation, str | Mapping):
        excitation = tuple(excitation)
    forcing = (
        over_frequency(drivetrain, frequencies, excitation)  # type: ignore[arg-type]
        if frequencies is not None
        else over_speed(drivetrain, speeds, speed_of, excitation)
    )
    plant = CondensedPlant(forcing.drivetrain, forcing.inputs)
    if not plant.laws:
        text = "the drivetrain has no laws of motion: it is linear, and has a frequency or order response"
        raise UsageError(text, kind="no-effect")
    asked = [output] if isinstance(output, str | Sensor) else list(output)
    readings = [named_output(plant.placed.drivetrain, one) for one in asked]
    plant.require_balance(forcing.drive.loads(float(forcing.parameters[0]))[0].real)
    low, high = float(forcing.parameters[0]), float(forcing.parameters[-1])
    problem = PeriodicProblem(plant, forcing.drive, high)
    with one_thread():
        branches = _branches(forcing, problem, excitation, (low, high), harmonics, subharmonics)
        if branches:
            return _result(forcing, readings, branches, harmonics)
    text = "from rest no periodic motion was reached; a time simulation shows what the drivetrain does"
    unit = "rad/s" if forcing.reference else "Hz"
    raise SolveError(f"{text} between {low:.6g} and {high:.6g} {unit}", kind="no-period")


def _branches(
    forcing: Forcing,
    problem: PeriodicProblem,
    excitation: Any,
    ends: tuple[float, float],
    harmonics: Harmonics,
    subharmonics: int,
) -> list[FoundBranch]:
    """Branches between two parameters; those over speed are kept, since orders and limits ask for other outputs."""
    if not forcing.reference:
        return all_branches(problem, *ends, harmonics, subharmonics)
    acting = tuple(map(Same, forcing.drivetrain.definition.excitations.values()))
    key = ("branches", acting, excitation, forcing.reference, ends, harmonics, subharmonics)

    def size(found: list[FoundBranch]) -> int:
        return sum(4 * point.u.nbytes for one in found for point in one.branch.points)

    return shared_by_conditions(
        forcing.drivetrain, list, key, lambda: all_branches(problem, *ends, harmonics, subharmonics), size
    )


def _require(frequencies: Any, speeds: Any, harmonics: Any, subharmonics: Any) -> None:
    if frequencies is not None and speeds is not None:
        raise UsageError("give frequencies or speeds, not both", kind="contradicting-entries")
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
    for number, one in enumerate(branches):
        for motion, turn in motions_along(one, forcing.parameters, harmonics):
            motions.append(_found(one.problem, motion, turn, number, readings))
    drivetrain = forcing.drivetrain
    found = PeriodicResponse(
        over, forcing.reference, forcing.order, tuple(one.channel for one in readings), tuple(motions),
        tuple(one.branch.way for one in branches), drivetrain.title,
    )  # fmt: skip
    doubled = {
        number: f"doubled at {found.shown(one.begins.motion.parameter):.8g} {found.unit}"
        for number, one in enumerate(branches)
        if one.begins is not None
    }
    ways = tuple(doubled.get(number, way) for number, way in enumerate(found.ways))
    return replace(found, ways=ways, notes=tuple(_notes(found)))


def _notes(found: PeriodicResponse) -> Iterator[str]:
    off = [one for one in found.motions if one.left_out > 1e-5]
    if off:
        worst = max(off, key=lambda one: one.left_out)
        s = "" if worst.harmonics == 1 else "s"
        yield FEW_HARMONICS.format(count=worst.harmonics, s=s, share=worst.left_out)
    doubled = {one.periods for one in found.motions}
    for one in found.turns("doubling"):
        follow = "" if 2 * one.periods in doubled else f"; subharmonics={2 * one.periods} follows it"
        at = f"at {found.shown(one.at):.8g} {found.unit}"
        yield f"{at} the motion of branch {one.branch + 1} doubles its period{follow}"
    places = sorted({one.at for one in found.motions if not one.turn})
    lonely = [at for at in places if found.motions_at(at) and not found.stable_at(at)]
    sure = [at for at in lonely if all(one.is_stable is False for one in found.motions_at(at))]
    if sure:
        span = f"{found.shown(sure[0]):.6g} to {found.shown(sure[-1]):.6g} {found.unit}"
        text = "none of the motions found is stable: what is met doubles, has a second frequency, or is chaotic"
        yield f"at {len(sure)} places from {span} {text}; simulate shows it"
    yield MORE


def motions_along(
    one: FoundBranch, parameters: FloatArray, harmonics: Harmonics
) -> Iterator[tuple[PeriodicMotion, str]]:
    """Yield the motions of a branch in its order: those at parameters asked for, its folds and its doublings."""
    points = one.branch.points
    folds = {id(before): fold for before, fold in _folds(one)}
    for before, after in pairwise(points):
        lines: list[tuple[float, PeriodicMotion, str]] = []
        lower, upper = sorted((before.p, after.p))
        inside = parameters[(parameters >= lower) & (parameters < upper)] if before.p < after.p else (
            parameters[(parameters > lower) & (parameters <= upper)]
        )  # fmt: skip
        for at in inside.tolist():
            motion = _between(one.problem, before, after, at, harmonics)
            if motion is not None:
                lines.append((abs(at - before.p), motion, ""))
        here = (
            each.motion
            for each in one.doublings
            if lower <= each.motion.parameter < upper and _near(each, before, after)
        )
        lines += [(abs(each.parameter - before.p), each, "doubling") for each in here]
        yield from ((motion, turn) for _, motion, turn in sorted(lines, key=lambda line: line[0]))
        if id(before) in folds:
            yield folds[id(before)], "fold"


def _folds(one: FoundBranch) -> Iterator[tuple[BranchPoint, PeriodicMotion]]:
    for before, after in pairwise(one.branch.points):
        if before.turns * after.turns < 0:
            found = located_fold(one.problem, before, after, one.branch.tracer.n_laws)
            if found is not None:
                yield before, found.motion


def _between(
    problem: PeriodicProblem, before: BranchPoint, after: BranchPoint, at: float, harmonics: Harmonics
) -> PeriodicMotion | None:
    share = (at - before.p) / (after.p - before.p)
    return problem.solve(at, unpacked(before.u + share * (after.u - before.u), len(problem.forces)), harmonics)


def _near(doubling: Doubling, before: BranchPoint, after: BranchPoint) -> bool:
    """Whether a doubling lies on the branch between two points, not on another part of it at the same parameter."""
    n_laws = doubling.motion.x.shape[1]
    share = (doubling.motion.parameter - before.p) / (after.p - before.p)
    between = unpacked(before.u + share * (after.u - before.u), n_laws)
    apart = np.abs(between[:2] - doubling.motion.x[:2]).max()
    step = np.abs(unpacked(after.u - before.u, n_laws)[:2]).max()
    return bool(apart <= max(step, 0.1 * np.abs(between[1]).max()))


def _found(
    problem: PeriodicProblem, motion: PeriodicMotion, turn: str, branch: int, readings: Sequence[Functional]
) -> FoundMotion:
    stability = stability_of(problem, motion, turns=bool(turn))
    amplitudes = problem.readings(motion, readings)
    lowest, highest = _extremes(stability, amplitudes, readings)
    angles, speeds = _start(problem, motion, stability)
    words = stability.words
    return FoundMotion(
        motion.parameter, branch, turn, motion.subharmonics, motion.harmonics, motion.left_out, lowest, highest,
        amplitudes[: AMPLITUDES * motion.subharmonics + 1], stability.multipliers,
        f"on the edge: {turn}" if turn and not stability.undetermined else words, angles, speeds,
    )  # fmt: skip


def _extremes(stability: Stability, amplitudes: Any, readings: Sequence[Functional]) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest values (n_out,), over contact states where the motion has a passage through them."""
    ends = np.array([peak_to_peak(column) for column in amplitudes.T]).reshape(-1, 2)
    if stability.march is not None and stability.passage is not None and len(amplitudes) > 2:
        read = stability.march.read(stability.passage, readings, POINTS_READ)
        return read.min(axis=1), read.max(axis=1)
    return ends[:, 0], ends[:, 1]


def _start(
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
        q, v = harmonics.sum(axis=0).real, (s * harmonics).sum(axis=0).real
    angles, speeds = assembly.T @ q, assembly.T @ v
    return dict(zip(assembly.nodes, angles.tolist(), strict=True)), dict(
        zip(assembly.nodes, speeds.tolist(), strict=True)
    )
