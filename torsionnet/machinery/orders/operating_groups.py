"""Speeds grouped by the values of parameters that follow the operating point, so that groups are solved together.

Where such parameters change coefficients of laws and nothing else, all speeds are variants in arrays.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from types import MappingProxyType
from typing import TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.batch.batch import Batch
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.linear.responses.shared_response import shared_by_conditions
from torsionnet.machinery.criticals.total_ratios import cached_total_ratio
from torsionnet.model.load.external_torques import reference_node
from torsionnet.model.operating_values import OperatingPoints

IteratedValues: TypeAlias = Mapping[str, FloatArray]
"""Values (n_speeds,) by parameter, in SI units, that were iterated together with the vibration they depend on."""
SpeedIndices: TypeAlias = NDArray[np.intp]
"""Indices of some speeds in the array of all speeds."""
Model = TypeVar("Model", bound=AssembledModel)
PLAN_BYTES = 1_000_000
"""Size in bytes at which a kept batch plan with its drivetrain is counted against the memory limit, with a margin."""


def drivetrains_at_speeds(
    drivetrain: Model,
    reference: str,
    speeds: FloatArray,
    settled: IteratedValues = MappingProxyType({}),
    *,
    apart: bool = False,
) -> Iterator[tuple[Model, SpeedIndices]]:
    """Yield drivetrains with the parameters of their speeds, and the indices of the speeds at which these hold.

    Neighbouring speeds with the same values share a drivetrain; so do all where no parameter follows the speed.

    Parameters
    ----------
    drivetrain : AssembledModel
    reference : str
        Node to which the speeds belong.
    speeds : (n_speeds,) array
        rad/s.
    settled : mapping
        Parameter -> values (n_speeds,) that were iterated with the vibration.
    apart : bool
        Whether a drivetrain with laws of motion is given for every speed, and not shared where tangents are equal.

    Raises
    ------
    UsageError
        A speed outside a table.
    """
    if not drivetrain.definition.follows_speed:
        yield drivetrain, np.arange(len(speeds))
        return
    values = values_at_speeds(drivetrain, reference, speeds, settled)
    if drivetrain.definition.tangents is not None and drivetrain.definition.load is not None:
        yield from _at_own_tangents(drivetrain, values, speeds * own_ratio(drivetrain, reference), apart=apart)
        return
    for _, places in groupby(range(len(speeds)), key=lambda place: values[place]):
        some = np.array(list(places))
        yield drivetrain.with_operating_values(values[some[0]]), some


def _at_own_tangents(
    drivetrain: Model, values: Sequence[Mapping[str, float]], speeds: FloatArray, *, apart: bool
) -> Iterator[tuple[Model, SpeedIndices]]:
    """Yield drivetrains with the tangents of their laws of motion at each speed in rad/s of the load's node."""
    rigs = [drivetrain.with_operating_values(one, speed) for one, speed in zip(values, speeds.tolist(), strict=True)]

    def key(place: int) -> tuple[object, ...]:
        tangents = rigs[place].definition.tangents
        assert tangents is not None
        return (place,) if apart else (values[place], tangents.state.tangent_key)

    for _, places in groupby(range(len(speeds)), key=key):
        some = np.array(list(places))
        yield rigs[some[0]], some


def own_ratio(drivetrain: AssembledModel, reference: str) -> float:
    """Speed of the node whose speed the load follows over that of the node to which speeds belong."""
    own = reference_node(drivetrain.definition) or reference
    return 1.0 if own == reference else abs(float(cached_total_ratio(drivetrain, own, reference)))


def values_at_speeds(
    drivetrain: AssembledModel, reference: str, speeds: FloatArray, settled: IteratedValues = MappingProxyType({})
) -> list[dict[str, float]]:
    """Values in SI units by parameter, one mapping per speed, of the parameters that follow the operating point."""
    points = OperatingPoints(drivetrain.external_torques)
    values = [points.at(speed) for speed in (speeds * own_ratio(drivetrain, reference)).tolist()]
    for name, found in settled.items():
        for place, value in enumerate(found.tolist()):
            values[place][name] = value
    return values


def batch_over_speeds(
    drivetrain: AssembledModel, reference: str, speeds: FloatArray, settled: IteratedValues = MappingProxyType({})
) -> Batch | None:
    """Batch with one variant of the drivetrain per speed, or None if operating values change more than coefficients.

    None where no parameter follows the operating point, or where these change more than coefficients of laws.
    """
    following = tuple(drivetrain.definition.following)
    if not following or drivetrain.definition.tangents is not None:
        return None
    (plan,) = shared_by_conditions(
        drivetrain, tuple, ("plan", following), lambda: (batch_plan(drivetrain, following),), lambda _: PLAN_BYTES
    )
    if plan is None:
        return None
    values = values_at_speeds(drivetrain, reference, speeds, settled)
    batch = plan.batch({name: [one[name] for one in values] for name in following})
    return None if (batch.impossible | batch.separate).any() else batch


SPEEDS_PER_BLOCK = 500
"""Number of speeds that are solved in one call, which bounds the memory."""


def _nothing(_: AssembledModel) -> Hashable:
    return None


def blocks_of_speeds(
    groups: Iterable[tuple[Model, SpeedIndices]], apart: Callable[[Model], Hashable] = _nothing
) -> Iterator[tuple[Sequence[Model], SpeedIndices]]:
    """Yield blocks of drivetrains with the same rows, one for all speeds or one per speed, and indices of speeds.

    ``groups`` are those of :func:`drivetrains_at_speeds`; drivetrains whose ``apart`` differs are never in one block.
    """
    for _, alike in groupby(groups, key=lambda group: (group[0].assembly.system.memo, apart(group[0]))):
        some = list(alike)
        rigs = [rig for rig, places in some for _ in places.tolist()]
        every = np.concatenate([places for _, places in some])
        for start in range(0, len(every), SPEEDS_PER_BLOCK):
            part = slice(start, start + SPEEDS_PER_BLOCK)
            yield rigs[:1] if len(some) == 1 else rigs[part], every[part]
