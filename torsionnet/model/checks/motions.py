"""Motions that some laws do not feel."""

from __future__ import annotations

from collections.abc import Callable

from torsionnet.model.elements import Law
from torsionnet.model.elimination import Reduction
from torsionnet.model.kinematics import Kinematics, exact_row, pseudo_node


def left_free(kinematics: Kinematics, answers: Callable[[Law], bool]) -> Reduction:
    """The motions that leave every law at rest which ``answers``; imposed angles stand still."""
    imposed = [{pseudo_node(name): 1} for name in kinematics.imposed]
    rows = [exact_row(law.row) for _, law in kinematics.laws if answers(law)]
    order = {name: index for index, name in enumerate((*kinematics.nodes, *map(pseudo_node, kinematics.imposed)))}
    return kinematics.reduction.followed_by([*imposed, *rows], order)
