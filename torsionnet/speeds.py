"""Mean speeds carried through the drivetrain, and the total ratio between two nodes.

On average no spring winds up, so springs pass a mean speed on like rigid connections. Clamps and connections to ground
are left out: a rig that is locked for a test keeps its ratios.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from torsionnet.definition import Definition, all_nodes
from torsionnet.elements import Values
from torsionnet.elimination import exact, reduce_rows, substitute
from torsionnet.errors import Fault, ModelError, UsageError, did_you_mean
from torsionnet.kinematics import exact_row
from torsionnet.operating_point import OperatingPoint

_UNIT = "one"


def holding_rows(definition: Definition, values: Mapping[str, Any]) -> list[dict[str, Fraction]]:
    """Rows that vanish at steady mean speed."""
    value = Values(values)
    rows = [exact_row(row) for element in definition.active for row in element.holds(value)]
    return [row for row in rows if len(row) > 1]


def total_ratio(definition: Definition, values: Mapping[str, Any], first: str, second: str) -> float:
    """Speed of ``first`` over speed of ``second``.

    Raises
    ------
    UsageError
        Unknown nodes, nodes that are not connected by ratios, or a differential or planetary set in between whose
        third member is free.
    """
    nodes = all_nodes(definition.active)
    for node in (first, second):
        if node not in nodes:
            msg = f'no node is named "{node}"{did_you_mean(node, nodes)}'
            raise UsageError(msg)
    order = {node: index for index, node in enumerate(nodes)}
    solved = reduce_rows(holding_rows(definition, values), order).solved
    row, other = (substitute({node: Fraction(1)}, solved) for node in (first, second))
    if not other:
        msg = f"{second} cannot turn, there is no ratio to it"
        raise UsageError(msg)
    if row and row.keys() != other.keys():
        free = ", ".join(sorted(row.keys() | other.keys()))
        msg = f"no fixed ratio between {first} and {second}: {free} turn independently"
        raise UsageError(msg)
    ratios = {row.get(node, Fraction(0)) / other[node] for node in other}
    if len(ratios) > 1:
        msg = f"no fixed ratio between {first} and {second}: the speed splits in between"
        raise UsageError(msg)
    return float(ratios.pop())


def mean_speeds(definition: Definition, values: Mapping[str, Any]) -> dict[str, float]:
    """Mean speed in rad/s of every node that the operating point determines."""
    given = _numbers(definition.operating_point, values)
    order = {node: index for index, node in enumerate(all_nodes(definition.active))}
    rows: list[dict[str, Fraction]] = [
        {node: Fraction(1), _UNIT: -speed} for node, speed in given.items() if node in order
    ]
    reduction = reduce_rows([*holding_rows(definition, values), *rows], order, {_UNIT})
    if reduction.blocked:
        raise ModelError([Fault(_contradiction(definition, rows), ("operating_point", "speed"))])
    solved = reduction.solved
    return {
        node: float(solved[node].get(_UNIT, 0)) for node in order if node in solved and solved[node].keys() <= {_UNIT}
    }


def mean_torques(definition: Definition, values: Mapping[str, Any]) -> dict[str, float]:
    """Mean external torque in N m on the nodes for which the operating point gives one."""
    return {node: float(value.evaluate(values)) for node, value in definition.operating_point.torque.items()}


def _numbers(point: OperatingPoint, values: Mapping[str, Any]) -> dict[str, Fraction]:
    return {node: exact(value.evaluate(values)) for node, value in point.speed.items()}


def _contradiction(definition: Definition, rows: list[dict[str, Fraction]]) -> str:
    shown = ", ".join(
        f"{node} {definition.operating_point.speed[node]}" for row in rows for node in row if node != _UNIT
    )
    return f"the mean speeds ({shown}) do not fit the ratios between these nodes"
