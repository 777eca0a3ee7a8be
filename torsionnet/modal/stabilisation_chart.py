"""Stabilisation diagram, the poles of fits of rising order, of which modes stay and poles of noise wander."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import SolveError
from torsionnet.base.packages import SavedResult
from torsionnet.base.table import Column, Table
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.modal.matrix_fraction import damping_ratios, largest_order, natural_frequencies, poles_of_orders
from torsionnet.modal.residues import expand
from torsionnet.modal.spectral_lines import ComplexArray, Criteria, Lines, Settings, lines_of


@dataclass(frozen=True, eq=False)
class Order:
    """Stable poles (rad/s) of one order of a fit, with shapes and their partners at the order before.

    Attributes
    ----------
    order : int
        Degree of the polynomials.
    poles : (n,) complex array
        rad/s, one of each conjugate pair.
    participations : (n, n_in) complex array
    shapes : (n, n_out) complex array
        Residues of the input in which a mode takes part most, each transfer function divided by its root mean square;
        of a single output those of all inputs.
    partners : (n,) int array
        Index of the partner of each pole at the order before; -1 if there is none.
    frequency, damping, shape : (n,) bool arrays
        Whether the partner is the same by each criterion.
    residuals : (n_f, n_out, n_in) complex array
        Weighted residuals of the fit.
    """

    order: int
    poles: ComplexArray
    participations: ComplexArray
    shapes: ComplexArray
    partners: NDArray[np.int_]
    frequency: NDArray[np.bool_]
    damping: NDArray[np.bool_]
    shape: NDArray[np.bool_]
    residuals: ComplexArray = field(repr=False)

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether each pole keeps frequency, damping and shape of its partner at the order before, mask (n,)."""
        return np.asarray(self.frequency & self.damping & self.shape)


@dataclass(frozen=True, eq=False, repr=False)
class Stabilisation(SavedResult):
    """Stabilisation diagram of a response, with the stable poles of a fit at every order.

    Attributes
    ----------
    response : FrequencyResponse
    settings : Settings
        Settings with the method that was chosen.
    orders : tuple of Order
    choice : str
        Reason for the method, where ``auto`` chose it.
    """

    response: FrequencyResponse
    settings: Settings
    orders: tuple[Order, ...]
    lines: Lines = field(repr=False)
    choice: str = ""

    def at(self, order: int) -> Order:
        """Stable poles of one order of the diagram, orders counted from 1."""
        return self.orders[order - 1]

    def table(self, conventions: Conventions = SI) -> Table:
        """Table with a row for each pole of each order, and what of it is the same as at the order before."""
        columns = (
            Column("order"),
            Column("natural frequency |lambda|/2pi", conventions.frequency),
            Column("damping ratio", "1"),
            Column("stable in"),
        )
        rows = []
        for order in self.orders:
            numbers = zip(natural_frequencies(order.poles), damping_ratios(order.poles), strict=True)
            for place, (frequency, damping) in enumerate(numbers):
                words = [name for name in ("frequency", "damping", "shape") if getattr(order, name)[place]]
                row = (order.order, float(frequency * conventions.frequency_scale), float(damping), ", ".join(words))
                rows.append(row)
        limits = self.settings.criteria
        note = (
            f"stable: changed by at most {limits.frequency:.2%} in frequency and {limits.damping:.2%} in damping, "
            f"MAC of the shapes at least {limits.shape:g}"
        )
        return Table(f"{self.response.title}: stabilisation", columns, tuple(rows), (note,))

    def __repr__(self) -> str:
        stable = sum(int(order.stable.sum()) for order in self.orders)
        total = sum(len(order.poles) for order in self.orders)
        return f"<Stabilisation: orders 1 to {len(self.orders)}, {stable} of {total} poles stable>"


def diagram(response: FrequencyResponse, settings: Settings) -> Stabilisation:
    """Stabilisation diagram of a response by the method of the settings; see :func:`torsionnet.modal.stabilisation`."""
    lines = lines_of(response, settings)
    orders: list[Order] = []
    highest = min(settings.order, largest_order(lines, settings))
    for order, fit in enumerate(poles_of_orders(lines, highest, settings), start=1):
        orders.append(_compared(lines, settings, order, fit, orders[-1] if orders else None))
    if not any(len(order.poles) for order in orders):
        raise SolveError(
            "no order gives a stable pole: the responses look like noise, or like motion ~ exp(-j omega t); "
            "check the sign of the phase",
            kind="no-resonance",
        )
    return Stabilisation(response, settings, tuple(orders), lines)


def _compared(
    lines: Lines, settings: Settings, order: int, fit: tuple[ComplexArray, ComplexArray], before: Order | None
) -> Order:
    poles, rows = fit
    expansion = expand(lines, poles, settings, rows)
    shapes = _shapes(expansion.residues * lines.balance)
    left = lines.weights * (lines.values - expansion.values(lines.s, lines.powers))
    places, (frequency, damping, shape) = _same(poles, shapes, before, settings.criteria)
    return Order(order, poles, rows, shapes, places, frequency, damping, shape, left)


def _shapes(residues: ComplexArray) -> ComplexArray:
    count, outputs, _ = residues.shape
    if outputs == 1:
        return residues[:, 0]
    # The input that drives a mode most shows its shape best.
    most = np.linalg.norm(residues, axis=1).argmax(axis=1)
    return np.asarray(residues[np.arange(count), :, most])


def _same(
    poles: ComplexArray, shapes: ComplexArray, before: Order | None, criteria: Criteria
) -> tuple[NDArray[np.int_], tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]]:
    """Index of each pole's partner at the order before, and masks (n,) where frequency, damping and shape agree.

    Partners are the pairs of poles with the least sum of distances. Modes of one pole have any combination of their
    shapes: the shape is compared with all those of poles that are the same in frequency and damping.
    """
    from scipy.optimize import linear_sum_assignment

    count = len(poles)
    places: NDArray[np.int_] = np.full(count, -1)
    same = np.zeros((3, count), dtype=bool)
    if before is None or not len(before.poles) or not count:
        return places, (same[0], same[1], same[2])
    distance = np.abs(poles[:, None] - before.poles) / np.abs(poles)[:, None]
    # d/(d + limit): all far distances cost about 1, so that a wandering pole does not part close pairs.
    rows, columns = linear_sum_assignment(distance / (distance + criteria.frequency))
    places[rows] = columns
    frequency = np.abs(np.abs(before.poles) / np.abs(poles)[:, None] - 1) <= criteria.frequency
    damping = np.abs(damping_ratios(before.poles) / damping_ratios(poles)[:, None] - 1) <= criteria.damping
    same[:2, rows] = frequency[rows, columns], damping[rows, columns]
    for pole in np.flatnonzero(same[0] & same[1]):
        # Shapes of nearly equal poles mix from order to order: a combination of them is the same mode.
        partners = before.shapes[frequency[pole] & damping[pole]]
        same[2, pole] = _within(shapes[pole], partners) >= criteria.shape
    alone = np.flatnonzero(~(same[0] & same[1]) & (places >= 0))
    same[2, alone] = [_within(shapes[pole], before.shapes[places[pole]][None]) >= criteria.shape for pole in alone]
    return places, (same[0], same[1], same[2])


def _within(shape: ComplexArray, others: ComplexArray) -> float:
    """MAC, 0 to 1, of a shape with the most similar linear combination of other shapes."""
    length = float(np.linalg.norm(shape))
    if not length or not others.any():
        return 0.0
    basis = np.linalg.svd(others.T / np.linalg.norm(others), full_matrices=False)[0]
    return float(np.linalg.norm(basis.conj().T @ shape) ** 2 / length**2)
