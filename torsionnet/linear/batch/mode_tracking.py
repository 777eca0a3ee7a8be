"""Tracking of modes, which puts the modes of variants in the order of the modes of their drivetrain.

A mode is followed along its eigenvalue from the drivetrain's own values to those of the variant. Where every mode is
most like the one of the same rank among its kind, nothing has to be followed. Otherwise the values move in steps, each
short enough that neighbouring modes are identified by the energy their states have in common (:mod:`.mode_steps`):

* modes that **cross** keep their shapes, so each is found where its shape went, and the order of frequencies changes;
* modes that **veer** come near each other and turn away, exchanging their shapes on the way; each stays on its side,
  so that its frequency moves smoothly, and the shape says how much of it belongs to the other by now.

Frequencies and dampings of a tracked mode are therefore smooth functions of the values, which is what distributions,
sensitivities and optima of them need. A name given for a shape ("the clutch's mode") passes from one mode to the other
in a veering: variants in which a mode has a MAC of a fifth or more with another mode of the drivetrain are marked.
Modes that change their order in less than about 1/1000 of the way, so that no step in between shows them together,
count as crossing.

A vibration that is damped beyond critical damping goes on as the slower one of its two real poles; two real poles that
become a vibration go on as one mode, and the other one is lost.

Sentences on tracked modes that come near each other, become overdamped, or get lost.

>>> here, there = np.array([2j, 3j]), np.array([[2j, 3j], [2.9j, 3.1j]])
>>> mixed = np.array([[False, False], [True, True]])
>>> tracking_notes(here, there, mixed, np.array([[1, 0], [1, 0]]))
('modes 1 and 2 share or exchange their shapes in 1 of 2 variants; they come within 6.5 % of each other',)
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import OSCILLATORY, REAL, mode_numbers
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.batch.batched_modes import BatchedModes, frequencies_of, ratios_of
from torsionnet.linear.batch.mode_steps import (
    MISSING_MODE,
    SAME_MODE_ENERGY,
    Columns,
    FollowedModes,
    ModeWalk,
    inertia_mac,
    mode_states,
    take_columns,
)
from torsionnet.linear.modes.modes import Modes
from torsionnet.linear.modes.natural_modes import natural_modes

# Sentences on tracked modes that come near each other, become overdamped, or get lost.


def tracking_notes(
    home: ComplexArray, followed: ComplexArray, veering: NDArray[np.bool_], partners: NDArray[np.intp]
) -> tuple[str, ...]:
    """Sentences on which tracked modes of variants share shapes, become overdamped or get lost.

    Parameters
    ----------
    home : (m,) complex array
        Eigenvalues of the drivetrain itself.
    followed : (n, m) complex array
        Of the same modes of the variants; NaN where one lacks it.
    veering : (n, m) boolean array
        Modes that resemble another one of the drivetrain too.
    partners : (n, m) integer array
        That other one.
    """
    numbers = mode_numbers([OSCILLATORY if value.imag > 0 else REAL for value in home])
    there = ~np.isnan(followed).all(axis=1)
    return (*_near(numbers, followed, veering, partners), *_lost(numbers, home, followed[there]))


def _near(
    numbers: Sequence[int | None], followed: ComplexArray, veering: NDArray[np.bool_], partners: NDArray[np.intp]
) -> Iterator[str]:
    pairs: dict[tuple[int, int], set[int]] = {}
    for variant, mode in zip(*(part.tolist() for part in np.nonzero(veering)), strict=True):
        pair = sorted((mode, int(partners[variant, mode])))
        pairs.setdefault((pair[0], pair[1]), set()).add(variant)
    for (a, b), variants in sorted(pairs.items()):
        some = sorted(variants)
        # |lambda_a - lambda_b| / |lambda_b| in the variants in which both mix, of which the least is told.
        distance = np.abs(followed[some, a] - followed[some, b]) / np.abs(followed[some, b])
        near = distance[~np.isnan(distance)]
        how = f"; they come within {100 * near.min():.2g} % of each other" if near.size else ""
        yield f"{_both(numbers[a], numbers[b])} share or exchange their shapes in {_of(len(some), followed)}{how}"


def _lost(numbers: Sequence[int | None], home: ComplexArray, followed: ComplexArray) -> Iterator[str]:
    for mode, value in enumerate(home):
        column = followed[:, mode]
        real = int(np.sum((column.imag == 0) & (np.abs(column) > 0) & (value.imag > 0)))
        if real:
            yield (
                f"{_name(numbers[mode])} is damped beyond critical damping in {_of(real, followed)}; "
                "there it is the slower one of two real poles"
            )
        lost = int(np.sum(np.isnan(column)))
        if lost:
            yield f"{_name(numbers[mode])} has no successor in {_of(lost, followed)}"


def _of(count: int, followed: ComplexArray) -> str:
    return f"{count} of {len(followed)} variants"


def _name(number: int | None) -> str:
    return "a real pole" if number is None else f"mode {number}"


def _both(first: int | None, second: int | None) -> str:
    """Text for two modes, such as ``modes 1 and 2``."""
    return f"{_name(first)} and {_name(second)}" if None in (first, second) else f"modes {first} and {second}"


VEERING_MAC = 0.2
"""MAC with another mode of the drivetrain from which a mode is marked as veering, a fifth, as a lower value marks more
modes."""


VARIANTS_AT_ONCE = 500
"""Number of variants whose modes are compared in memory at a time, which bounds that memory."""


@dataclass(frozen=True, eq=False)
class TrackedModes:
    """Eigenvalues (n, n_modes) in rad/s and shapes of n variants, in the order of the modes of their drivetrain.

    Attributes
    ----------
    modes : BatchedModes
        All modes of the variants in the order of each.
    reference : Modes
        Of the drivetrain itself.
    columns : (n, n_modes) integer array
        Place in ``modes`` of each of its modes; -1 where a variant lacks it.
    mac : (n, n_modes) array
        Modal assurance criterion of the shape and that of the drivetrain itself over all inertias, each motion weighted
        with the root of the inertia of its own variant: 1 for the same shape, 0 for another mode of the same undamped
        drivetrain. 1 of rigid bodies.
    veering : (n, n_modes) boolean array
        Vibrations whose MAC with another vibration of the drivetrain is a fifth or more.
    partners : (n, n_modes) integer array
        That other vibration: the one with the largest MAC.
    """

    modes: BatchedModes
    reference: Modes
    columns: Columns
    mac: FloatArray
    veering: NDArray[np.bool_]
    partners: Columns

    def __len__(self) -> int:
        return len(self.columns)

    @cached_property
    def eigenvalues(self) -> ComplexArray:
        """Eigenvalues of the tracked modes in rad/s, shape (n, n_modes), NaN where a variant lacks a mode."""
        return take_columns(self.modes.eigenvalues, self.columns)

    @cached_property
    def natural_frequencies(self) -> FloatArray:
        """Natural frequencies ``|lambda| / 2 pi`` of the tracked modes in Hz, (n, n_modes), 0 for a rigid-body mode."""
        return frequencies_of(self.eigenvalues)

    @cached_property
    def damping_ratios(self) -> FloatArray:
        """Damping ratios of the tracked modes, (n, n_modes), 1 for a stable real pole, NaN for a rigid-body mode."""
        return ratios_of(self.eigenvalues)

    @cached_property
    def shapes(self) -> ComplexArray:
        """Mode shapes (n, n_nodes, n_modes) of the tracked modes at all nodes, 1 at the node that moves most."""
        return take_columns(self.modes.shapes, self.columns[:, None, :])

    @cached_property
    def notes(self) -> tuple[str, ...]:
        """Sentences on modes that come near each other, become overdamped or get lost over the variants."""
        return tracking_notes(self.reference.eigenvalues, self.eigenvalues, self.veering, self.partners)


def track_modes(modes: BatchedModes, reference: Modes | None = None) -> TrackedModes:
    """Modes of variants (eigenvalues, shapes) in the order of their drivetrain's modes, tracked along eigenvalues.

    Parameters
    ----------
    modes : BatchedModes
    reference : Modes, optional
        Of the drivetrain itself, where they are known already.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.linear.batch.batch_plan import batch_plan
    >>> from torsionnet.linear.batch.batched_modes import batched_modes
    >>> plan = batch_plan(tn.load("dmf_rig"), ["k_2"])
    >>> variants = batched_modes(plan.batch({"k_2": np.array([300.0, 460.0, 900.0])}))
    >>> track_modes(variants).natural_frequencies[:, 0].round(2).tolist()
    [5.74, 7.11, 9.92]
    """
    known = natural_modes(modes.drivetrain)[0] if reference is None else reference
    if not len(known):
        none = np.zeros((len(modes), 0))
        return TrackedModes(modes, known, none.astype(int), none, none.astype(bool), none.astype(int))
    home = BatchedModes.of_drivetrain(modes.drivetrain, known)
    there = FollowedModes(home.eigenvalues, mode_states(home, np.zeros(1, dtype=np.intp)))
    columns = np.full((len(modes), len(known)), MISSING_MODE)
    mac, mixed, partners = np.full(columns.shape, np.nan), np.full(columns.shape, np.nan), columns.copy()
    unclear = np.zeros(len(modes), dtype=bool)
    # First guess: the mode of the same rank among rigid bodies, real poles or vibrations.
    for places, here in _parts(modes, np.arange(len(modes))):
        columns[places] = _of_same_rank(there.values, here.values)
        mac[places], mixed[places], partners[places] = _compared(there, here, columns[places])
        # Variants that cannot be have no modes to follow.
        gone = np.isnan(here.values).all(axis=1)
        unclear[places] = ~((mac[places] >= SAME_MODE_ENERGY).all(axis=1) | gone)
    if unclear.any():
        # Only to variants with a doubtful mode a way is walked; rigid bodies stay at zero on it.
        moving = np.flatnonzero(~_rigid(there.values[0]))
        walk = ModeWalk(modes, FollowedModes(there.values[:, moving], there.states[:, :, moving]))
        for places, here in _parts(modes, np.flatnonzero(unclear)):
            columns[np.ix_(places, moving)] = walk.columns(places, here)
            mac[places], mixed[places], partners[places] = _compared(there, here, columns[places])
    return TrackedModes(modes, known, columns, mac, mixed >= VEERING_MAC, partners)


def _parts(modes: BatchedModes, places: NDArray[np.intp]) -> Iterator[tuple[NDArray[np.intp], FollowedModes]]:
    """Yield the places of some variants at a time, with eigenvalues and energy vectors of all their modes."""
    for start in range(0, len(places), VARIANTS_AT_ONCE):
        some = places[start : start + VARIANTS_AT_ONCE]
        yield some, FollowedModes(modes.eigenvalues[some], mode_states(modes, some))


def _of_same_rank(there: ComplexArray, here: ComplexArray) -> Columns:
    """Columns (n, m) of the variants' modes of the same kind and rank as each mode, missing ones marked."""
    columns = np.full((len(here), there.shape[1]), MISSING_MODE)
    for of_kind in (_rigid, _real, _vibrating):
        wanted, have = np.flatnonzero(of_kind(there[0])), of_kind(here)
        # A stable sort lists the modes of this kind first, by their magnitude as before.
        first = np.argsort(~have, axis=1, kind="stable")[:, : len(wanted)]
        is_there = np.arange(first.shape[1]) < have.sum(axis=1)[:, None]
        columns[:, wanted[: first.shape[1]]] = np.where(is_there, first, MISSING_MODE)
    return columns


def _rigid(values: ComplexArray) -> NDArray[np.bool_]:
    return np.asarray(values == 0)


def _real(values: ComplexArray) -> NDArray[np.bool_]:
    return np.asarray((values.imag == 0) & (np.abs(values) > 0))  # not those that are not there, NaN


def _vibrating(values: ComplexArray) -> NDArray[np.bool_]:
    return np.asarray(values.imag > 0)


def _compared(there: FollowedModes, here: FollowedModes, columns: Columns) -> tuple[FloatArray, FloatArray, Columns]:
    """MAC (n, m) with the same mode of the drivetrain, largest MAC with another vibration, and the other's number.

    NaN for lost modes.
    """
    values = take_columns(here.values, columns)
    # A missing mode counts as motionless and has MAC 0 with all others.
    alike = inertia_mac(there.states, np.nan_to_num(take_columns(here.states, columns[:, None, :])))
    own = np.diagonal(alike, axis1=1, axis2=2).copy()
    own[:, _rigid(there.values[0])] = 1.0
    # Only vibrations veer: a real pole may share the shape of a vibration and is no partner of it.
    vibrations = _vibrating(there.values)[:, :, None] & _vibrating(values)[:, None, :]
    others = np.where(vibrations & ~np.eye(columns.shape[1], dtype=bool), alike, 0.0)
    lost, partners = columns == MISSING_MODE, np.argmax(others, axis=1)
    return np.where(lost, np.nan, own), np.where(lost, np.nan, others.max(axis=1)), partners
