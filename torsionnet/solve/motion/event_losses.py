"""Laws of motion that turn energy into heat at once where they change their piece."""

from __future__ import annotations

from collections.abc import Sequence

from torsionnet.solve.motion.phases import LawPhases


def losing_law(laws: Sequence[LawPhases], before: Sequence[int], after: Sequence[int]) -> str:
    """Element that may turn energy into heat at the change from one contact state to another; empty if none does.

    A preload that catches a row takes the energy of its motion. Friction that begins to slip at less than it stuck with
    lets what has no inertia beyond it, as the spring of a friction with stiffness, go back at once.
    """
    for law, one, other in zip(laws, before, after, strict=True):
        if one == other:
            continue
        catches = law.phases[other].kind == "hold" and not law.over_rate
        lets_go = law.over_rate and law.phases[other].kind != "hold"
        if catches or lets_go:
            return law.owner
    return ""
