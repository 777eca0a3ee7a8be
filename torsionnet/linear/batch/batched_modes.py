"""Eigenvalues in rad/s and shapes of many variants of a drivetrain, from stacks of matrices, or singly if uncertain.

Modes of variants that share rows, in double precision, with a mask of variants to be solved by themselves. A variant is
uncertain where the solver of single drivetrains would go on in many digits, and where the order of modes is not
certain.

>>> import torsionnet as tn
>>> assembly = tn.load("oil_engine").assembly
>>> system, nodes = assembly.system, assembly.node_rows.dense
>>> softer = np.array([[1.0], [0.99]]) * system.stiffness
>>> J, c = (np.tile(part, (2, 1)) for part in (system.inertia, system.damping))
>>> modes = stacked_modes(system, nodes, Coefficients(J, c, softer, np.zeros_like(J)))
>>> (modes.eigenvalues[1, 1:] / modes.eigenvalues[0, 1:]).round(12).tolist() == [round(0.99**0.5, 12)] * 2
True
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import ModelError, SolveError, TorsionnetError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray, RowSystem
from torsionnet.linear.batch.stacked_form import (
    Coefficients,
    SharedDirections,
    StackedVibrations,
    damped_vibrations,
    hysteretic_vibrations,
    is_stackable,
    residuals,
    undamped_vibrations,
)
from torsionnet.linear.dynamic_stiffness.reduction import resisted_coordinates, restrict_to
from torsionnet.linear.modes.eigen import unit_shapes
from torsionnet.linear.modes.mode_shapes import EQUAL_EIGENVALUES
from torsionnet.linear.modes.modes import Modes
from torsionnet.linear.modes.natural_modes import natural_modes
from torsionnet.linear.modes.spectrum import POLISH_ABOVE, REFINE_ABOVE
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness

if TYPE_CHECKING:
    from torsionnet.linear.batch.batch import Batch


# Modes of variants that share rows, in double precision, with a mask of variants to be solved by themselves.

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
    # NaN, a negative J or k, or a loss without a spring: left to the single solver, which says what is wrong.
    usable = np.all([np.isfinite(part).all(axis=1) for part in given], axis=0)
    usable &= (given.inertia >= 0).all(axis=1) & (given.stiffness >= 0).all(axis=1)
    usable &= ((given.loss == 0) | (given.stiffness > 0)).all(axis=1)
    # Which motions are massless or rigid depends on the coefficients that vanish: a stack for each pattern of signs.
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
    # The bases follow from rows and signs alone, so that all stacks of a pattern share them.
    directions, alone = system.memo.once(_Directions, _signs(given)[0].tobytes(), lambda: _Directions.of(system, given))
    if not (is_stackable(directions, given) and is_stackable(alone, given.undamped())):
        return _nothing(len(nodes), given.n_variants)
    with np.errstate(all="ignore"):
        lossy = given.loss.any()
        if not (lossy or directions.dissipating.size):
            # Without losses lambda = +-j omega, and these omega are the frequencies of M and K alone as well.
            vibrations = undamped_vibrations(directions, given)
            rates = np.concatenate(
                [np.zeros((given.n_variants, directions.rigid.shape[1])), vibrations.values.imag], axis=1
            )
            return _judged(directions, nodes, given, vibrations, rates)
        # The frequencies of M and K alone are listed beside the damped modes; massless damped coordinates have none.
        springs = undamped_vibrations(alone, given.undamped())
        rates = np.concatenate([np.zeros((given.n_variants, alone.rigid.shape[1])), springs.values.imag], axis=1)
        parts, places = [], []
        for some, vibrations in (hysteretic_vibrations if lossy else damped_vibrations)(directions, given):
            part = _judged(directions, nodes, given.of(some), vibrations, rates[some])
            # The undamped frequencies are a result too: if they need refinement, the variant is solved singly.
            part.uncertain[~_settled(springs.errors[some])] = True
            parts.append(part)
            places.append(some)
    return _together(parts, places)


def _judged(
    directions: SharedDirections,
    nodes: FloatArray,
    given: Coefficients,
    vibrations: StackedVibrations,
    rates: FloatArray,
) -> StackedModes:
    """Eigenvalues (rad/s) and shapes of variants, rigid bodies first, and mask (n,) of uncertain variants."""
    n, rigid = given.n_variants, unit_shapes(nodes @ directions.rigid)
    # The tests of the single solver (error, residual), and modes so near that rounding would choose their order.
    sure = _settled(vibrations.errors) & ~_close(np.abs(vibrations.values))
    sure &= (residuals(directions.rows, given, vibrations) <= POLISH_ABOVE).all(axis=1)
    # Rigid bodies come first, lambda = 0, with the same shapes in all variants: they follow from rows alone.
    return StackedModes(
        np.concatenate([np.zeros((n, rigid.shape[1])), vibrations.values], axis=1),
        np.concatenate([np.broadcast_to(rigid, (n, *rigid.shape)), _scaled(nodes @ vibrations.vectors)], axis=2),
        rates,
        ~sure,
    )


def _scaled(shapes: ComplexArray) -> ComplexArray:
    """Shapes (n, n_nodes, m) scaled to 1 at the node that moves most, or at the first of equal ones."""
    size = np.abs(shapes)
    # The first of nearly equal components, so that rounding does not move the 1 from one node to another.
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


STACK_ENTRIES = 200_000
"""Number of entries of the rows in one stack of variants, so that the stack stays in a processor's cache."""
Number = TypeVar("Number", np.float64, np.complex128)


@dataclass(frozen=True, eq=False)
class BatchedModes:
    """Eigenvalues (n, n_modes) in rad/s and shapes of n variants, rigid bodies first, then by ``|lambda|``.

    Each variant is in the order of :class:`~torsionnet.Modes`.

    There are as many columns as the variant with the most modes needs; NaN stands after the last mode of the others. A
    vibration that some variant damps beyond critical damping is two real poles there, so that their numbers differ.

    Attributes
    ----------
    drivetrain : AssembledModel
        That the variants are of, with its own values.
    values : mapping
        Parameter -> (n,) values in SI.
    eigenvalues : (n, n_modes) complex array
        rad/s, Im >= 0; NaN throughout for a variant that cannot be.
    shapes : (n, n_nodes, n_modes) complex array
        Angles of all nodes, 1 at the node that moves most.
    undamped_natural_frequencies : (n, n_undamped) array
        Hz, of M and K alone, ascending, rigid-body modes as 0.
    uncertain : (n,) boolean array
        Variants that were solved singly: rounding or equal modes made them uncertain, or their laws are of other kinds.
    singles : mapping
        Place -> assembly of these.
    batch : Batch or None
        The coefficients of the others.
    remarks : tuple of (int, str)
        What is uncertain about single variants, by their place.
    """

    drivetrain: AssembledModel
    values: Mapping[str, FloatArray]
    eigenvalues: ComplexArray
    shapes: ComplexArray
    undamped_natural_frequencies: FloatArray
    uncertain: NDArray[np.bool_]
    singles: Mapping[int, Assembly] = field(repr=False)
    batch: Batch | None = None
    remarks: tuple[tuple[int, str], ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on single variants with their numbers, counted from 1."""
        return tuple(f"variant {place + 1}: {text}" for place, text in self.remarks)

    @classmethod
    def of_drivetrain(cls, drivetrain: AssembledModel, modes: Modes) -> BatchedModes:
        """Eigenvalues in rad/s and shapes of a drivetrain at its own values, in the form of a batch of one variant."""
        return cls(
            drivetrain,
            {},
            modes.eigenvalues[None],
            modes.shapes[None],
            modes.undamped_natural_frequencies[None],
            np.ones(1, dtype=bool),
            {0: drivetrain.assembly},
        )

    def __len__(self) -> int:
        return len(self.eigenvalues)

    @cached_property
    def natural_frequencies(self) -> FloatArray:
        """Natural frequencies ``|lambda| / 2 pi`` in Hz, shape (n, n_modes), 0 for a rigid-body mode."""
        return frequencies_of(self.eigenvalues)

    @cached_property
    def damping_ratios(self) -> FloatArray:
        """Damping ratios ``-Re lambda / |lambda|``, (n, n_modes), 1 for stable real poles, NaN for rigid bodies."""
        return ratios_of(self.eigenvalues)


def frequencies_of(eigenvalues: ComplexArray) -> FloatArray:
    """Natural frequencies ``|lambda| / 2 pi`` in Hz of eigenvalues lambda in rad/s, in an array of the same shape."""
    return np.asarray(np.abs(eigenvalues) / (2 * np.pi))


def ratios_of(eigenvalues: ComplexArray) -> FloatArray:
    """Damping ratios ``-Re lambda / |lambda|`` of eigenvalues, in an array of their shape, NaN for rigid bodies."""
    with np.errstate(invalid="ignore"):
        return np.asarray(-eigenvalues.real / np.abs(eigenvalues) + 0.0)


def batched_modes(batch: Batch) -> BatchedModes:
    """Eigenvalues (n, n_modes) in rad/s and shapes of all variants of a batch, as single models have within 1e-9.

    They equal those of ``batch.model(i).modes()``.

    Variants that are uncertain from stacks of matrices are solved singly, and so are all of a drivetrain with torques
    that follow a motion elsewhere or with laws over frequency other than hysteretic springs. The bits of a variant do
    not depend on what else is in the batch.
    """
    assembly = batch.drivetrain.assembly
    gathered = _Gathered(len(batch), len(assembly.nodes))
    given = stacked_coefficients(batch)
    if given is not None:
        _solve_together(batch, given, gathered)
    # What the stacks leave uncertain, or cannot solve at all (actions, tables over frequency), is solved singly.
    for place in np.flatnonzero(~(gathered.done | batch.impossible)).tolist():
        gathered.solve(place, partial(batch.model, place))
    return gathered.modes(batch.drivetrain, batch.values, batch)


def single_modes(drivetrain: AssembledModel, values: Mapping[str, FloatArray]) -> BatchedModes:
    """Eigenvalues (n, n_modes) in rad/s and shapes of variants whose rows differ, each solved by itself."""
    n = len(next(iter(values.values())))
    gathered = _Gathered(n, len(drivetrain.assembly.nodes))
    for place in range(n):
        changes = {name: float(column[place]) for name, column in values.items()}
        gathered.solve(place, partial(drivetrain.configured, **changes))
    return gathered.modes(drivetrain, values, None)


def stacked_coefficients(batch: Batch) -> Coefficients | None:
    """Inertia, damping, stiffness and loss (n, n_laws) of all laws in SI units, or None with actions or tables.

    It is None for torques that follow a motion elsewhere, and for stiffness tables over frequency.
    """
    if batch.drivetrain.assembly.system.actions:
        return None
    stiffness, loss = batch.stiffness.copy(), np.zeros_like(batch.stiffness)
    for batched in batch.dynamic:
        if not isinstance(batched.of, ComplexStiffness):
            return None
        # Hysteretic: kappa = k + j k eta at every omega, whose real part joins the springs.
        kappa = batched.kappa(np.zeros(1))[:, 0]
        stiffness[batched.places, batched.law] += kappa.real
        loss[batched.places, batched.law] += kappa.imag
    return Coefficients(batch.inertia, batch.damping, stiffness, loss)


def _solve_together(batch: Batch, given: Coefficients, gathered: _Gathered) -> None:
    assembly, places = batch.drivetrain.assembly, batch.stacked
    system, nodes = assembly.system, assembly.node_rows.dense
    # The largest arrays of a stack are the rows scaled for each variant, n_laws n_q entries each.
    step = max(1, STACK_ENTRIES // (len(system.law_rows) * (system.n_coordinates + 1)))
    for start in range(0, len(places), step):
        some = places[start : start + step]
        part = stacked_modes(system, nodes, given.of(some))
        sure = ~part.uncertain
        gathered.put(some[sure], part.eigenvalues[sure], part.shapes[sure], part.undamped[sure])


class _Gathered:
    """Eigenvalues (rad/s), shapes and undamped frequencies (rad/s) of n variants, filled in variant by variant.

    They are NaN where there are none.
    """

    def __init__(self, n: int, n_nodes: int) -> None:
        self.eigenvalues = np.full((n, 0), np.nan, dtype=complex)
        self.shapes = np.full((n, n_nodes, 0), np.nan, dtype=complex)
        self.undamped = np.full((n, 0), np.nan)
        self.done = np.zeros(n, dtype=bool)
        self.singles: dict[int, Assembly] = {}
        self.remarks: list[tuple[int, str]] = []

    def put(
        self, places: NDArray[np.intp] | list[int], values: ComplexArray, shapes: ComplexArray, undamped: FloatArray
    ) -> None:
        """Store modes of some variants, eigenvalues and undamped frequencies in rad/s and shapes over nodes."""
        self.eigenvalues = _widened(self.eigenvalues, values.shape[-1])
        self.shapes = _widened(self.shapes, values.shape[-1])
        self.undamped = _widened(self.undamped, undamped.shape[-1])
        self.eigenvalues[places, : values.shape[-1]] = values
        self.shapes[places, :, : values.shape[-1]] = shapes
        self.undamped[places, : undamped.shape[-1]] = undamped
        self.done[places] = True

    def solve(self, place: int, make: Callable[[], AssembledModel]) -> None:
        """Solve one variant as a single drivetrain and store its modes, or a note if it is impossible."""
        try:
            model = make()
            solved, warnings = natural_modes(model)
        except (ModelError, TorsionnetError) as error:
            self.remarks.append((place, f"has no modes: {error}"))
            return
        self.put([place], solved.eigenvalues, solved.shapes, 2 * np.pi * solved.undamped_natural_frequencies)
        self.singles[place] = model.assembly
        self.remarks += [(place, warning) for warning in warnings]

    def modes(self, drivetrain: AssembledModel, values: Mapping[str, FloatArray], batch: Batch | None) -> BatchedModes:
        uncertain = np.zeros(len(self.done), dtype=bool)
        uncertain[list(self.singles)] = True
        rates = self.undamped / (2 * np.pi)
        return BatchedModes(
            drivetrain,
            values,
            self.eigenvalues,
            self.shapes,
            rates,
            uncertain,
            self.singles,
            batch,
            tuple(self.remarks),
        )


def _widened(array: NDArray[Number], width: int) -> NDArray[Number]:
    missing = max(0, width - array.shape[-1])
    return np.concatenate([array, np.full((*array.shape[:-1], missing), np.nan, dtype=array.dtype)], axis=-1)
