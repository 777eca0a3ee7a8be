"""Mean speeds of all nodes, and the total ratio between two nodes.

On average no spring winds up, so springs transmit mean speeds like rigid connections. Connections to ground are left
out, and so are clamps that would stop the nodes in question: a rig that is locked for a test keeps its ratios, while a
clamped ring still makes the ratio of its planetary set, and so does one that springs tie to ground.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any, TypeAlias

from torsionnet.base.errors import Fault, ModelError, UsageError, named_list, unknown_name
from torsionnet.base.expressions import exact
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.element_base.laws import AT_REST
from torsionnet.model.elements import MotionLaw, Values
from torsionnet.model.elimination import Elimination, Reduction, reduce_rows
from torsionnet.model.kinematics import UNIT, exact_row
from torsionnet.model.operating_point import OperatingPoint

BRANCHING = ("planetary", "differential", "gear", "gearbox", "belt")
Rows: TypeAlias = list[dict[str, Fraction]]


def holding_rows(definition: Definition, values: Mapping[str, Any]) -> Rows:
    """Rows of weights by node whose sum over node speeds is zero at steady mean speeds."""
    return _rows_on_average(definition, values)[0]


def _rows_on_average(definition: Definition, values: Mapping[str, Any]) -> tuple[Rows, Rows]:
    """Rows over node speeds that are zero on average, and rows of nodes that springs tie to ground."""
    value = Values(values)
    rows = [exact_row(row) for element in definition.active for row in element.mean_speed_rows(value)]
    return [row for row in rows if len(row) > 1], [row for row in rows if len(row) == 1]


def _apart_from_friction(definition: Definition, values: Mapping[str, Any], holding: Rows) -> tuple[Rows, Rows]:
    """Rows that hold on average whatever the speeds, and those of friction, which turn as one unless speeds differ."""
    value = Values(values)
    laws = [
        part
        for element in definition.active
        if element.has_motion_laws
        for part in element.whole_parts(value)
        if isinstance(part, MotionLaw) and part.curve.over == "rate" and part.curve.holds(AT_REST)
    ]
    friction = [exact_row(law.row) for law in laws]
    return [row for row in holding if row not in friction], [row for row in holding if row in friction]


def _hold_where_possible(rows: Rows, speeds: Elimination) -> None:
    """Add rows to an elimination, each if the speeds in question stay possible."""
    for row in rows:
        if not speeds.blocks(row):
            speeds.add(row)


def _at_rest(definition: Definition, rest: Rows) -> Iterator[tuple[str, dict[str, Fraction]]]:
    """Rows over node speeds of what holds nodes still, each with the name of its clamp, empty for springs to ground.

    First what holds members of planetary sets and gears, clamps before the springs of a housing on mounts.
    """
    branching = {node for element in definition.active if element.glyph in BRANCHING for node in element.ports.values()}
    clamps = [
        (element.name, {node: Fraction(1) for node in element.ports.values()})
        for element in definition.active
        if element.glyph == "clamp"
    ]
    yield from sorted([*clamps, *(("", row) for row in rest)], key=lambda pair: branching.isdisjoint(pair[1]))


def _held_still(
    definition: Definition, rest: Rows, speeds: Sequence[Elimination]
) -> list[tuple[str, dict[str, Fraction]]]:
    """Rows that hold nodes still and leave the speeds in question possible, as :func:`_at_rest` gives them.

    Adds them to ``speeds``.
    """
    added: list[tuple[str, dict[str, Fraction]]] = []
    for name, row in _at_rest(definition, rest):
        if not any(speed.blocked or speed.blocks(row) for speed in speeds):
            added.append((name, row))
            for speed in speeds:
                speed.add(row)
    return added


def locking_clamp(definition: Definition, values: Mapping[str, Any], node: str) -> str:
    """Name of the clamp that keeps a node from turning at a mean speed; empty where none does.

    Springs to ground alone do not count: they hold a housing, and what they would stop turns by convention.
    """
    nodes = all_nodes(definition.active)
    if node not in nodes:
        return ""
    order = {node: index for index, node in enumerate(nodes)}
    rows, rest = _rows_on_average(definition, values)
    turning = _eliminated([{node: Fraction(1), UNIT: Fraction(-1)}, *rows], order)
    for name, row in _at_rest(definition, rest) if not turning.blocked else ():
        if not turning.blocks(row):
            turning.add(row)
        elif name:
            return name
    return ""


def _eliminated(rows: Rows, order: Mapping[str, int]) -> Elimination:
    elimination = Elimination(order, {UNIT})
    for row in rows:
        elimination.add(row)
    return elimination


def total_ratio(definition: Definition, values: Mapping[str, Any], first: str, second: str) -> Fraction:
    """Ratio of the mean speed of ``first`` to that of ``second``, exact where the ratios in between are.

    Raises
    ------
    UsageError
        Unknown nodes, nodes that are not connected by ratios, or a differential or planetary set in between whose
        third member is free.
    """
    nodes = all_nodes(definition.active)
    for node in (first, second):
        if node not in nodes:
            raise UsageError(unknown_name("node", node, nodes))
    order = {node: index for index, node in enumerate(nodes)}
    rows, rest = _rows_on_average(definition, values)
    # Each of both turns in its own trial; what would stop one of them is not held.
    turning = [
        _eliminated([{node: Fraction(1), UNIT: Fraction(-1)}, *rows], order) for node in dict.fromkeys((first, second))
    ]
    still = [row for _, row in _held_still(definition, rest, turning)]
    reduction = reduce_rows([*rows, *still], order)
    # Both speeds by free ones, in proportion to each other if there is a ratio.
    row, other = (reduction.reduced({node: Fraction(1)}) for node in (first, second))
    if not other:
        text = phrase("{} cannot turn, there is no ratio to it; name a node that turns", ModelName(second))
        raise UsageError(Fault(text, kind="no-ratio"))
    if row and row.keys() != other.keys():
        free = named_list(sorted(row.keys() | other.keys()))
        text = phrase(
            "no fixed ratio between {} and {}: {} turn independently", ModelName(first), ModelName(second), free
        )
        raise UsageError(Fault(text, kind="no-ratio"))
    ratios = {row.get(node, Fraction(0)) / other[node] for node in other}
    if len(ratios) > 1:
        said = "no fixed ratio between {} and {}: the speed splits in between"
        raise UsageError(Fault(phrase(said, ModelName(first), ModelName(second)), kind="no-ratio"))
    return Fraction(ratios.pop())


def mean_speeds(definition: Definition, values: Mapping[str, Any]) -> dict[str, float]:
    """Mean speed in rad/s of every node that the operating point determines, by node."""
    given = _numbers(definition.operating_point, values)
    order = {node: index for index, node in enumerate(all_nodes(definition.active))}
    rows: Rows = [{node: Fraction(1), UNIT: -speed} for node, speed in given.items() if node in order]
    holding, rest = _rows_on_average(definition, values)
    holding, friction = _apart_from_friction(definition, values, holding)
    elimination = _eliminated([*rows, *holding], order)
    # Friction sticks unless the speeds given make it slip.
    _hold_where_possible(friction, elimination)
    # A housing on springs does not turn, so that a clamp elsewhere may stop the speeds given; they stand all the same.
    for name, row in _held_still(definition, rest, [elimination.copy(order, {UNIT})]):
        if name:
            elimination.add(row)
    if elimination.blocked:
        raise ModelError(
            [Fault(_contradiction(definition, rows), ("operating_point", "speed"), kind="contradicting-speeds")]
        )
    reduction = Reduction(elimination)
    speeds = {node: reduction.in_floats({node: 1}) for node in order if not reduction.is_free(node)}
    # A speed is determined where it follows from the given ones alone.
    return {node: row.get(UNIT, 0.0) for node, row in speeds.items() if row.keys() <= {UNIT}}


def speeds_by_reference(
    definition: Definition, values: Mapping[str, Any], reference: str, mean: Mapping[str, float] | None = None
) -> dict[str, float]:
    """Mean speed by node, in rad/s where the operating point gives speeds, else over that of the reference.

    ``mean`` is the result of :func:`mean_speeds`, if known already.

    Nodes on springs to ground stand still and the outputs of an open differential turn alike, unless other rows
    contradict that. Nodes that turn independently are left out.
    """
    order = {node: index for index, node in enumerate(all_nodes(definition.active))}
    point = _numbers(definition.operating_point, values)
    determined = mean_speeds(definition, values) if mean is None and point else mean or {}
    # Without speeds of the point, or where the reference stands in it, all speeds are over that of the reference.
    given = point if determined.get(reference) else {reference: Fraction(1)}
    turning: Rows = [{node: Fraction(1), UNIT: -speed} for node, speed in given.items() if node in order]
    holding, rest = _rows_on_average(definition, values)
    holding, friction = _apart_from_friction(definition, values, holding)
    elimination = _eliminated([*turning, *holding], order)
    _hold_where_possible(friction, elimination)
    _held_still(definition, rest, [elimination])
    _hold_where_possible(list(_alike(definition)), elimination)
    reduction = Reduction(elimination)
    speeds = {node: reduction.in_floats({node: 1}) for node in order if not reduction.is_free(node)}
    return {node: row.get(UNIT, 0.0) for node, row in speeds.items() if row.keys() <= {UNIT}}


def _alike(definition: Definition) -> Iterator[dict[str, Fraction]]:
    """Rows that give both outputs of an open differential the same speed."""
    for element in definition.active:
        if element.glyph == "differential":
            left, right = element.ports["left"], element.ports["right"]
            yield {left: Fraction(1), right: Fraction(-1)}


def _numbers(point: OperatingPoint, values: Mapping[str, Any]) -> dict[str, Fraction]:
    return {node: exact(value.evaluate(values)) for node, value in point.speed.items()}


def _contradiction(definition: Definition, rows: Rows) -> str:
    shown = ", ".join(
        f"{node} {definition.operating_point.speed[node]}" for row in rows for node in row if node != UNIT
    )
    return f"the mean speeds ({shown}) do not fit the ratios between these nodes; correct one of them"
