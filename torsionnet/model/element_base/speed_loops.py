"""Second speed ratio between two shafts through a loop of springs and gears."""

from __future__ import annotations

from typing import Any

from torsionnet.model.element_base.laws import Values
from torsionnet.model.element_base.speed_path import SpeedTree

SAME_RATIO_RTOL = 1e-9
"""Relative difference of two speed ratios up to which they count as equal but for rounding."""


def second_ratio(tree: SpeedTree, start: str, value: Values) -> Any | None:
    """Speed ratio from start to end by another way than that of the tree, or None if no other ratio exists.

    A step that closes a loop leads around the steps that its start does not share with its end; the tree has closing
    steps in both directions.
    """
    ratios: dict[str, Any] = {}
    for node, step in tree.steps.items():
        ratios[node] = 1 if step is None else step.ratio(value) * ratios[step.end]
    way = _way(tree, start)
    for closing in tree.closing:
        factor = closing.ratio(value) * ratios[closing.end] / ratios[closing.start]
        if abs(factor - 1) <= SAME_RATIO_RTOL:
            continue
        here, there = _way(tree, closing.start), _way(tree, closing.end)
        if way & (here - there):
            return ratios[start] * factor
    return None


def _way(tree: SpeedTree, node: str) -> set[str]:
    """Nodes on the way from a node to the end of a speed tree, the end left out."""
    found = set[str]()
    step = tree.steps[node]
    while step is not None:
        found.add(step.start)
        step = tree.steps[step.end]
    return found
