"""Eigenvalues in rad/s and shapes of many variants of a drivetrain, from stacks of matrices, or singly if uncertain."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import ModelError, TorsionnetError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.assembly.system import Assembly
from torsionnet.linear.batch.stacked_form import Coefficients
from torsionnet.linear.batch.stacked_modes import stacked_modes
from torsionnet.linear.modes.modes import Modes
from torsionnet.linear.modes.natural_modes import natural_modes
from torsionnet.model.element_base.dynamic_stiffness import ComplexStiffness

if TYPE_CHECKING:
    from torsionnet.linear.batch.batch import Batch

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
    found = _Gathered(len(batch), len(assembly.nodes))
    given = stacked_coefficients(batch)
    if given is not None:
        _solve_together(batch, given, found)
    for place in np.flatnonzero(~(found.done | batch.impossible)).tolist():
        found.solve(place, partial(batch.model, place))
    return found.modes(batch.drivetrain, batch.values, batch)


def single_modes(drivetrain: AssembledModel, values: Mapping[str, FloatArray]) -> BatchedModes:
    """Eigenvalues (n, n_modes) in rad/s and shapes of variants whose rows differ, each solved by itself."""
    n = len(next(iter(values.values())))
    found = _Gathered(n, len(drivetrain.assembly.nodes))
    for place in range(n):
        changes = {name: float(column[place]) for name, column in values.items()}
        found.solve(place, partial(drivetrain.configured, **changes))
    return found.modes(drivetrain, values, None)


def stacked_coefficients(batch: Batch) -> Coefficients | None:
    """Inertia, damping, stiffness and loss (n, n_laws) of all laws in SI units, or None with actions or tables.

    It is None for torques that follow a motion elsewhere, and for stiffness tables over frequency.
    """
    if batch.drivetrain.assembly.system.actions:
        return None
    stiffness, loss = batch.stiffness.copy(), np.zeros_like(batch.stiffness)
    for one in batch.dynamic:
        if not isinstance(one.of, ComplexStiffness):
            return None
        kappa = one.kappa(np.zeros(1))[:, 0]
        stiffness[one.places, one.law] += kappa.real
        loss[one.places, one.law] += kappa.imag
    return Coefficients(batch.inertia, batch.damping, stiffness, loss)


def _solve_together(batch: Batch, given: Coefficients, found: _Gathered) -> None:
    assembly, places = batch.drivetrain.assembly, batch.stacked
    system, nodes = assembly.system, assembly.node_rows.dense
    step = max(1, STACK_ENTRIES // (len(system.law_rows) * (system.n_coordinates + 1)))
    for start in range(0, len(places), step):
        some = places[start : start + step]
        part = stacked_modes(system, nodes, given.of(some))
        sure = ~part.uncertain
        found.put(some[sure], part.eigenvalues[sure], part.shapes[sure], part.undamped[sure])


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
            found, warnings = natural_modes(model)
        except (ModelError, TorsionnetError) as error:
            self.remarks.append((place, f"has no modes: {error}"))
            return
        self.put([place], found.eigenvalues, found.shapes, 2 * np.pi * found.undamped_natural_frequencies)
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
