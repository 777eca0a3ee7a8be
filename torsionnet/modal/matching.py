"""Modes compared: criteria of shapes (MAC, MSF, MPC), and pairs of identified modes and modes of a model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.conventions import MODE_NUMBER, OSCILLATORY, REAL, SI, Conventions, mode_numbers
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.notes import NoteOrText
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Column, Table
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.linear.modes.modes import Modes
from torsionnet.modal.matrix_fraction import as_poles, damping_ratios, natural_frequencies, upper_half, without_rounding
from torsionnet.modal.spectral_lines import ComplexArray, FloatArray, powers_of

# Criteria of mode shapes (MAC, MSF, MPC), and the complex mode indicator function of frequency responses.


def mac(first: ArrayLike, second: ArrayLike) -> FloatArray:
    """Modal assurance criterion ``|a^H b|^2 / (a^H a  b^H b)`` of every pair of shapes, (n_first, n_second).

    Parameters
    ----------
    first, second : (n_sensors, n_modes) or (n_sensors,) arrays
        Shapes at the same sensors. Rows in which either has a nan, such as nodes that are not part of a cut system,
        are left out.

    Returns
    -------
    (n_first, n_second) array
        1 for shapes that are proportional, 0 for orthogonal ones; nan for a shape of zeros. With one sensor the
        MAC is always 1 and says nothing.

    References
    ----------
    Allemang and Brown, A correlation coefficient for modal vector analysis, IMAC 1982.

    Examples
    --------
    >>> mac([[1, 1], [1, -1]], [1, 1j]).round(12).tolist()
    [[0.5], [0.5]]
    """
    a, b = _pair(first, second)
    common = np.abs(a.conj().T @ b) ** 2
    sizes = [np.sum(np.abs(shape) ** 2, axis=0) for shape in (a, b)]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(common / np.outer(*sizes))


def msf(first: ArrayLike, second: ArrayLike) -> ComplexArray:
    """Modal scale factor of each shape, complex, (n_modes,), which brings ``first`` closest to ``second``.

    Parameters
    ----------
    first, second : (n_sensors, n_modes) or (n_sensors,) arrays

    Returns
    -------
    (n_modes,) complex array
        ``a^H b / a^H a``.

    Examples
    --------
    >>> msf([1, 2j], [-2, -4j]).tolist()
    [(-2+0j)]
    """
    a, b = _pair(first, second)
    if a.shape != b.shape:
        raise UsageError(
            f"scale factors need as many shapes on both sides, got {a.shape[1]} and {b.shape[1]}", kind="wrong-count"
        )
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.sum(a.conj() * b, axis=0) / np.sum(np.abs(a) ** 2, axis=0))


def mpc(shapes: ArrayLike) -> FloatArray:
    """Modal phase collinearity of each shape, (n_modes,), 1 where all sensors move in phase or against each other.

    ``((Sxx - Syy)^2 + 4 Sxy^2) / (Sxx + Syy)^2`` with the sums of squares and products of real and imaginary parts
    (Pappa, Elliott and Schenk 1993). Low values mean much non-proportional damping, a poor fit, or two modes in one.

    Parameters
    ----------
    shapes : (n_sensors, n_modes) or (n_sensors,) array

    Examples
    --------
    >>> mpc([[1, 1], [-2, 1j]]).tolist()
    [1.0, 0.0]
    """
    given = _shapes(shapes)
    x, y = given.real, given.imag
    # Of the eigenvalues l_1, l_2 of [[sxx, sxy], [sxy, syy]] it is ((l_1 - l_2)/(l_1 + l_2))^2.
    sxx, syy, sxy = np.nansum(x * x, axis=0), np.nansum(y * y, axis=0), np.nansum(x * y, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(((sxx - syy) ** 2 + 4 * sxy**2) / (sxx + syy) ** 2)


def cmif(response: FrequencyResponse) -> FloatArray:
    """Complex mode indicator function, singular values of the transfer functions at every frequency, (n_f, n_curves).

    Parameters
    ----------
    response : FrequencyResponse
        Outputs of unlike quantities are compared after each transfer function is divided by its root mean square.

    Returns
    -------
    (n_f, min(n_out, n_in)) array
        In the unit of the responses, largest first. Each curve has peaks at modes; two curves with a peak at one
        frequency are two modes there. (Shih et al. 1988 define it with the squares of these.)

    Examples
    --------
    >>> import torsionnet as tn
    >>> response = tn.load("dmf_rig").frequency_response("theta_1", "T_M", [1, 7, 20])
    >>> bool(np.allclose(cmif(response)[:, 0], response.magnitude[:, 0, 0]))
    True
    """
    values = response.values
    units = {(channel.unit, into.unit) for channel in response.outputs for into in response.inputs}
    if len(units) > 1:
        powers_of(response.outputs, response.inputs)
        # With unlike units the larger numbers would rule the singular values: each transfer function over its size.
        size = np.sqrt(np.nanmean(np.abs(values) ** 2, axis=0))
        values = values / np.where(size > 0, size, 1)
    singular_values = np.full((len(values), min(values.shape[1:])), np.nan)
    finite = np.isfinite(values).all(axis=(1, 2))
    singular_values[finite] = np.linalg.svd(values[finite], compute_uv=False)
    return singular_values


def _shapes(given: ArrayLike) -> ComplexArray:
    values = np.asarray(given, dtype=complex)
    if values.ndim == 1:
        values = values[:, None]
    if values.ndim != 2 or not len(values):
        raise UsageError(f"shapes are arrays of sensors by modes, got {values.ndim} dimensions", kind="wrong-form")
    return values


def _pair(first: ArrayLike, second: ArrayLike) -> tuple[ComplexArray, ComplexArray]:
    a, b = _shapes(first), _shapes(second)
    if len(a) != len(b):
        raise UsageError(f"shapes must be given at the same sensors, got {len(a)} and {len(b)}", kind="wrong-count")
    known = np.isfinite(a).all(axis=1) & np.isfinite(b).all(axis=1)
    if not known.any():
        raise UsageError(
            "there is no sensor at which both shapes are known; give shapes with a common sensor", kind="missing-data"
        )
    return a[known], b[known]


# Pairs of identified modes and modes of a model, with errors of frequency and damping, and MAC.

IntArray: TypeAlias = NDArray[np.int_]

LARGEST_POLE_DISTANCE = 0.5
"""Distance of two poles over ``|lambda|`` of the model above which the modes are no pair, unless ``match`` is told
another."""


@dataclass(frozen=True)
class MatchedMode:
    """Pair of an identified mode and a mode of the model, with relative errors of frequency and damping ratio."""

    identified: int
    model: Annotated[int | None, Out(schema=MODE_NUMBER)]
    frequency_error: float
    damping_error: float


@dataclass(frozen=True, eq=False, repr=False)
class Match(SavedResult):
    """Pairs of identified modes and modes of a model, with their poles (rad/s) and the MAC of their shapes.

    Attributes
    ----------
    identified, model : (n_pairs,) int arrays
        Indices of the partners, from 0, in the order of the identified modes.
    identified_poles, model_poles : complex arrays
        All poles, rad/s.
    mac : (n_identified, n_model) array or None
        MAC of the shapes at common sensors; None where there are fewer than two.
    title : str
    notes : tuple of str or Note
    """

    identified: IntArray
    model: IntArray
    identified_poles: ComplexArray
    model_poles: ComplexArray
    mac: FloatArray | None
    title: str = ""
    notes: tuple[NoteOrText, ...] = ()

    @property
    def frequency_errors(self) -> FloatArray:
        """Relative errors of the natural frequencies of all pairs, identified over model less 1, (n_pairs,)."""
        identified, model = self._partners()
        return np.asarray(natural_frequencies(identified) / natural_frequencies(model) - 1)

    @property
    def damping_errors(self) -> FloatArray:
        """Relative errors of the damping ratios of all pairs, identified over model less 1, (n_pairs,)."""
        identified, model = self._partners()
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(damping_ratios(identified) / damping_ratios(model) - 1)

    @property
    def model_numbers(self) -> tuple[int | None, ...]:
        """Number of each mode of the model as in the model's own tables, None for real poles."""
        return mode_numbers([OSCILLATORY if pole.imag > 0 else REAL for pole in self.model_poles])

    @property
    def pairs(self) -> Annotated[tuple[MatchedMode, ...], Out(json="against_model", optional=True)]:
        """Pairs of modes with their relative errors, as JSON has them beside the identified modes."""
        errors = zip(self.frequency_errors.tolist(), self.damping_errors.tolist(), strict=True)
        return tuple(
            MatchedMode(identified + 1, self.model_numbers[model], frequency, damping)
            for identified, model, (frequency, damping) in zip(
                self.identified.tolist(), self.model.tolist(), errors, strict=True
            )
        )

    def _name(self, place: int) -> int | str:
        return self.model_numbers[place] or REAL

    def _partners(self) -> tuple[ComplexArray, ComplexArray]:
        return self.identified_poles[self.identified], self.model_poles[self.model]

    def table(self, conventions: Conventions = SI) -> Table:
        """Table with a row for each pair of modes, then for each mode without a partner."""
        columns = (
            Column("identified"),
            Column("model"),
            Column("identified frequency", conventions.frequency),
            Column("model frequency", conventions.frequency),
            Column("frequency error", "%", 3),
            Column("identified damping", "1", 5),
            Column("model damping", "1", 5),
            Column("damping error", "%", 3),
            Column("MAC", "1", 4),
        )
        return Table(self.title, columns, tuple(self._rows(conventions.frequency_scale)), tuple(map(str, self.notes)))

    def _rows(self, scale: float) -> Iterator[tuple[int | float | str | None, ...]]:
        f, z = (
            [function(poles) for poles in (self.identified_poles, self.model_poles)]
            for function in (natural_frequencies, damping_ratios)
        )
        errors = zip(self.frequency_errors, self.damping_errors, strict=True)
        for i, m, (df, dz) in zip(self.identified, self.model, errors, strict=True):
            similarity = None if self.mac is None else float(self.mac[i, m])
            numbers = (f[0][i] * scale, f[1][m] * scale, 100 * df, z[0][i], z[1][m], 100 * dz)
            yield (int(i) + 1, self._name(m), *(float(number) for number in numbers), similarity)
        for i in sorted(set(range(len(f[0]))) - {*self.identified.tolist()}):
            yield (i + 1, None, float(f[0][i] * scale), None, None, float(z[0][i]), None, None, None)
        for m in sorted(set(range(len(f[1]))) - {*self.model.tolist()}):
            yield (None, self._name(m), None, float(f[1][m] * scale), None, None, float(z[1][m]), None, None)


class FoundModes(Protocol):
    """Modes found in a measurement, with poles in rad/s, and shapes (n_out, n_modes) at the outputs."""

    @property
    def poles(self) -> ComplexArray: ...
    @property
    def shapes(self) -> ComplexArray: ...
    @property
    def outputs(self) -> tuple[Channel, ...]: ...
    @property
    def title(self) -> str: ...


def match(
    estimate: FoundModes,
    model: Modes | ArrayLike,
    *,
    shapes: ArrayLike | None = None,
    nodes: Mapping[str, str] | None = None,
    farthest: float = LARGEST_POLE_DISTANCE,
) -> Match:
    """Pairs of identified modes and the modes of a model nearest to them in pole and shape.

    Against a measured torque compare with ``drivetrain.modes(measured_input=...)``: its poles are not those of the
    whole drivetrain.

    Parameters
    ----------
    estimate : ModalEstimate or OperationalModes
        Modes from responses or, without shapes, from a run-up, a decay or an ambient record.
    model : Modes or (n_model,) complex array
        Modes of a drivetrain (rigid-body modes are left out), or poles in rad/s.
    shapes : (n_out, n_model) array, optional
        For a model given by poles: angles at the outputs of the estimate.
    nodes : dict, optional
        For a model given by :class:`~torsionnet.Modes`: output of the estimate -> node at which it measures. Outputs
        that have the name of a node need no entry.
    farthest : float, optional
        Modes are no pair if their poles are farther apart than this share of the model's ``|lambda|``.

    Returns
    -------
    Match
        The pairs have the least sum of relative distances of the poles and ``1 - MAC``.

    Raises
    ------
    UsageError
        Shapes or sensors that do not fit.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.modal import identify_modes
    >>> rig = tn.load("amt_rig").configured("II")
    >>> estimate = identify_modes(rig.frequency_response("theta_1", "T_T", np.arange(0.5, 30, 0.1)))
    >>> bool(np.abs(match(estimate, rig.modes(measured_input="T_T")).frequency_errors).max() < 1e-6)
    True
    >>> match(estimate, rig.modes()).frequency_errors.round(2).tolist()  # not those of the rig as a whole
    [0.16, 0.06]
    """
    poles, known = _of_model(estimate, model, shapes, nodes)
    distance = np.abs(estimate.poles[:, None] - poles) / np.abs(poles)
    similarity = None if known is None else mac(*known)
    cost = distance if similarity is None else distance + np.nan_to_num(1 - similarity, nan=1.0)
    rows, columns = _assigned(np.where(distance <= farthest, cost, np.inf))
    notes = () if similarity is not None else ("no MAC: it takes the shapes at two or more common sensors",)
    title = f"{estimate.title}: identified modes against the model"
    return Match(rows, columns, estimate.poles, poles, similarity, title, notes)


def _of_model(
    estimate: FoundModes, model: Modes | ArrayLike, shapes: ArrayLike | None, at: Mapping[str, str] | None
) -> tuple[ComplexArray, tuple[ComplexArray, ComplexArray] | None]:
    """Poles of the model in rad/s, and shapes of estimate and model at common sensors, None with fewer than two."""
    if isinstance(model, Modes):
        return _of_modes(estimate, model, at)
    if shapes is None:
        return as_poles(model), None
    given = without_rounding(np.atleast_1d(np.asarray(model, dtype=complex)))
    rows = np.asarray(shapes, dtype=complex)
    if rows.shape != (len(estimate.outputs), len(given)):
        size = f"{len(estimate.outputs)} outputs by {len(given)} poles"
        raise UsageError(
            f"the model's shapes must be {size}, got {' by '.join(str(n) for n in rows.shape)}", kind="wrong-count"
        )
    order = upper_half(given)
    return given[order], (estimate.shapes, rows[:, order]) if len(rows) > 1 else None


def _of_modes(
    estimate: FoundModes, model: Modes, at: Mapping[str, str] | None
) -> tuple[ComplexArray, tuple[ComplexArray, ComplexArray] | None]:
    names = [channel.name for channel in estimate.outputs]
    for output in at or {}:
        if output not in names:
            raise UsageError(
                f'no output is named "{output}"{did_you_mean(output, names)}; there is {", ".join(names)}',
                kind="unknown-name",
            )
    places = {**{name: name for name in names if name in model.nodes}, **(at or {})}
    flexible = model.eigenvalues != 0
    angles = [row for row, channel in enumerate(estimate.outputs) if channel.name in places and channel.unit != "N*m"]
    poles = np.asarray(model.eigenvalues[flexible])
    nodes = [model.shape_at(places[names[row]])[flexible] for row in angles]
    known = [row for row, values in zip(angles, nodes, strict=True) if np.isfinite(values).all()]
    if len(known) < 2:
        return poles, None
    # Shapes tell apart what is close in poles.
    return poles, (estimate.shapes[known], np.array([v for v in nodes if np.isfinite(v).all()]))


def _assigned(cost: FloatArray) -> tuple[IntArray, IntArray]:
    """Row and column of each pair, as many pairs of finite cost as possible, at the lowest total cost."""
    from scipy.optimize import linear_sum_assignment

    allowed = np.isfinite(cost)
    # A forbidden pair costs more than all allowed ones together, so that as many of these as possible are made.
    prohibitive = 1 + 4 * cost[allowed].sum() if allowed.any() else 1.0
    rows, columns = linear_sum_assignment(np.where(allowed, cost, prohibitive))
    kept = allowed[rows, columns]
    return rows[kept], columns[kept]
