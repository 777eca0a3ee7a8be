"""Speeds grouped by the values of parameters that follow the operating point, so that groups are solved together.

Where such parameters change coefficients of laws and nothing else, all speeds are variants in arrays.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import groupby
from types import MappingProxyType
from typing import TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Rows
from torsionnet.base.units import RPM
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.batch.batch import Batch
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.linear.modes.modes import OSCILLATORY
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.linear.responses.shared_response import shared_by_conditions
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed
from torsionnet.model.definition import Definition
from torsionnet.model.load.external_torques import reference_node
from torsionnet.model.operating_values import OperatingPoints
from torsionnet.model.parameters import VIBRATORY_TORQUE
from torsionnet.model.speeds import locking_clamp, total_ratio

# Revolutions of one shaft per revolution of another, kept for all drivetrains with the same rows.


def cached_total_ratio(drivetrain: AssembledModel, node: str, reference: str) -> Fraction:
    """Mean speed of a node over that of the reference node, as a fraction, negative if it turns the other way.

    See :func:`torsionnet.model.speeds.total_ratio`.
    """
    return drivetrain.assembly.system.memo.once(
        Fraction,
        ("total ratio", node, reference),
        lambda: total_ratio(drivetrain.definition, drivetrain.exact_values, node, reference),
    )


def cached_locking_clamp(drivetrain: AssembledModel, node: str) -> str:
    """Name of the clamp that keeps a node from turning; see :func:`torsionnet.model.speeds.locking_clamp`."""
    return drivetrain.assembly.system.memo.once(
        str,
        ("locking clamp", node),
        lambda: locking_clamp(drivetrain.definition, drivetrain.exact_values, node),
    )


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
    rigs = [
        drivetrain.with_operating_values(point, speed) for point, speed in zip(values, speeds.tolist(), strict=True)
    ]

    def key(place: int) -> tuple[object, ...]:
        tangents = rigs[place].definition.tangents
        assert tangents is not None
        return (place,) if apart else (values[place], tangents.state.tangent_key)

    for _, places in groupby(range(len(speeds)), key=key):
        some = np.array(list(places))
        yield rigs[some[0]], some


def own_ratio(drivetrain: AssembledModel, reference: str) -> float:
    """Speed of the node whose speed the load follows over that of the node to which speeds belong."""
    # Tables and load follow the speed of a node of their own, which may be on another shaft.
    own = reference_node(drivetrain.definition) or reference
    return 1.0 if own == reference else abs(float(cached_total_ratio(drivetrain, own, reference)))


def values_at_speeds(
    drivetrain: AssembledModel, reference: str, speeds: FloatArray, settled: IteratedValues = MappingProxyType({})
) -> list[dict[str, float]]:
    """Values in SI units by parameter, one mapping per speed, of the parameters that follow the operating point."""
    points = OperatingPoints(drivetrain.external_torques)
    values = [points.at(speed) for speed in (speeds * own_ratio(drivetrain, reference)).tolist()]
    for name, column in settled.items():
        for place, value in enumerate(column.tolist()):
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
    batch = plan.batch({name: [operating[name] for operating in values] for name in following})
    # A speed at which rows or sizes of the system differ, or nothing can be solved, needs drivetrains of its own.
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


# Parameters that depend on the vibratory torque, as of rubber couplings, iterated until both agree.

VALUE_TOLERANCE = 1e-8
"""Relative difference up to which a parameter agrees with its table at the vibratory torque that it causes.

A larger value saves iterations and moves responses by about as much.
"""
MOST_ITERATIONS = 100
"""Most iterations of a parameter at one speed, after which that speed counts as one without a solution."""
SLOW_CONVERGENCE = 0.7
"""Change of an iteration, over the change before, from which on steps are halved because the iteration swings."""


def values_by_vibration(
    definition: Definition, speeds: FloatArray, vibration: Callable[[Sequence[str], IteratedValues], FloatArray]
) -> IteratedValues:
    """Values (n_speeds,) in SI units by name of the parameters that depend on an element's vibratory torque.

    Every speed is iterated from the smallest vibration in the table, with shorter steps where it swings, until no value
    moves by more than :data:`VALUE_TOLERANCE`. Where several vibrations agree with their values, the result is the
    smallest that the iteration meets from there.

    Parameters
    ----------
    definition : Definition
    speeds : (n_speeds,) array
        rad/s, for messages.
    vibration : callable
        (elements, values) -> half ranges of their torques, shape (n_speeds, n_elements), N m.

    Raises
    ------
    UsageError
        A speed does not settle, or settles beyond the table.
    """
    tables = {name: law for name, law in definition.following.items() if law.by == VIBRATORY_TORQUE}
    if not tables:
        return {}
    elements = list(dict.fromkeys(law.of for law in tables.values()))
    columns = [elements.index(law.of) for law in tables.values()]
    values = np.array([np.full(len(speeds), float(law.table[0][1].value)) for law in tables.values()])
    length, before = np.ones(len(speeds)), np.full(len(speeds), np.inf)
    for _ in range(MOST_ITERATIONS):
        # Fixed point v = f(|T|(v)): the values make a vibration, its half range gives the next values.
        sizes = vibration(elements, dict(zip(tables, values, strict=True)))[:, columns].T
        wanted = np.array([_clamped(law.table, size) for law, size in zip(tables.values(), sizes, strict=True)])
        moved = (np.abs(wanted - values) / np.abs(wanted).max(axis=1, keepdims=True)).max(axis=0)
        if (moved <= VALUE_TOLERANCE).all():
            for (name, law), size in zip(tables.items(), sizes, strict=True):
                _require_inside(name, law.of, law.table, size, speeds)
            return dict(zip(tables, wanted, strict=True))
        # A speed that swings or hardly converges goes half as far each time, on its own.
        length = np.where(moved > SLOW_CONVERGENCE * before, length / 2, length)
        before = moved
        values = values + length * (wanted - values)
    open_ = moved > VALUE_TOLERANCE
    first = speeds[open_][0] * RPM
    text = f"{' and '.join(tables)} and the vibration do not settle within {VALUE_TOLERANCE:g} of each other"
    advice = "give a smoother table over the vibratory torque"
    raise UsageError(
        f"{text} at {open_.sum()} of {len(speeds)} speeds, the first {first:.6g} rpm; {advice}", kind="no-solution"
    )


def _clamped(table: Rows, sizes: FloatArray) -> FloatArray:
    keys, values = (np.array([float(row[side].value) for row in table]) for side in (0, 1))
    return np.asarray(np.interp(sizes, keys, values))


def _require_inside(name: str, element: str, table: Rows, sizes: FloatArray, speeds: FloatArray) -> None:
    low, high = (float(table[end][0].value) for end in (0, -1))
    outside = (sizes < low * (1 - VALUE_TOLERANCE)) | (sizes > high * (1 + VALUE_TOLERANCE))
    if outside.any():
        worst = int(np.argmax(np.where(outside, np.abs(sizes - low), -1)))
        ends = f"the table goes from {table[0][0]} to {table[-1][0]}"
        where = f"{sizes[worst]:.6g} N*m at {speeds[worst] * RPM:.6g} rpm"
        raise UsageError(
            f"{name}: the vibratory torque of {element} is {where}; {ends}, extend it", kind="beyond-table"
        )


# Shares of the elements in the damping of a mode at its critical speed.

SMALLEST_SHARE = 1e-9
"""Share of the damping of a mode below which an element has none but rounding."""


def damping_shares(
    drivetrain: AssembledModel, critical: CriticalSpeed, reference: str | None = None
) -> dict[str, float]:
    """Share of every element in the damping of a mode at its critical speed, without unit, by element, largest first.

    The share of an element is its part of the power that the damped mode dissipates, with parameters that follow the
    operating point at their values for the critical speed. Elements that feed energy in have a negative share.

    Parameters
    ----------
    drivetrain : Drivetrain
        The drivetrain that the critical speed was calculated for.
    critical : CriticalSpeed
    reference : str, optional
        Node to which the critical speed belongs; default: that of the model's ``speeds:``, else the first node.

    Returns
    -------
    dict
        Empty for a mode without damping and one that exists without damping only.

    References
    ----------
    E. J. Nestorides, A Handbook on Torsional Vibration, 1958: the damping of a mode as the sum of the energies that
    its parts dissipate per cycle.

    Examples
    --------
    >>> import torsionnet as tn
    >>> fan = tn.Drivetrain("fan",
    ...     [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...      tn.Spring("shaft", nodes=("a", "b"), stiffness=1e4, damping=3),
    ...      tn.Damper("air", nodes=("b", "ground"), damping=0.75)],
    ...     speeds={"of": "a", "list": ["500 rpm", "700 rpm"]},
    ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}})
    >>> {name: round(share, 3) for name, share in damping_shares(fan, fan.critical_speeds().of(1, 2)).items()}
    {'shaft': 0.9, 'air': 0.1}
    """
    mode = critical.mode
    if math.isnan(mode.natural_frequency):
        return {}
    given = drivetrain.definition.speeds
    node = reference or (given.of if given else None) or drivetrain.nodes[0]
    speed = critical.natural_speed
    rig = drivetrain
    if math.isfinite(speed):
        # Shares are those with the parameters at the critical speed, as its mode has them.
        ((rig, _),) = drivetrains_at_speeds(drivetrain, node, np.array([speed]))
    damped = modes(rig)
    vibrating = [index for index, kind in enumerate(damped.kinds) if kind == OSCILLATORY]
    # Modes may change their order over speed: the frequency at the critical speed tells which it is.
    place = min(vibrating, key=lambda index: abs(damped.natural_frequencies[index] - mode.natural_frequency))
    shares = zip(damped.elements, damped.dissipated[:, place].tolist(), strict=True)
    return dict(
        sorted(((name, share) for name, share in shares if abs(share) > SMALLEST_SHARE), key=lambda pair: -pair[1])
    )
