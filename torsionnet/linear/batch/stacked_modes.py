"""Modes of variants that share rows, in double precision, with a mask of variants to be solved by themselves.

A variant is uncertain where the solver of single drivetrains would go on in many digits, and where the order of modes
is not certain.

>>> import torsionnet as tn
>>> assembly = tn.load("oil_engine").assembly
>>> system, nodes = assembly.system, assembly.node_rows.dense
>>> softer = np.array([[1.0], [0.99]]) * system.stiffness
>>> J, c = (np.tile(part, (2, 1)) for part in (system.inertia, system.damping))
>>> found = stacked_modes(system, nodes, Coefficients(J, c, softer, np.zeros_like(J)))
>>> (found.eigenvalues[1, 1:] / found.eigenvalues[0, 1:]).round(12).tolist() == [round(0.99**0.5, 12)] * 2
True
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray, RowSystem
from torsionnet.linear.batch.shared_directions import SharedDirections
from torsionnet.linear.batch.stacked_form import Coefficients, is_stackable
from torsionnet.linear.batch.stacked_vibrations import (
    StackedVibrations,
    damped_vibrations,
    hysteretic_vibrations,
    residuals,
    undamped_vibrations,
)
from torsionnet.linear.dynamic_stiffness.reduction import resisted_coordinates, restrict_to
from torsionnet.linear.modes.eigen import unit_shapes
from torsionnet.linear.modes.mode_shapes import EQUAL_EIGENVALUES
from torsionnet.linear.modes.spectrum import POLISH_ABOVE, REFINE_ABOVE

Places: TypeAlias = NDArray[np.intp]
Flags: TypeAlias = NDArray[np.bool_]
EQUAL_COMPONENT_RATIO = 1 - 1e-9
"""Ratio to the largest component of a shape from which another counts as equally large, so that the first of them is
scaled to 1."""


@dataclass(frozen=True, eq=False)
class StackedModes:
    """Eigenvalues (n, n_modes) in rad/s and shapes of n variants from stacked matrices.

    They are in the order of ``EigenSolution``, with NaN after the last one of a variant.

    Attributes
    ----------
    eigenvalues : (n, n_modes) complex array
        rad/s.
    shapes : (n, n_nodes, n_modes) complex array
        1 at the node that moves most.
    undamped : (n, n_undamped) array
        Natural frequencies of M and K alone, rad/s, 0 of rigid bodies.
    uncertain : (n,) boolean array
        Variants that have to be solved singly; what stands for them here may be wrong.
    """

    eigenvalues: ComplexArray
    shapes: ComplexArray
    undamped: FloatArray
    uncertain: Flags


def stacked_modes(system: RowSystem, nodes: FloatArray, given: Coefficients) -> StackedModes:
    """Eigenvalues (n, n_modes) in rad/s and shapes of variants of a system, solved as stacks of matrices.

    Parameters
    ----------
    system : RowSystem
        Its rows; without laws over frequency but hysteretic springs, and without actions.
    nodes : (n_nodes, n_q) array
        Angles of nodes from coordinates.
    given : Coefficients
        Of the variants, in place of those of the system.
    """
    usable = np.all([np.isfinite(part).all(axis=1) for part in given], axis=0)
    usable &= (given.inertia >= 0).all(axis=1) & (given.stiffness >= 0).all(axis=1)
    usable &= ((given.loss == 0) | (given.stiffness > 0)).all(axis=1)
    places = _alike(given, np.flatnonzero(usable))
    parts = [_of_one_kind(system, nodes, given.of(some)) for some in places]
    if not usable.all() or not parts:
        places.append(np.flatnonzero(~usable))
        parts.append(_nothing(len(nodes), len(places[-1])))
    return _together(parts, places)


def _alike(given: Coefficients, variants: Places) -> list[Places]:
    """Groups of indices of variants in which the same springs, dampers and inertias act."""
    signs = _signs(given)[variants]
    if not len(variants) or (signs == signs[0]).all():
        return [variants] if len(variants) else []
    _, kind = np.unique(signs, axis=0, return_inverse=True)
    return [variants[kind.ravel() == number] for number in range(int(kind.max()) + 1)]


def _signs(given: Coefficients) -> NDArray[np.int8]:
    return np.sign(np.concatenate(given, axis=1)).astype(np.int8)


class _Directions(NamedTuple):
    """Bases (n_q, n) of rigid and massless motions with dampers, and those of inertias and springs alone.

    The latter are without massless damped coordinates.
    """

    damped: SharedDirections
    alone: SharedDirections

    @classmethod
    def of(cls, system: RowSystem, given: Coefficients) -> _Directions:
        pattern = RowSystem(system.law_rows, *(np.sign(part[0]) for part in given[:3]))
        springs = RowSystem(system.law_rows, pattern.inertia, np.zeros_like(pattern.damping), pattern.stiffness)
        return cls(
            SharedDirections.of(pattern), SharedDirections.of(restrict_to(springs, resisted_coordinates(springs)))
        )


def _of_one_kind(system: RowSystem, nodes: FloatArray, given: Coefficients) -> StackedModes:
    """Eigenvalues (rad/s) and shapes of variants in which the same springs, dampers and inertias act.

    The stack is halved where LAPACK fails on one of them.
    """
    try:
        return _solved(system, nodes, given)
    except (np.linalg.LinAlgError, SolveError):
        if given.n_variants == 1:
            return _nothing(len(nodes), 1)
    halves = np.array_split(np.arange(given.n_variants), 2)
    return _together([_of_one_kind(system, nodes, given.of(half)) for half in halves], halves)


def _solved(system: RowSystem, nodes: FloatArray, given: Coefficients) -> StackedModes:
    directions, alone = system.memo.once(_Directions, _signs(given)[0].tobytes(), lambda: _Directions.of(system, given))
    if not (is_stackable(directions, given) and is_stackable(alone, given.undamped())):
        return _nothing(len(nodes), given.n_variants)
    with np.errstate(all="ignore"):
        lossy = given.loss.any()
        if not (lossy or directions.dissipating.size):
            found = undamped_vibrations(directions, given)
            rates = np.concatenate([np.zeros((given.n_variants, directions.rigid.shape[1])), found.values.imag], axis=1)
            return _judged(directions, nodes, given, found, rates)
        springs = undamped_vibrations(alone, given.undamped())
        rates = np.concatenate([np.zeros((given.n_variants, alone.rigid.shape[1])), springs.values.imag], axis=1)
        parts, places = [], []
        for some, found in (hysteretic_vibrations if lossy else damped_vibrations)(directions, given):
            part = _judged(directions, nodes, given.of(some), found, rates[some])
            part.uncertain[~_settled(springs.errors[some])] = True
            parts.append(part)
            places.append(some)
    return _together(parts, places)


def _judged(
    directions: SharedDirections, nodes: FloatArray, given: Coefficients, found: StackedVibrations, rates: FloatArray
) -> StackedModes:
    """Eigenvalues (rad/s) and shapes of variants, rigid bodies first, and mask (n,) of uncertain variants."""
    n, rigid = given.n_variants, unit_shapes(nodes @ directions.rigid)
    sure = _settled(found.errors) & ~_close(np.abs(found.values))
    sure &= (residuals(directions.rows, given, found) <= POLISH_ABOVE).all(axis=1)
    return StackedModes(
        np.concatenate([np.zeros((n, rigid.shape[1])), found.values], axis=1),
        np.concatenate([np.broadcast_to(rigid, (n, *rigid.shape)), _scaled(nodes @ found.vectors)], axis=2),
        rates,
        ~sure,
    )


def _scaled(shapes: ComplexArray) -> ComplexArray:
    """Shapes (n, n_nodes, m) scaled to 1 at the node that moves most, or at the first of equal ones."""
    size = np.abs(shapes)
    first = np.argmax(size >= size.max(axis=1, keepdims=True, initial=0.0) * EQUAL_COMPONENT_RATIO, axis=1)[:, None, :]
    largest = np.take_along_axis(shapes, first, axis=1)
    return np.asarray(shapes / np.where(largest == 0, 1, largest))


def _settled(errors: FloatArray) -> Flags:
    """Mask (n,) of variants whose eigenvalues, with relative errors (n, m), all need no refinement."""
    return np.asarray((errors <= REFINE_ABOVE).all(axis=1), dtype=bool)


def _close(sizes: FloatArray) -> Flags:
    """Mask (n,) of variants with modes so close that their order or shapes depend on rounding."""
    return np.asarray((np.diff(sizes, axis=1) <= EQUAL_EIGENVALUES * sizes[:, 1:]).any(axis=1), dtype=bool)


def _nothing(n_nodes: int, n: int) -> StackedModes:
    """Modes (none) of n variants that all have to be solved singly, as a result without eigenvalues or shapes."""
    none = np.zeros((n, 0))
    return StackedModes(none.astype(complex), np.zeros((n, n_nodes, 0), complex), none, np.ones(n, bool))


def _together(parts: Sequence[StackedModes], places: Sequence[Places]) -> StackedModes:
    """Eigenvalues (rad/s) and shapes of all variants put together from parts, each at the places of its variants."""
    if len(parts) == 1:
        return parts[0]
    n = sum(map(len, places))
    uncertain = np.ones(n, dtype=bool)
    for part, some in zip(parts, places, strict=True):
        uncertain[some] = part.uncertain
    return StackedModes(
        _spread([part.eigenvalues for part in parts], places, n),
        _spread([part.shapes for part in parts], places, n),
        _spread([part.undamped for part in parts], places, n),
        uncertain,
    )


def _spread(arrays: Sequence[NDArray[Any]], places: Sequence[Places], n: int) -> NDArray[Any]:
    """Array over all variants from arrays of parts, with NaN after the last column of each."""
    width = max(array.shape[-1] for array in arrays)
    whole = np.full((n, *arrays[0].shape[1:-1], width), np.nan, dtype=arrays[0].dtype)
    for array, some in zip(arrays, places, strict=True):
        whole[some, ..., : array.shape[-1]] = array
    return whole
