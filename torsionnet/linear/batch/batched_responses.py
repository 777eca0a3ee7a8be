"""Transfer functions of all variants of a batch at the same frequencies."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.errors import TorsionnetError, UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import Assembly, ComplexArray, FloatArray
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.batch.batch import Batch, BatchedStiffness
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.linear.dynamic_stiffness.quotient import chosen_method, rounding_errors, uncertain_points
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, cached_request, request_for_model
from torsionnet.linear.responses.grid import Adaptive
from torsionnet.linear.responses.shared_response import FrequencyResponses
from torsionnet.linear.responses.transfer import (
    Evaluated,
    chosen_frequencies,
    evaluate,
    evaluation,
    known_method,
    responses,
    warn_infinite,
)
from torsionnet.linear.responses.zero import at_zero
from torsionnet.model.channels import Channels
from torsionnet.model.checks.structure import rigid_motions
from torsionnet.model.operating_values import law_notes

POINTS_AT_ONCE = 100_000
"""Number of variants times frequencies that are solved together, which bounds the memory."""


class SingleAssemblies(Sequence[Assembly]):
    """Sequence of the assembled models of all variants of a batch, each made when it is indexed."""

    def __init__(self, batch: Batch) -> None:
        self.batch = batch

    def __len__(self) -> int:
        return len(self.batch)

    @overload
    def __getitem__(self, index: int) -> Assembly: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Assembly]: ...
    def __getitem__(self, index: int | slice) -> Assembly | Sequence[Assembly]:
        if isinstance(index, slice):
            return SingleAssemblies(self.batch.part(index))
        return self.batch.model(index).assembly


def _raised(error: TorsionnetError) -> None:
    raise error


def batched_responses(
    batch: Batch,
    request: TransferRequest,
    frequencies: FloatArray,
    method: str = "auto",
    refused: Callable[[TorsionnetError], None] = _raised,
) -> Evaluated:
    """Transfer functions (n, n_f, n_out, n_in) in SI units of all variants at frequencies >= 0 in Hz.

    Variants that are ``separate`` are solved by themselves; those that are impossible have NaN.

    Parameters
    ----------
    batch : Batch
    request : TransferRequest
        Of ``batch.drivetrain``.
    frequencies : (n_f,) array
        Hz.
    method : str
    refused : callable
        Called with the error of a variant that cannot be solved, which then has NaN; by default the error is raised.

    Raises
    ------
    UsageError
        A variant lacks a sensor or input of the request.

    Examples
    --------
    >>> import torsionnet as tn
    >>> from torsionnet.linear.batch.batch_plan import batch_plan
    >>> from torsionnet.linear.dynamic_stiffness.transfer_request import cached_request
    >>> rig = tn.load("dmf_rig")
    >>> batch = batch_plan(rig, ["k_2"]).batch({"k_2": np.array([400.0, 500.0, -1.0])})
    >>> responses = batched_responses(batch, cached_request(rig, "theta_1", "T_M", None), np.array([8.0, 9.0]))
    >>> responses.values.shape, bool(np.isnan(responses.values[2]).all())
    ((3, 2, 1, 1), True)
    """
    shape = (len(batch), len(frequencies))
    # One method for the whole batch, by the number of its points, whatever blocks it is solved in.
    method = chosen_method(request.reading_problem.problem, len(batch) * len(frequencies), method)
    values = np.empty((*shape, len(request.outputs), len(request.inputs)), dtype=complex)
    evaluated = Evaluated(values, np.empty(shape))
    evaluated.values[batch.impossible], evaluated.conditioning[batch.impossible] = complex(np.nan, np.nan), np.nan
    singly = [np.flatnonzero(batch.separate & ~batch.impossible)]
    for places in _blocks(batch.stacked, len(frequencies)):
        try:
            block = _together(batch.part(places), request, frequencies, method)
        except TorsionnetError:  # one of them is to blame
            singly.append(places)
            continue
        follow = len(places) == 1 + places[-1] - places[0]
        where = slice(int(places[0]), int(places[-1]) + 1) if follow else places
        evaluated.values[where], evaluated.conditioning[where] = block
    # Separate variants, and blocks with one that cannot be solved: single solutions tell which one that is.
    for index in np.concatenate(singly).tolist():
        model = batch.model(index)
        try:
            single = responses([model], request_for_model(model, request), frequencies, method)
        except TorsionnetError as error:
            refused(error)
            single = Evaluated(*(np.full((1, *part.shape[1:]), np.nan) for part in evaluated))
        evaluated.values[index], evaluated.conditioning[index] = single.values[0], single.conditioning[0]
    return evaluated


def _blocks(places: NDArray[np.intp], n_frequencies: int) -> Iterator[NDArray[np.intp]]:
    size = max(1, POINTS_AT_ONCE // max(1, n_frequencies))
    return (places[start : start + size] for start in range(0, len(places), size))


def _together(batch: Batch, request: TransferRequest, f: FloatArray, method: str) -> Evaluated:
    """Transfer functions (n, n_f, n_out, n_in) in SI units of variants with the same rows, solved together."""
    # 0 Hz stands apart: with rigid motions D(0) = K is singular.
    moving, shape = f > 0, (len(batch), len(f))
    if moving.all():
        evaluated = evaluate(SingleAssemblies(batch), request, f, method, batch.law_stiffness(2 * np.pi * f))
        scale_stresses(evaluated.values, batch, request)
        return evaluated
    values = np.empty((*shape, len(request.outputs), len(request.inputs)), dtype=complex)
    evaluated = Evaluated(values, np.ones(shape))
    if moving.any():
        laws = batch.law_stiffness(2 * np.pi * f[moving])
        part = evaluate(SingleAssemblies(batch), request, f[moving], method, laws)
        evaluated.values[:, moving], evaluated.conditioning[:, moving] = part
    if not moving.all():
        evaluated.values[:, ~moving] = _static(batch, request, method)[:, None]
    scale_stresses(evaluated.values, batch, request)
    return evaluated


def _static(batch: Batch, request: TransferRequest, method: str) -> Any:
    """Transfer functions (n, n_out, n_in) in SI units at 0 Hz, as for single drivetrains.

    See :func:`torsionnet.linear.responses.transfer.responses`.
    """
    n_out, n_in = len(request.outputs), len(request.inputs)
    # With rigid motions D(0) = K is singular, and every variant takes the limit that a single drivetrain has.
    static = np.full((len(batch), n_out, n_in), np.inf + 0j)
    single = np.ones(len(batch), dtype=bool)
    if not rigid_motions(batch.drivetrain.assembly.kinematics):
        # K resists every motion: solved directly, and only doubtful variants singly.
        laws, evaluate = batch.law_stiffness(np.zeros(1)), evaluation(request, method)
        static = evaluate(laws, False)
        single = uncertain_points(rounding_errors(evaluate, laws, static), len(batch))
    for index in np.flatnonzero(single):
        static[index] = at_zero(batch.model(int(index)), request)
    return static


def scale_stresses(values: Any, batch: Batch, request: TransferRequest) -> None:
    """Scale the stresses among ``values`` in place from the drivetrain's section moduli to those of the variants."""
    for place, reading in enumerate((*request.outputs, *(request.inputs if request.is_measured else ()))):
        sensor = reading.sensor
        if sensor is None or sensor.quantity != "stress" or sensor.of not in batch.moduli:
            continue
        # Stress is torque over the section modulus: an output goes with its inverse, a measured input with itself.
        ratio = batch.moduli[sensor.of][:, None, None]
        if place < len(request.outputs):
            values[:, :, place] /= ratio
        else:
            values[:, :, :, place - len(request.outputs)] *= ratio


# Transfer functions of variants that each have frequencies of their own, as in a search for peaks.


def responses_at_own_frequencies(
    batch: Batch, request: TransferRequest, frequencies: FloatArray, method: str = "auto"
) -> ComplexArray:
    """Transfer functions (n, n_f, n_out, n_in) in SI units at frequencies of each variant, NaN if it is impossible.

    Parameters
    ----------
    batch : Batch
    request : TransferRequest
        Of ``batch.drivetrain``.
    frequencies : (n, n_f) array
        Hz, above 0.
    method : str
    """
    shape = (*frequencies.shape, len(request.outputs), len(request.inputs))
    all_values = np.full(shape, complex(np.nan, np.nan))
    size = max(1, POINTS_AT_ONCE // max(1, frequencies.shape[1]))
    for start in range(0, len(batch.stacked), size):
        places = batch.stacked[start : start + size]
        part, own = batch.part(places), frequencies[places]
        laws = _law_stiffness(part, 2 * np.pi * own)
        values = evaluate(SingleAssemblies(part), request, own, method, laws).values
        scale_stresses(values, part, request)
        all_values[places] = values
    for index in np.flatnonzero(batch.separate & ~batch.impossible):
        model = batch.model(int(index))
        all_values[index] = responses([model], request_for_model(model, request), frequencies[index], method).values[0]
    return all_values


def _law_stiffness(batch: Batch, omega: FloatArray) -> LawStiffness:
    """Dynamic stiffness of all laws in N m/rad at omega (n, n_f) in rad/s, which differs by variant."""
    laws = dict.fromkeys(batched.law for batched in batch.dynamic)
    sampled = {law: np.zeros(omega.shape, dtype=complex) for law in laws}
    for batched in batch.dynamic:
        sampled[batched.law][batched.places] = _kappa(batched, omega[batched.places])
    # Actions are alike in all variants, but taken at the frequencies of each.
    s = np.asarray(1j * omega.ravel(), dtype=np.complex128)
    actions = tuple(action.kappa(s).reshape(omega.shape) for action in batch.drivetrain.assembly.system.actions)
    return LawStiffness(batch.inertia, batch.damping, batch.stiffness, omega, tuple(sampled.items()), actions)


def _kappa(batched: BatchedStiffness, omega: FloatArray) -> ComplexArray:
    if not len(batched.coefficients):
        return np.asarray(batched.of.kappa(omega.ravel())).reshape(omega.shape)
    return np.array([batched.single(place).kappa(own) for place, own in enumerate(omega)]).reshape(omega.shape)


# Transfer functions of many variants of a drivetrain, with those of the same rows solved together.


def frequency_responses(
    drivetrain: AssembledModel,
    output: Channels,
    input: Channels,
    frequencies: ArrayLike | Adaptive,
    variants: Mapping[str, ArrayLike],
    *,
    driven_by: str | Sequence[str] | None = None,
    method: str = "auto",
) -> FrequencyResponses:
    """Transfer functions of many variants of the drivetrain, solved together.

    Parameters
    ----------
    output, input, frequencies, excitation, method
        As for :meth:`frequency_response`.
    variants : mapping
        Parameter -> (n_variants,) values in SI; one value alone holds for all of them.

    Examples
    --------
    >>> import torsionnet as tn
    >>> family = tn.load("dmf_rig").frequency_responses("theta_1", "T_T", [0.0, 8.0], {"k_2": [400, 460, 500]})
    >>> family.magnitude[:, 0, 0, 0].round(6).tolist()
    [0.002575, 0.002249, 0.002075]
    """
    known_method(method)
    parameters = _columns(variants)
    request = cached_request(drivetrain, output, input, driven_by)
    f = chosen_frequencies(drivetrain, frequencies, request)
    batch = _batch(drivetrain, parameters)
    if batch is None:

        def ask(copy: AssembledModel) -> TransferRequest:
            return cached_request(copy, output, input, driven_by)

        # Most variants have rows or acting laws of their own, as where a ratio varies: each is assembled by itself.
        values, conditioning = _grouped([drivetrain.configured(**row) for row in _rows(parameters)], ask, f, method)
    else:
        values, conditioning = batched_responses(batch, request, f, method)
    warn_infinite(values, conditioning, f)
    return FrequencyResponses(
        parameters,
        f,
        values,
        tuple(reading.channel for reading in request.outputs),
        tuple(reading.channel for reading in request.inputs),
        drivetrain.title,
        conditioning if request.is_measured else None,
        (*request.notes, *law_notes(drivetrain.definition), *range_notes(drivetrain.assembly, f)),
        drivetrain.name,
        drivetrain.configuration,
    )


def _batch(drivetrain: AssembledModel, parameters: Mapping[str, FloatArray]) -> Batch | None:
    """Batch of all variants, or None where most have rows or acting laws of their own.

    Raises
    ------
    ModelError
        A variant is impossible.
    """
    plan = batch_plan(drivetrain, parameters)
    if plan is None:
        return None
    batch = plan.batch(parameters)
    if batch.impossible.any():
        # The model of the first impossible variant raises the error that says why.
        batch.model(int(np.argmax(batch.impossible)))
    return None if 2 * batch.separate.sum() > len(batch) else batch


def _grouped(
    copies: Sequence[AssembledModel], ask: Callable[[AssembledModel], TransferRequest], f: FloatArray, method: str
) -> Evaluated:
    """Transfer functions (n, n_f, n_out, n_in) in SI units of variants that are made one by one.

    Neighbours with the same request are solved together.
    """
    parts: list[Evaluated] = []
    requests = [ask(copy) for copy in copies]
    for _, group in groupby(zip(copies, requests, strict=True), key=lambda pair: id(pair[1])):
        alike = list(group)
        parts.append(responses([copy for copy, _ in alike], alike[0][1], f, method))
    return Evaluated(*(np.concatenate([getattr(part, name) for part in parts]) for name in Evaluated._fields))


def _columns(variants: Mapping[str, ArrayLike]) -> dict[str, FloatArray]:
    """Parameter values (n,) in SI units by name, one for each variant, where a single value holds for all variants."""
    try:
        columns = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in variants.items()}
        spread = list(np.broadcast_arrays(*columns.values()))
    except (TypeError, ValueError):
        spread = []
    if not spread or any(column.ndim != 1 for column in spread) or not len(spread[0]):
        raise UsageError(
            "variants are lists of numbers in SI by parameter, all of one length: {'k_2': [400, 460, 500]}",
            kind="wrong-form",
        )
    return dict(zip(columns, (column.copy() for column in spread), strict=True))


def _rows(columns: Mapping[str, FloatArray]) -> Iterator[dict[str, float]]:
    return (dict(zip(columns, map(float, row), strict=True)) for row in zip(*columns.values(), strict=True))
