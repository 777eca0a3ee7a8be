"""Running machinery whose parameters follow the operating point: every speed is solved with its own values.

Where these change coefficients of laws and nothing else, all speeds are variants in arrays.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from types import MappingProxyType
from typing import TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.assembly.rows import FloatArray
from torsionnet.model.load.external_torques import reference_node
from torsionnet.model.operating_values import OperatingPoints
from torsionnet.solve.batch.batch import Batch
from torsionnet.solve.batch.batch_plan import batch_plan
from torsionnet.solve.running.total_ratios import remembered_ratio

Settled: TypeAlias = Mapping[str, FloatArray]
Places: TypeAlias = NDArray[np.intp]
Model = TypeVar("Model", bound=AssembledModel)


def at_speeds(
    drivetrain: Model, reference: str, speeds: FloatArray, settled: Settled = MappingProxyType({})
) -> Iterator[tuple[Model, Places]]:
    """The drivetrain with the parameters of every speed, and the places of the speeds at which they hold, in order.

    Neighbouring speeds with the same values come together; all speeds where no parameter follows the operating point.

    Parameters
    ----------
    drivetrain : AssembledModel
    reference : str
        The node whose speeds are meant.
    speeds : (n_speeds,) array
        rad/s.
    settled : mapping
        Parameter -> (n_speeds,) values found otherwise.

    Raises
    ------
    UsageError
        A speed outside a table.
    """
    if not drivetrain.definition.following:
        yield drivetrain, np.arange(len(speeds))
        return
    values = _values(drivetrain, reference, speeds, settled)
    for _, places in groupby(range(len(speeds)), key=lambda place: values[place]):
        some = np.array(list(places))
        yield drivetrain.operated(values[some[0]]), some


def _values(drivetrain: AssembledModel, reference: str, speeds: FloatArray, settled: Settled) -> list[dict[str, float]]:
    """Of the parameters that follow the operating point at every speed, by name."""
    points = OperatingPoints(drivetrain.external_torques)
    own = reference_node(drivetrain.definition) or reference
    ratio = 1.0 if own == reference else abs(float(remembered_ratio(drivetrain, own, reference)))
    values = [points.at(speed) for speed in (speeds * ratio).tolist()]
    for name, found in settled.items():
        for place, value in enumerate(found.tolist()):
            values[place][name] = value
    return values


def in_arrays(
    drivetrain: AssembledModel, reference: str, speeds: FloatArray, settled: Settled = MappingProxyType({})
) -> Batch | None:
    """All speeds as variants with the rows of the drivetrain, without a drivetrain for each.

    None where nothing follows the operating point, or where more than coefficients of laws does.
    """
    following = tuple(drivetrain.definition.following)
    plan = batch_plan(drivetrain, following) if following else None
    if plan is None:
        return None
    values = _values(drivetrain, reference, speeds, settled)
    batch = plan.batch({name: [one[name] for one in values] for name in following})
    return None if (batch.impossible | batch.apart).any() else batch


TOGETHER = 500
"""Speeds that are solved together, which bounds the memory."""


def _nothing(_: AssembledModel) -> Hashable:
    return None


def solved_together(
    groups: Iterable[tuple[Model, Places]], apart: Callable[[Model], Hashable] = _nothing
) -> Iterator[tuple[Sequence[Model], Places]]:
    """The groups of :func:`at_speeds` in portions: one drivetrain for all speeds, or one for each, of the same rows.

    ``apart`` gives what else drivetrains that are solved together have in common.
    """
    for _, alike in groupby(groups, key=lambda group: (group[0].assembly.system.memo, apart(group[0]))):
        some = list(alike)
        rigs = [rig for rig, places in some for _ in places.tolist()]
        every = np.concatenate([places for _, places in some])
        for start in range(0, len(every), TOGETHER):
            part = slice(start, start + TOGETHER)
            yield rigs[:1] if len(some) == 1 else rigs[part], every[part]
