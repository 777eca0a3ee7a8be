"""Relative vector sums of an engine's cylinders, by mode and order."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import SavedResult
from torsionnet.base.phrases import phrase
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.frequency_response import ComplexArray
from torsionnet.linear.modes.mode_pairs import vibration_modes
from torsionnet.linear.modes.natural_modes import modes as damped_modes
from torsionnet.machinery.excitations import OrderExcitation, OrderTorques
from torsionnet.machinery.excitations.order_excitation import TorqueShares
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.orders.worst_case import Contributions, contributions, largest_amplitudes

# Phase-vector (star) diagrams, which show how the torques of cylinders add up on a mode shape.


@dataclass(frozen=True, eq=False, repr=False)
class StarDiagram(SavedResult):
    """Star diagram of one order h, complex vectors ``a_i exp(-j h alpha_i)`` of relative amplitude and firing angle.

    Attributes
    ----------
    excitation : str
    order : float
    labels, nodes : tuple of str
        Numbers of the cylinders (or names of other torques) and their nodes.
    vectors : (n,) complex array
        Vectors, where the largest amplitude of the mode at these nodes is 1; 0 for cylinders that do not act.
    title : str
    """

    excitation: str
    order: float
    labels: tuple[str, ...]
    nodes: tuple[str, ...]
    vectors: ComplexArray
    title: str = ""

    @property
    def sum(self) -> complex:
        """Complex vector sum of a star diagram, as a number of cylinders that act together at the largest amplitude."""
        return complex(self.vectors.sum())

    def table(self) -> Table:
        """Table of a star diagram with a row per cylinder, length and phase in deg of its vector, and the sum."""
        columns = (Column("cylinder"), Column("node"), Column("length", "1"), Column("phase", "deg"))
        rows = [
            (label, node, float(abs(vector)), float(np.degrees(np.angle(vector))) if vector else None)
            for label, node, vector in zip(self.labels, self.nodes, self.vectors, strict=True)
        ]
        total = self.sum
        rows.append(("sum", "", abs(total), float(np.degrees(np.angle(total))) if total else None))
        title = f"{self.title}: {self.excitation} order {self.order:g}"
        return Table(title, columns, tuple(rows), ("the largest amplitude at these nodes is 1",))


EQUAL_SUMS = 1e-6
"""Difference of relative vector sums up to which orders count as having equal sums; far above rounding, far below what
is shown."""
ROUNDED_SUM = 1e-9
"""Relative vector sum below which a table shows 0: what rounding leaves of vectors that cancel."""


@dataclass(frozen=True)
class VectorSum:
    """Relative vector sum of one order on one mode, as a number of cylinders at the largest amplitude.

    ``|sum_z theta_z exp(-j h alpha_z)| / max theta``.
    """

    mode: Annotated[int, Out("mode")]
    order: Annotated[float, Out("order")]
    sum: Annotated[float, Out("vector sum", digits=4)]


@dataclass(frozen=True, eq=False, repr=False)
class VectorSums(SavedResult):
    """Relative vector sums of an engine, with the star diagram of every mode and order.

    Attributes
    ----------
    excitation : str
    modes : tuple of int
    orders : tuple of float
    stars : mapping
        Star diagram by mode and order.
    """

    excitation: str
    modes: tuple[int, ...]
    orders: tuple[float, ...]
    stars: dict[tuple[int, float], StarDiagram]

    def of(self, mode: int, order: float) -> float:
        """Relative vector sum of an order on a mode, as a number of cylinders at the largest amplitude."""
        return abs(self.stars[mode, order].sum)

    def rows(self) -> tuple[VectorSum, ...]:
        """Relative vector sums of an engine as plain rows, sorted by mode, then by order."""
        return tuple(VectorSum(mode, order, self.of(mode, order)) for mode in self.modes for order in self.orders)

    def groups(self) -> tuple[tuple[float, ...], ...]:
        """Groups (tuples) of orders whose vector sums are equal on all modes, sorted by the first order of each group.

        In-line engines that fire evenly repeat their stars: order h has that of order h plus half the number of
        cylinders (four-stroke) or plus all of them (two-stroke), and the mirror image has the same sum.
        """
        groups: list[list[float]] = []
        for order in self.orders:
            sums = self._sums(order)
            alike = next((group for group in groups if np.allclose(self._sums(group[0]), sums, atol=EQUAL_SUMS)), None)
            if alike is None:
                groups.append([order])
            else:
                alike.append(order)
        return tuple(map(tuple, groups))

    def table(self) -> Table:
        """Table of relative vector sums, a row for each group of orders and a column for each mode."""
        columns = (Column("orders"), *(Column(phrase("mode {number}", number=mode), "", 4, 4) for mode in self.modes))
        rows = tuple((order_names(group), *map(_shown, self._sums(group[0]))) for group in self.groups())
        return Table(phrase("{name}: relative vector sums", name=self.excitation), columns, rows)

    def _sums(self, order: float) -> list[float]:
        return [self.of(mode, order) for mode in self.modes]


def _shown(value: float) -> float:
    return 0.0 if value < ROUNDED_SUM else value


def order_names(orders: Sequence[float]) -> str:
    """Text of the numbers of orders, separated by commas."""
    return ", ".join(f"{order:g}" for order in orders)


# Generalised force of an order on a mode, torques of all cylinders summed on its shape with their phases.

NOT_EXCITED = 0.01
"""Generalised force, over that of one cylinder at the largest angle of the shape, below which a mode hardly responds
and is not excited.

A larger value hides weak crossings, a smaller one lists more that hardly respond.
"""
CANCELLED = 1e-6
"""Size of a sum of unit phase vectors below which these count as cancelling, far above what rounding leaves."""


@dataclass(frozen=True)
class GeneralisedForce:
    """Generalised force ``|sum_n phi_n T_n|`` in N m on a mode shape scaled to a largest angle of 1, worst case.

    ``relative`` is this force over the torque of one cylinder at the largest amplitude of the shape, all angles
    referred to the shaft of the excitation. ``case`` names the worst case and ``part`` the part out of action in it,
    where there are several cases; ``by_case`` has pairs of the name of each case and its force in N m.
    """

    value: float
    relative: float
    case: str = ""
    part: str = ""
    by_case: tuple[tuple[str, float], ...] = ()

    @property
    def acts(self) -> bool:
        """Whether the generalised force is large enough, over that of one cylinder, to excite the mode."""
        return self.relative >= NOT_EXCITED


def star_diagram(
    excitation: OrderExcitation, name: str, order: float, shape: Mapping[str, complex], title: str = "", out: str = ""
) -> StarDiagram:
    """Star diagram of one order, with phase vectors of the cylinders weighted by a mode shape.

    The part ``out`` is out of action.
    """
    by_part = {part: (node, 0j if part == out else v) for part, (node, v) in excitation.phase_vectors(order).items()}
    amplitudes = np.array([shape[node] for node, _ in by_part.values()])
    largest = np.abs(amplitudes).max(initial=0) or 1.0
    # theta_z/max theta exp(-j h alpha_z).
    vectors = np.array([vector for _, vector in by_part.values()]) * amplitudes / largest
    return StarDiagram(name, order, tuple(by_part), tuple(node for node, _ in by_part.values()), vectors, title)


def generalised_force(
    excitation: OrderExcitation,
    acting: OrderTorques,
    at: tuple[int, int],
    shape: Mapping[str, complex],
    largest: float,
) -> GeneralisedForce:
    """Generalised force in N m of an order's torques on a mode shape, in the worst case of misfire and spread.

    Each torque is positive in the sense of its node.

    ``at`` are the indices of speed and line; ``largest`` is the largest angle of the shape, referred to the shaft of
    the excitation.
    """
    speed, line = at
    torques = dict(zip(acting.nodes, acting.amplitudes[speed, line].tolist(), strict=True))
    # What cancels leaves rounding of the largest torque of any order at this speed.
    strongest = float(np.abs(acting.amplitudes[speed]).max())
    single = max(_single(excitation, float(acting.orders[line]), torques), CANCELLED * strongest) * largest
    cases = _cases(acting, at, shape)
    value = max(case[0] for case in cases)
    worst = [case for case in cases if case[0] >= (1 - CANCELLED) * value]
    _, case, part = worst[0]  # equal cases are named together; where all are equal none is named
    case = "" if 1 < len(worst) == len(cases) else " or ".join(label for _, label, _ in worst)
    by_case = tuple((label, force) for force, label, _ in cases)
    return GeneralisedForce(value, value / single if single > 0 else 0.0, case, part, by_case)


def _cases(torques: OrderTorques, at: tuple[int, int], shape: Mapping[str, complex]) -> list[tuple[float, str, str]]:
    """Generalised force in N m, label and part out of action of every case, each at the worst cylinder spread."""
    speed, line = at
    # Q = sum_n phi_n T_n has the form of a response, with the shape in place of receptances.
    gains = np.array([shape[node] for node in torques.nodes])[None, None, None, :]
    columns = {node: (place, 1.0) for place, node in enumerate(torques.nodes)}

    def on_top(shares: TorqueShares) -> Contributions:
        here = replace(shares, amplitudes=shares.amplitudes[:, speed : speed + 1, line : line + 1])
        return contributions("", here, gains, slice(0, 1), columns)

    nominal = np.array(gains[..., 0, :] @ torques.amplitudes[speed, line]).reshape(1, 1, 1)
    scatter = [] if torques.scatter is None else [on_top(torques.scatter)]
    if torques.alternatives is None:
        return [(float(largest_amplitudes(nominal, scatter).item()), "", "")]
    changes = on_top(torques.alternatives)
    cases = []
    for change, label, part in zip(changes.values, changes.labels, changes.parts, strict=True):
        free = [deviation.without({("", part)}) for deviation in scatter]
        cases.append((float(largest_amplitudes(nominal + change, free).item()), label, part))
    return cases


def _single(excitation: OrderExcitation, order: float, torques: Mapping[str, complex]) -> float:
    """Torque amplitude in N m of one cylinder, which is that of a node over the sum of its cylinders' phase vectors."""
    units = dict.fromkeys(torques, 0j)
    # All cylinders on one throw act there together: T_node = T_cylinder |sum exp(-j h alpha)|.
    for node, vector in excitation.phase_vectors(order).values():
        units[node] = units.get(node, 0j) + vector
    each = [abs(torque) / abs(units[node]) for node, torque in torques.items() if abs(units[node]) > CANCELLED]
    return max(each or map(abs, torques.values()), default=0.0)


# Relative vector sums of an engine's cylinders on the modes of a drivetrain.


def vector_sums(
    drivetrain: AssembledModel,
    excitation: str,
    *,
    modes: Iterable[int] | None = None,
    orders: Iterable[float] | None = None,
    without: Iterable[int] = (),
) -> VectorSums:
    """Relative vector sums of an engine by mode and order, all cylinders alike: misfires and factors do not count.

    Cylinder z at the amplitude theta_z of the mode fires at the crank angle alpha_z; order h has the sum
    ``|sum_z theta_z exp(-j h alpha_z)| / max theta``, the largest amplitude being that of a cylinder
    (W. Ker Wilson, Practical Solution of Torsional Vibration Problems, volume 2, Amplitude Calculations).

    Parameters
    ----------
    excitation : str
        Name of the engine.
    modes : iterable of int, optional
        Numbers of modes; default: all that vibrate.
    orders : iterable of float, optional
        Orders; default: those of the engine.
    without : iterable of int, optional
        Numbers of cylinders that give no torque, as one that is out.

    Raises
    ------
    UsageError
        The excitation is no engine, or there is no such mode.

    Examples
    --------
    >>> import torsionnet as tn
    >>> sums = vector_sums(tn.load("two_stroke_ship").configured("normal"), "engine", modes=[1], orders=[1, 5, 6])
    >>> [(row.order, round(row.sum, 3)) for row in sums.rows()]
    [(1, 0.056), (5, 0.056), (6, 5.611)]
    >>> sums = vector_sums(tn.load("two_stroke_ship"), "engine", modes=[1], orders=[1, 6], without=[2])
    >>> [(row.order, round(row.sum, 3)) for row in sums.rows()]
    [(1, 0.99), (6, 4.622)]
    """
    known = drivetrain.definition.excitations
    engine = known.get(excitation)
    if not isinstance(engine, ReciprocatingEngine):
        engines = [name for name, entry in known.items() if isinstance(entry, ReciprocatingEngine)]
        raise UsageError(f'no engine is named "{excitation}"{did_you_mean(excitation, engines)}', kind="unknown-name")
    sound = replace(engine, misfire=(), gas_off=tuple(without), factors={})
    shapes = _shapes(drivetrain)
    numbers = tuple(shapes if modes is None else modes)
    if missing := [number for number in numbers if number not in shapes]:
        raise UsageError(f"there is no mode {missing[0]}; there are {len(shapes)}, counted from 1", kind="unknown-mode")
    chosen = tuple(engine.acting_orders.tolist() if orders is None else orders)
    stars = {
        (mode, order): star_diagram(sound, excitation, order, shapes[mode], phrase("mode {number}", number=mode))
        for mode in numbers
        for order in chosen
    }
    return VectorSums(excitation, numbers, chosen, stars)


def _shapes(drivetrain: AssembledModel) -> dict[int, Mapping[str, complex]]:
    """Shape of every vibration by number of the mode, as complex angles by node, without unit."""
    nodes = drivetrain.assembly.nodes
    vibrations = sorted(vibration_modes(drivetrain, damped_modes(drivetrain)), key=lambda mode: mode.number)
    return {mode.number: dict(zip(nodes, mode.shape.tolist(), strict=True)) for mode in vibrations}
