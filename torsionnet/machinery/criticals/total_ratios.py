"""Revolutions of one shaft per revolution of another, kept for all drivetrains with the same rows."""

from __future__ import annotations

from fractions import Fraction

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.model.speeds import total_ratio


def cached_total_ratio(drivetrain: AssembledModel, node: str, reference: str) -> Fraction:
    """Mean speed of a node over that of the reference node, as a fraction, negative if it turns the other way.

    See :func:`torsionnet.model.speeds.total_ratio`.
    """
    return drivetrain.assembly.system.memo.once(
        Fraction,
        ("total ratio", node, reference),
        lambda: total_ratio(drivetrain.definition, drivetrain.exact_values, node, reference),
    )
