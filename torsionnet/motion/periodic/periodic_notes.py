"""Notes of a periodic response: what was left out, where branches stop and motions change, and what may be missing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

import numpy as np

from torsionnet.model.motion_laws.smooth_curves import CubicCurve
from torsionnet.motion.periodic.all_branches import FoundBranch
from torsionnet.motion.periodic.periodic_result import PeriodicResponse

FEW_HARMONICS = "with {count} harmonic{s}, further ones would move the twist of a law by up to {share:.1g} of its swing"
MORE = "there may be more: branches that none of these starts leads to are not found"
CLOSER = 4.669201609
"""Factor by which doublings of a cascade follow each other ever closer (M. J. Feigenbaum, 1978)."""
NOTHING = 1e-7
"""Distance of a multiplier from 1 that is rounding."""
MANY = 3
"""Doublings one after the other from which on a cascade is expected."""


def periodic_notes(
    response: PeriodicResponse,
    branches: Sequence[FoundBranch],
    beyond: Sequence[tuple[int, float, str]],
    missed: Sequence[float],
    unsure: Sequence[tuple[str, float]],
) -> Iterator[str]:
    """Yield the notes of a response.

    ``beyond`` are motions beyond tables by branch and place, with the reason, ``missed`` places at which a branch
    passes without a motion found, and ``unsure`` places by the reason for which stability is not determined.
    """
    off = [motion for motion in response.motions if motion.left_out > 1e-5]
    if off:
        worst = max(off, key=lambda motion: motion.left_out)
        s = "" if worst.harmonics == 1 else "s"
        yield FEW_HARMONICS.format(count=worst.harmonics, s=s, share=worst.left_out)
    doubled = {branch.problem.subharmonics for branch in branches}
    for turn in response.turns("doubling"):
        follow = "" if 2 * turn.periods in doubled else f"; subharmonics={2 * turn.periods} follows it"
        yield f"at {_at(response, turn.at)} the motion of branch {turn.branch + 1} doubles its period{follow}"
    for turn in response.turns("symmetry"):
        text = "loses its symmetry, and two lopsided ones begin, mirror images of each other: one at most is followed"
        yield f"at {_at(response, turn.at)} the motion of branch {turn.branch + 1} {text}"
    for turn in response.turns("second frequency"):
        text = "passes into motions with a second frequency, which no period repeats; simulate shows them"
        yield f"at {_at(response, turn.at)} the motion of branch {turn.branch + 1} {text}"
    yield from _cascades(response, branches)
    for number, each in enumerate(branches):
        for motion, why in each.branch.stops:
            owner, swing = each.problem.largest_twist(motion)
            place = f"at {_at(response, motion.parameter)}, where {owner} swings by {swing:.4g} rad"
            yield f"branch {number + 1} stops {place}: {why}; simulate shows what follows"
        for fork in each.unfollowed:
            begins = f"the branch that begins at {_at(response, fork.motion.parameter)}"
            yield f"{begins} is not followed to its end: those found before are long"
    for number, group in groupby(beyond, key=lambda each: each[0]):
        places = list(group)
        span = _span(response, sorted(at for _, at, _ in places))
        yield f"{span} motions of branch {number + 1} are left out: {places[0][2]}"
    if missed:
        yield f"{_span(response, sorted(missed))} a branch passes, but with the harmonics it needs none was found there"
    for why, same in groupby(sorted(unsure), key=lambda each: each[0]):
        yield f"{_span(response, [at for _, at in same])} stability is not determined: {why}"
    yield from _held(response)
    yield from _unstable(response, branches)
    yield MORE


def _at(response: PeriodicResponse, at: float) -> str:
    return f"{response.shown(at):.8g} {response.unit}"


def _span(response: PeriodicResponse, places: Sequence[float]) -> str:
    if len(places) == 1:
        return f"at {response.shown(places[0]):.6g} {response.unit}"
    low, high = response.shown(places[0]), response.shown(places[-1])
    return f"at {len(places)} places from {low:.6g} to {high:.6g} {response.unit}"


def _cascades(response: PeriodicResponse, branches: Sequence[FoundBranch]) -> Iterator[str]:
    """Yield a note for each row of doublings that goes on, with the place at which it would have become chaos."""
    for branch in branches:
        doublings = [each.motion.parameter for each in branch.forks if each.kind == "doubling"]
        if not doublings:
            continue
        last, chain = branch, []
        while last.begins is not None and last.begins.kind == "doubling":
            chain.append(last.begins.motion.parameter)
            last = next(each for each in branches if last.begins in each.forks)
        if len(chain) + 1 < MANY:
            continue
        nearest = min(doublings, key=lambda at: abs(at - chain[0]))
        row = np.array([*reversed(chain), nearest])[-MANY:]
        steps = np.diff(row)
        if steps[0] * steps[1] <= 0 or abs(steps[1]) >= abs(steps[0]):
            continue
        # what is left of the row is a geometric series of steps
        chaos = row[-1] + steps[1] / (CLOSER - 1)
        shown = ", ".join(f"{response.shown(at):.6g}" for at in row)
        text = f"doublings follow each other ever closer, at {shown} {response.unit}: a cascade without an end"
        yield f"{text}, beyond about {response.shown(chaos):.5g} {response.unit} chaos; simulate shows it"


def _held(response: PeriodicResponse) -> Iterator[str]:
    """Yield a note where friction sticks all along: its slider may stand elsewhere, and nothing brings it back."""
    held = {
        one.at for one in response.motions if one.is_stable and np.abs(one.multipliers).max(initial=0.0) > 1 - NOTHING
    }
    if held:
        text = "friction sticks all along, with any mean torque that it holds: the mean may differ by what was before"
        yield f"{_span(response, sorted(held))} {text}"


def _unstable(response: PeriodicResponse, branches: Sequence[FoundBranch]) -> Iterator[str]:
    places = sorted({motion.at for motion in response.motions if not motion.turn})
    lonely = [at for at in places if response.motions_at(at) and not response.stable_at(at)]
    sure = [at for at in lonely if all(motion.is_stable is False for motion in response.motions_at(at))]
    if not sure:
        return
    text = "none of the motions found is stable: what is met doubles, has a second frequency, or is chaotic"
    for law in branches[0].problem.plant.laws if branches else ():
        curve = law.law.curve
        if isinstance(curve, CubicCurve) and curve.cubic < 0:
            # k g + k_3 g^3 = 0
            end = float(np.sqrt(curve.stiffness / -curve.cubic))
            text += f", or runs away: beyond {end:.4g} rad {law.owner} pushes on outward"
    yield f"{_span(response, sure)} {text}; simulate shows it"
