"""Loops in the ways between shafts: a spring or gear beside others, by which a second ratio may lead to a shaft."""

from __future__ import annotations

from typing import Any

from torsionnet.model.element_base.laws import Values
from torsionnet.model.element_base.speed_path import SpeedTree

ROUNDING = 1e-9
"""Of ratios of whole numbers of teeth; two that differ by more are not meant to be alike."""


def second_ratio(tree: SpeedTree, start: str, value: Values) -> Any | None:
    """Speed of the shaft at the end over that at the start by another way than that of the tree, if it differs.

    What closes a loop leads around the steps that its start does not have in common with its end; the tree has it in
    both directions.
    """
    ratios: dict[str, Any] = {}
    for node, step in tree.steps.items():
        ratios[node] = 1 if step is None else step.ratio(value) * ratios[step.end]
    way = _way(tree, start)
    for closing in tree.closing:
        factor = closing.ratio(value) * ratios[closing.end] / ratios[closing.start]
        if abs(factor - 1) <= ROUNDING:
            continue
        here, there = _way(tree, closing.start), _way(tree, closing.end)
        if way & (here - there):
            return ratios[start] * factor
    return None


def _way(tree: SpeedTree, node: str) -> set[str]:
    """Nodes at which the steps from a node to the end begin."""
    found = set[str]()
    step = tree.steps[node]
    while step is not None:
        found.add(step.start)
        step = tree.steps[step.end]
    return found
