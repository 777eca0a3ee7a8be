"""Poles by matrix fraction, a quotient of polynomials for all transfer functions, and their stabilisation diagram.

The right matrix fraction ``H = s^p B A^-1 / s^q`` is linear in A and B once multiplied by A. The rows of B
belong to one output each and are eliminated by QR decompositions; the equations left define A, whose roots are the
poles.

Polynomial bases (powers of z, orthogonal polynomials of s), and roots of matrix polynomials in them. Powers of z are on
the unit circle; the polynomials in s are orthogonal over the lines of a measurement (Forsythe's, as in Richardson and
Formenti, IMAC 1982). On the imaginary axis these are even or odd, so that

    s p_k = b_(k+1) p_(k+1) - b_k p_(k-1)

with one real coefficient for each degree. No powers of s are formed, which would lose digits.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.packages import SavedResult
from torsionnet.base.table import Column, Table
from torsionnet.linear.frequency_response import FrequencyResponse
from torsionnet.linear.modes.modes import OSCILLATORY, REAL
from torsionnet.modal.residues import expand
from torsionnet.modal.spectral_lines import ComplexArray, Criteria, FloatArray, Lines, Settings, lines_of

# Poles by matrix fraction, a quotient of polynomials that is fitted to all transfer functions of a test.

# Natural frequencies, damping ratios and kinds of poles, and one pole of each conjugate pair.

ROUND_OFF = 1e-9
"""Imaginary part of a pole over its size up to which the pole counts as real, being rounding of the eigenvalues."""


def natural_frequencies(poles: ArrayLike) -> FloatArray:
    """Natural frequencies ``|lambda| / 2 pi`` in Hz of poles lambda in rad/s, same shape."""
    return np.asarray(np.abs(poles) / (2 * np.pi))


def damping_ratios(poles: ArrayLike) -> FloatArray:
    """Damping ratios ``-Re lambda / |lambda|`` of poles lambda in rad/s, same shape, 1 for a stable real pole."""
    values = np.asarray(poles, dtype=complex)
    return np.asarray(-values.real / np.abs(values))


def kinds(poles: ComplexArray) -> tuple[str, ...]:
    """Kind of each pole, ``"oscillatory"`` or ``"real pole"``, in the order of the poles."""
    return tuple(REAL if value.imag == 0 else OSCILLATORY for value in poles)


def upper_half(roots: ComplexArray) -> NDArray[np.int_]:
    """Indices of the real roots and of one root of each conjugate pair, sorted by magnitude, among all roots."""
    kept = np.flatnonzero(roots.imag >= -ROUND_OFF * np.abs(roots))
    return np.asarray(kept[np.argsort(np.abs(roots[kept]), kind="stable")])


def without_rounding(roots: ComplexArray) -> ComplexArray:
    """Copy of complex roots in which an imaginary part of rounding size is zero, same shape."""
    return np.where(np.abs(roots.imag) <= ROUND_OFF * np.abs(roots), roots.real, roots)


def as_poles(given: ArrayLike) -> ComplexArray:
    """Poles in rad/s (n,), one of each conjugate pair, sorted by size, from a list that may hold both of a pair.

    >>> as_poles([-1 + 10j, -1 - 10j, -3]).tolist()
    [(-3+0j), (-1+10j)]
    """
    values = without_rounding(np.atleast_1d(np.asarray(given, dtype=complex)))
    if values.ndim != 1 or not len(values) or not np.isfinite(values).all() or not values.all():
        raise UsageError(
            "poles are a list of finite numbers in rad/s other than 0; give one or both of each conjugate pair",
            kind="not-finite",
        )
    return np.asarray(values[upper_half(values)])


# Polynomial bases (powers of z, orthogonal polynomials of s), and roots of matrix polynomials in them.


@dataclass(frozen=True, eq=False)
class Family:
    """Basis of polynomials of degree 0 to n, with the value of each at every line, (n_f, n + 1).

    Attributes
    ----------
    values : (n_f, n + 1) complex array
        Value of each polynomial at each line.
    up, down : (n,) arrays
        ``x p_k = up[k] p_(k+1) + down[k] p_(k-1)``.
    """

    values: ComplexArray
    up: FloatArray
    down: FloatArray


def powers(z: ComplexArray, degree: int) -> Family:
    """Basis of the powers 1, z, z^2, ... up to a degree, with their values at the lines z."""
    return Family(z[:, None] ** np.arange(degree + 1), np.ones(degree), np.zeros(degree))


def orthogonal(s: ComplexArray, weights: FloatArray, degree: int) -> Family:
    """Basis of polynomials orthonormal over the lines s = j omega under the given weights, up to a degree.

    >>> s = 1j * np.linspace(1, 2, 50)
    >>> values = orthogonal(s, np.ones(50), 3).values
    >>> bool(np.allclose((values.conj().T @ values).real, np.eye(4)))
    True
    """
    omega = s.imag
    real = np.zeros((len(s), degree + 1))
    real[:, 0] = 1 / np.linalg.norm(weights)
    steps = np.zeros(degree + 1)
    for k in range(degree):
        # omega p_k less its part along p_(k-1); parity keeps the part along p_k at 0.
        raised = omega * real[:, k] - (steps[k] * real[:, k - 1] if k else 0.0)
        # The recurrence alone loses orthogonality at high degrees; only those of like parity overlap.
        same = real[:, (k + 1) % 2 : k + 1 : 2]
        raised -= same @ (same.T @ (weights**2 * raised))
        steps[k + 1] = np.linalg.norm(weights * raised)
        real[:, k + 1] = raised / steps[k + 1]
    # With j^k they are polynomials in s of real coefficients.
    return Family(real * 1j ** np.arange(degree + 1), steps[1:], -steps[:-1])


def roots(coefficients: FloatArray, family: Family) -> tuple[ComplexArray, ComplexArray]:
    """Roots (n m,) of a matrix polynomial ``sum A_k p_k``, where it is singular, and row vectors u with u A = 0.

    Parameters
    ----------
    coefficients : (n + 1, m, m) array
        A_k.
    family : Family

    Returns
    -------
    roots : (n m,) complex array
    rows : (n m, m) complex array
        u with ``u A(root) = 0``.

    Notes
    -----
    Eigenvalues of the comrade matrix: the companion matrix in another basis than powers.
    """
    import scipy.linalg

    degree, size = len(coefficients) - 1, coefficients.shape[1]
    transposed = coefficients.transpose(0, 2, 1)
    # Comrade matrix: s p_k = up_k p_(k+1) + down_k p_(k-1), the last row by sum A_k p_k = 0.
    comrade = np.zeros((degree, size, degree, size))
    unit = np.eye(size)
    for k in range(degree - 1):
        comrade[k, :, k + 1] = family.up[k] * unit
        comrade[k + 1, :, k] = family.down[k + 1] * unit
    last = np.linalg.lstsq(transposed[-1], np.hstack(list(transposed[:-1])))[0]
    comrade[-1] -= family.up[degree - 1] * last.reshape(size, degree, size)
    eigenvalues, vectors = scipy.linalg.eig(comrade.reshape(degree * size, degree * size))
    return np.asarray(eigenvalues), np.asarray(vectors[:size].T)


MOST_ROUNDS = 20
"""Largest number of rounds in which a fit is reweighted, as poles of noise may never converge."""
POLE_CONVERGENCE = 1e-9
"""Relative change of all poles below which the reweighting of a fit ends, small against any standard error."""
START_CONVERGENCE = 1e-3
"""Relative change of all poles below which that of a record ends, as they are only the start of a refinement."""
TRANSIENT_DEGREES = 3
"""Degrees of the polynomial of a record's transients above those of the denominator, from 1/s^2 on."""
SMALLEST_DENOMINATOR = 1e-12
"""Least size of the denominator over its largest that weights assume, as poles on the imaginary axis would divide by
0."""
NYQUIST_MARGIN = 0.999
"""Frequency of a pole over that of the highest line above which the pole is an artefact of the fold at z = -1."""


def poles_of_orders(lines: Lines, highest: int, settings: Settings) -> Iterator[tuple[ComplexArray, ComplexArray]]:
    """Yield the stable poles (rad/s) and their participations of the inputs, of fits of order 1, 2, 3 and so on.

    Yields
    ------
    poles : (n,) complex array
        rad/s, one of each conjugate pair.
    participations : (n, n_in) complex array
    """
    for poles, rows in (_rational if settings.method == "rational" else _lscf)(lines, highest, settings):
        roots = without_rounding(poles)
        kept = [place for place in upper_half(roots) if roots[place].real < 0]
        yield roots[kept], rows[kept]


def largest_order(lines: Lines, settings: Settings) -> int:
    """Highest order at which a fit has no more unknowns than equations for each output."""
    extra = 1 + 2 * settings.has_lower
    inputs = lines.values.shape[2]
    return int(max(0, (2 * len(lines.s) - extra - inputs) // (1 + inputs) - 1))


def _rational(lines: Lines, highest: int, settings: Settings) -> Iterator[tuple[ComplexArray, ComplexArray]]:
    # s over the highest line, as powers of rad/s would lose all digits.
    scale = np.abs(lines.s).max()
    s = lines.s / scale
    for order in range(1, highest + 1):
        poles, rows = _reweighted(replace(lines, s=s), order, settings)
        yield poles * scale, rows


def _reweighted(lines: Lines, order: int, settings: Settings) -> tuple[ComplexArray, ComplexArray]:
    """Poles in rad/s scaled by the highest line, and participations, of one order, reweighted by its denominator."""
    s, inputs = lines.s, lines.values.shape[2]
    below = 2 if settings.has_lower else 0
    numerator = max(order - (not settings.has_upper), 0) + below
    driven = lines.drive is not None
    drive = np.ones(len(s), dtype=complex) if lines.drive is None else lines.drive
    numerator += 2 if driven and settings.has_upper else 0
    denominator, before = np.ones(len(s)), None
    for _ in range(MOST_ROUNDS):
        # B - H A, over the |A| of the round before, tends to B/A - H.
        family = orthogonal(s, 1 / denominator, order)
        rest = []
        for power, (receptance, weight) in zip(lines.powers[:, 0], _outputs(lines), strict=True):
            size = weight / denominator
            above = orthogonal(s, size * np.abs(drive) * np.abs(s) ** -below, numerator).values
            columns = size[:, None] * above * (drive * s**-below)[:, None]
            if driven:
                # Transients of a record have the same denominator, and are not driven.
                far = orthogonal(s, size * np.abs(s) ** (-2.0 - power), order + TRANSIENT_DEGREES).values
                columns = np.hstack([columns, size[:, None] * far * (s ** (-2.0 - power))[:, None]])
            rest.append(_eliminated(_equations(columns, size, receptance, family), columns.shape[1]))
        coefficients = _denominator(np.vstack(rest), order, inputs)
        poles, rows = roots(coefficients, family)
        # Size of the matrix A at each line, by its determinant.
        size = np.abs(np.linalg.det(np.tensordot(family.values, coefficients, axes=1))) ** (1 / inputs)
        denominator = np.maximum(size, SMALLEST_DENOMINATOR * size.max())
        now = np.sort_complex(poles)
        if before is not None and np.allclose(
            now, before, rtol=START_CONVERGENCE if driven else POLE_CONVERGENCE, atol=0
        ):
            break
        before = now
    return poles, rows


def _denominator(equations: FloatArray, order: int, inputs: int) -> FloatArray:
    """Coefficients of the denominator from its equations, (n + 1, n_in, n_in), of unit length for one input.

    Without that, the columns of A could be multiples of each other, and every number a root.
    """
    if inputs == 1:
        # Unit coefficients that leave least: the right singular vector of the smallest singular value.
        return np.asarray(np.linalg.svd(equations)[2][-1].reshape(order + 1, 1, 1))
    free = order * inputs
    solved = np.linalg.lstsq(equations[:, :free], -equations[:, free:])[0]
    return np.vstack([solved, np.eye(inputs)]).reshape(order + 1, inputs, inputs)


def _lscf(lines: Lines, highest: int, settings: Settings) -> Iterator[tuple[ComplexArray, ComplexArray]]:
    """Yield poles (rad/s) and participations of each order by polynomials in z, which make noise poles unstable.

    Guillaume, Verboven et al., A poly-reference implementation of the least-squares complex frequency-domain estimator
    (IMAC 2003); Cauberghe (2004) on the constraint. The lines are reduced to triangles once, for all orders.
    """
    del settings
    # z = exp(s dt) with dt = pi/omega_max: the band is the upper half of the unit circle.
    interval = np.pi / np.abs(lines.s).max()
    family = powers(np.exp(lines.s * interval), highest)
    inputs = lines.values.shape[2]
    # One decomposition per output for all orders: a lower one takes some of its columns.
    triangles = [
        _triangle(_equations(weight[:, None] * family.values, weight, values, family))
        for values, weight in _outputs(lines, measured=True)
    ]
    for order in range(1, highest + 1):
        columns = [*range(order + 1), *range(highest + 1, highest + 1 + (order + 1) * inputs)]
        rest = np.vstack([_eliminated(triangle[:, columns], order + 1) for triangle in triangles])
        # A_0 = I, under which poles of noise come out unstable.
        solved = np.linalg.lstsq(rest[:, inputs:], -rest[:, :inputs])[0]
        coefficients = np.vstack([np.eye(inputs), solved]).reshape(order + 1, inputs, inputs)
        z, rows = roots(coefficients, family)
        with np.errstate(divide="ignore"):
            # s = ln(z)/dt; at z = -1, where the band folds, poles are its artefacts.
            poles = np.log(z) / interval
        inside = np.isfinite(poles) & (np.abs(poles.imag) < NYQUIST_MARGIN * np.pi / interval) & (poles != 0)
        yield poles[inside], rows[inside]


def _outputs(lines: Lines, *, measured: bool = False) -> Iterator[tuple[ComplexArray, FloatArray]]:
    """Yield, output by output, receptances (n_f, n_in) and the weights of the lines (n_f,)."""
    for o, power in enumerate(lines.powers):
        factor = np.ones((len(lines.s), len(power))) if measured else lines.s[:, None] ** power
        weights = lines.weights[:, o] * np.abs(factor)
        yield lines.values[:, o] / factor, np.sqrt(np.mean(weights**2, axis=1))


def _equations(numerator: ComplexArray, weight: FloatArray, values: ComplexArray, family: Family) -> FloatArray:
    """Real equations ``B - H A = 0`` of one output, with columns of B, then of A by degree and input."""
    weighted = weight[:, None] * values
    denominator = -(family.values[:, :, None] * weighted[:, None, :]).reshape(len(weight), -1)
    both = np.hstack([numerator, denominator])
    return np.vstack([both.real, both.imag])


def _eliminated(equations: FloatArray, numerators: int) -> FloatArray:
    """Equations of one output for the denominator alone, its numerators eliminated by a QR decomposition."""
    return _triangle(equations)[numerators:, numerators:]


def _triangle(equations: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.qr(equations, mode="r"))


# Stabilisation diagram, the poles of fits of rising order, of which modes stay and poles of noise wander.


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
