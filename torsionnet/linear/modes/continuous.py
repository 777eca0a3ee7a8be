"""Lowest modes without damping of a drivetrain with continuous shafts, which has infinitely many.

Every mode is bracketed by the count of Wittrick and Williams and bisected to the last digit.

Number of natural frequencies below a frequency, by the algorithm of Wittrick and Williams.

    N(omega) = sum over the members of their own modes below omega with both ends clamped
               + number of negative pivots of D(omega)

W. H. Wittrick and F. W. Williams, A general algorithm for computing natural frequencies of elastic structures,
Quarterly Journal of Mechanics and Applied Mathematics 24 (1971) 263-284. Pivots come from elimination on the graph, so
that soft springs to ground keep their digits beside stiff springs.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import SolveError
from torsionnet.linear.assembly.rows import FloatArray, RowSystem
from torsionnet.linear.dynamic_stiffness.reduction import (
    resisted_coordinates,
    restrict_to,
    without_empty_laws,
)
from torsionnet.linear.dynamic_stiffness.row_algebra import echelon_basis, unresisted_motions

# Number of natural frequencies below a frequency, by the algorithm of Wittrick and Williams.

Laws: TypeAlias = list[tuple[dict[int, float], FloatArray]]
"""Row of each law with its stiffnesses (n_points,) in N m/rad."""
ZERO_PIVOT = 1e-30
"""Value, over the size of its terms, that replaces a pivot of zero, which has no sign and cannot be divided by."""
PARALLEL = 1e-12
"""Relative difference of squared coefficients below which two rows are parallel and their laws are added."""


def negative_pivots(rows: Sequence[dict[int, float]], kappa: FloatArray, n_coordinates: int) -> FloatArray:
    """Number (n_points,) of negative eigenvalues of sum_i kappa_i a_i a_i^T, with kappa (n_laws, n_points).

    Eliminating v with S = sum_e kappa_e a_ev^2 leaves sum_{e<f} kappa_e kappa_f / S b b^T with b = a_fv a_e - a_ev a_f,
    which is a congruence: S has the sign of one eigenvalue.

    Examples
    --------
    >>> negative_pivots([{0: 1.0, 1: -1.0}, {1: 1.0}], np.array([[3.0, -1.0], [2.0, -1.0]]), 2)
    array([0., 2.])
    """
    # Rows of two entries stay such when a coordinate is eliminated; wider ones do not.
    if any(len(row) > 2 for row in rows):
        return _negative_eigenvalues(rows, kappa, n_coordinates)
    laws = _merged([(row, values) for row, values in zip(rows, kappa, strict=True) if row])
    count, left = np.zeros(kappa.shape[1]), set(range(n_coordinates))
    while left:
        uses = dict.fromkeys(left, 0)
        for row, _ in laws:
            for column in row:
                uses[column] += 1
        # The coordinate with the fewest laws leaves the fewest new ones.
        v = min(left, key=lambda column: uses[column])
        left.discard(v)
        acting = [law for law in laws if v in law[0]]
        terms = np.array([values * row[v] ** 2 for row, values in acting]).reshape(-1, len(count))
        pivot = terms.sum(axis=0)
        pivot = np.where(pivot == 0, ZERO_PIVOT * (np.abs(terms).sum(axis=0) + ZERO_PIVOT), pivot)
        count += pivot < 0
        laws = _merged([law for law in laws if v not in law[0]] + _eliminated(acting, v, pivot))
    return count


def _negative_eigenvalues(rows: Sequence[dict[int, float]], kappa: FloatArray, n_coordinates: int) -> FloatArray:
    """Number (n_points,) of negative eigenvalues, from all eigenvalues, for laws that tie three coordinates."""
    dense = np.zeros((len(rows), n_coordinates))
    for place, row in enumerate(rows):
        dense[place, list(row)] = list(row.values())
    # Scaling by a diagonal is a congruence: it keeps the signs and brings D to a diagonal of about one.
    scale = 1 / np.sqrt(np.abs(kappa).T @ dense**2 + ZERO_PIVOT)
    scaled = dense[None] * scale[:, None, :]
    D = np.einsum("pli,lp,plj->pij", scaled, kappa, scaled)
    return np.asarray((np.linalg.eigvalsh(D) < 0).sum(axis=1), dtype=float)


def _eliminated(acting: Laws, v: int, pivot: FloatArray) -> Laws:
    """Laws (row, stiffness in N m/rad) on other coordinates that replace those on v when v is eliminated."""
    laws: Laws = []
    for place, (first, kappa) in enumerate(acting):
        for second, other in acting[place + 1 :]:
            columns = (first.keys() | second.keys()) - {v}
            # b = a_fv a_e - a_ev a_f, in which v cancels, with kappa_e kappa_f / S
            row = {c: second[v] * first.get(c, 0.0) - first[v] * second.get(c, 0.0) for c in columns}
            laws.append(({c: value for c, value in row.items() if value}, kappa * (other / pivot)))
    return [law for law in laws if law[0]]


def _merged(laws: Laws) -> Laws:
    """Laws (row, stiffness in N m/rad) merged to one on each coordinate and one between any two.

    Beside an edge on the row (a_i, a_j) a law y on (b_i, b_j) is t y on that row, t = b_i b_j / (a_i a_j), and
    y (b^2 - t a^2) on each of both coordinates.
    """
    edges: dict[tuple[int, ...], tuple[dict[int, float], FloatArray]] = {}
    grounds: dict[int, FloatArray] = {}
    for row, values in laws:
        columns = tuple(sorted(row))
        if len(columns) == 1:
            (c,) = columns
            grounds[c] = grounds.get(c, 0.0) + values * row[c] ** 2
            continue
        known, before = edges.get(columns, (row, np.zeros_like(values)))
        i, j = columns
        # t y on the row of the edge, the rest of both squares to ground.
        share = row[i] * row[j] / (known[i] * known[j])
        edges[columns] = known, before + share * values
        for c in columns:
            rest = row[c] ** 2 - share * known[c] ** 2
            if abs(rest) > PARALLEL * row[c] ** 2:
                grounds[c] = grounds.get(c, 0.0) + rest * values
    return [*(({c: 1.0}, values) for c, values in grounds.items()), *edges.values()]


class ModeCount:
    """Count of the natural frequencies below omega in rad/s of a system without damping."""

    def __init__(self, system: RowSystem) -> None:
        self.system = system
        self.members = [(law, table.with_loss(0)) for law, table in system.dynamic]

    def real_stiffness(self, omega: FloatArray) -> FloatArray:
        """Dynamic stiffness (n_laws, n_points) of every law in N m/rad, real, at omega in rad/s without damping."""
        kappa = self.system.stiffness[:, None] - self.system.inertia[:, None] * omega**2
        for law, table in self.members:
            kappa[law] += table.kappa(omega).real
        return np.asarray(kappa)

    def below(self, omega: FloatArray) -> FloatArray:
        """Number (n_points,) of natural frequencies below each omega > 0 in rad/s, rigid bodies included."""
        # Wittrick and Williams: frequencies of shafts with both ends held, and negative eigenvalues of D(omega).
        clamped = sum((table.clamped_modes(omega) for _, table in self.members), start=np.zeros(len(omega)))
        kappa = self.real_stiffness(omega)
        return clamped + negative_pivots(self.system.sparse_rows, kappa, self.system.n_coordinates)


Mask: TypeAlias = NDArray[np.bool_]

DEFAULT_COUNT = 20
"""Number of modes with continuous shafts that are calculated where the caller gives no number."""
SAME_FREQUENCY = 1e-10
"""Relative difference below which natural frequencies are one repeated frequency, as bisection ends at rounding."""
SLOWEST_VIBRATION = 1e-9
"""Lowest frequency at which vibrations are sought, over the lowest natural frequency of any shaft by itself."""
BISECTIONS = 110
"""Most halvings of a bracket, more than the digits of double precision need over all decades of frequency."""
OFF_CLAMPED = 1.0123
"""Factor on trial frequencies, to keep off natural frequencies of shafts with both ends held, where D is infinite."""


def elastic(system: RowSystem) -> Mask:
    """Mask (n_laws,) of the laws that resist a slow motion, that is of springs and elastic shafts."""
    springs = system.stiffness > 0
    springs[[law for law, table in system.dynamic if table.is_elastic]] = True
    return np.asarray(springs)


def rigid_motions(system: RowSystem) -> FloatArray:
    """Shapes (n_q, n_rigid) of motions that no spring resists."""
    return echelon_basis(unresisted_motions(system, elastic(system)).basis())


def number_below(system: RowSystem, omega: float) -> int:
    """Number of natural frequencies without damping below omega in rad/s, rigid bodies included."""
    system = without_empty_laws(system)
    system = without_empty_laws(restrict_to(system, resisted_coordinates(system)))
    # Rigid motions lie below every omega, whatever rounding makes of their pivots.
    return max(int(ModeCount(system).below(np.array([omega])).item()), int(rigid_motions(system).shape[1]))


def natural_rates(system: RowSystem, count: int) -> FloatArray:
    """Lowest natural frequencies without damping in rad/s, rigid bodies as 0, shape (count,)."""
    modes = ModeCount(system)
    rigid = rigid_motions(system).shape[1]
    if count <= rigid:
        return np.zeros(count)
    wanted = np.arange(rigid + 1, count + 1)
    first = first_rate(system)
    upper = OFF_CLAMPED * first
    while modes.below(np.array([upper]))[0] < count:
        upper *= 2
        if upper > 1e12 * first:
            text = f"fewer than {count} modes of the continuous shafts were found below {upper / (2 * np.pi):.3g} Hz"
            raise SolveError(f"{text}; ask for fewer with lowest or up_to", kind="no-solution")
    low, high = np.full(len(wanted), SLOWEST_VIBRATION * first), np.full(len(wanted), upper)
    for _ in range(BISECTIONS):
        # The geometric middle over decades, the arithmetic one within a factor of two.
        middle = np.where(high > 2 * low, np.sqrt(low * high), (low + high) / 2)
        # The r-th frequency lies below the middle if at least r of them do.
        above = modes.below(middle) >= wanted
        low, high = np.where(above, low, middle), np.where(above, middle, high)
        if np.all(high - low <= 2 * np.spacing(high)):
            break
    return np.concatenate([np.zeros(rigid), (low + high) / 2])


def first_rate(system: RowSystem) -> float:
    """Lowest natural frequency in rad/s of any continuous shaft by itself, with both ends free."""
    rates = []
    for _, table in system.dynamic:
        if table.is_continuous:
            k, J, *_ = (float(coefficient) for coefficient in table.coefficients)
            # Both ends free: omega = pi sqrt(k / J), with stiffness and inertia of the whole shaft.
            rates.append(np.pi * np.sqrt(k / J))
    return float(min(rates))


def undamped_modes(system: RowSystem, count: int) -> tuple[FloatArray, FloatArray]:
    """Natural frequencies (count,) in rad/s without damping and real shapes (n_q, count), rigid bodies first."""
    system = without_empty_laws(system)
    kept = resisted_coordinates(system)
    rates, shapes = _undamped_modes(without_empty_laws(restrict_to(system, kept)), count)
    every = np.zeros((system.n_coordinates, len(rates)))
    every[kept] = shapes
    return rates, every


def _undamped_modes(system: RowSystem, count: int) -> tuple[FloatArray, FloatArray]:
    rates, rigid = natural_rates(system, count), rigid_motions(system)
    shapes = np.zeros((system.n_coordinates, count))
    shapes[:, : rigid.shape[1]] = rigid[:, :count]
    modes = ModeCount(system)
    for group in equal_rates(rates):
        if rates[group[0]] > 0:
            shapes[:, group] = _null_vectors(system, modes, float(np.mean(rates[group])), len(group))
    return rates, shapes


def equal_rates(rates: FloatArray) -> list[list[int]]:
    """Groups of indices of rising natural frequencies that are equal within rounding."""
    groups: list[list[int]] = []
    for place, rate in enumerate(rates):
        if groups and rate - rates[groups[-1][0]] <= SAME_FREQUENCY * rate:
            groups[-1].append(place)
        else:
            groups.append([place])
    return groups


def _null_vectors(system: RowSystem, modes: ModeCount, omega: float, count: int) -> FloatArray:
    """Shapes (n_q, count) of the modes at a natural frequency in rad/s, which D(omega) resists least."""
    kappa = modes.real_stiffness(np.array([omega]))[:, 0]
    rows = system.rows
    D = rows.T @ (kappa[:, None] * rows)
    scale = 1 / np.sqrt(np.maximum(np.abs(rows.T**2 @ np.abs(kappa)), 1e-300))
    values, vectors = np.linalg.eigh(scale[:, None] * D * scale)
    # D is singular at a natural frequency: the eigenvalues next to zero belong to its shapes.
    chosen = np.argsort(np.abs(values))[:count]
    shapes = scale[:, None] * vectors[:, chosen]
    return np.asarray(shapes / np.abs(shapes).max(axis=0))
