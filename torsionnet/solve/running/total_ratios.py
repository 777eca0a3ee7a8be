"""Revolutions of one shaft per revolution of another, found once for all that has the same rows."""

from __future__ import annotations

from fractions import Fraction

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.model.speeds import total_ratio


def remembered_ratio(drivetrain: AssembledModel, node: str, reference: str) -> Fraction:
    """Speed of a node over that of the reference; see :func:`torsionnet.model.speeds.total_ratio`."""
    return drivetrain.assembly.system.memo.once(
        Fraction,
        ("total ratio", node, reference),
        lambda: total_ratio(drivetrain.definition, drivetrain.exact_values, node, reference),
    )
