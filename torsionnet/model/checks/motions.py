"""Motions of the drivetrain that some of its laws do not resist."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from torsionnet.model.elements import Law
from torsionnet.model.elimination import Reduction, exact, reduce_rows
from torsionnet.model.kinematics import Kinematics, exact_row, pseudo_node


def free_motions(kinematics: Kinematics, answers: Callable[[Law], bool]) -> Reduction:
    """Reduction of the drivetrain to the motions that leave every law chosen by the function ``answers`` without twist.

    Imposed angles stand still.
    """
    imposed = [{pseudo_node(name): 1} for name in kinematics.imposed]
    rows = [exact_row(law.row) for _, law in kinematics.laws if answers(law)]
    order = {name: index for index, name in enumerate((*kinematics.nodes, *map(pseudo_node, kinematics.imposed)))}
    return kinematics.reduction.followed_by([*imposed, *rows], order)


def count_held_motions(kinematics: Kinematics) -> int:
    """Number of motions without a spring that a torque holds which follows a constant angle, as of a governor.

    As that of a governor does which integrates the speed. A torque that acts between parts turning as one holds none.
    """
    acting = [action for _, action in kinematics.actions if action.acts_at_rest]
    if not acting:
        return 0
    left = free_motions(kinematics, lambda law: law.holds_at_rest)
    torques: dict[str, dict[str, Fraction]] = {}
    for action in acting:
        gain = next(exact(value) for value in action.numerator if value != 0)
        driven, sensed = (left.reduced(exact_row(row)) for row in (action.row, action.sensed))
        for name, lever in driven.items():
            row = torques.setdefault(name, {})
            for other, share in sensed.items():
                row[other] = row.get(other, Fraction(0)) + gain * lever * share
    rows = [{name: value for name, value in row.items() if value} for row in torques.values()]
    return reduce_rows(rows, {name: place for place, name in enumerate(kinematics.coordinates)}).rank
