"""Transfer functions of all variants of a batch at the same frequencies."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import TorsionnetError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.assembly.system import Assembly
from torsionnet.linear.batch.batch import Batch
from torsionnet.linear.dynamic_stiffness.quotient import transfer_functions
from torsionnet.linear.dynamic_stiffness.sweep import chosen_method
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, request_for_model
from torsionnet.linear.responses.transfer import Evaluated, evaluate, responses
from torsionnet.linear.responses.zero import at_zero
from torsionnet.model.checks.structure import rigid_motions

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
    >>> found = batched_responses(batch, cached_request(rig, "theta_1", "T_M", None), np.array([8.0, 9.0]))
    >>> found.values.shape, bool(np.isnan(found.values[2]).all())
    ((3, 2, 1, 1), True)
    """
    shape = (len(batch), len(frequencies))
    method = chosen_method(request.reading_problem.problem, len(batch) * len(frequencies), method)
    values = np.empty((*shape, len(request.outputs), len(request.measured)), dtype=complex)
    found = Evaluated(values, np.empty(shape))
    found.values[batch.impossible], found.conditioning[batch.impossible] = complex(np.nan, np.nan), np.nan
    singly = [np.flatnonzero(batch.separate & ~batch.impossible)]
    for places in _blocks(batch.stacked, len(frequencies)):
        try:
            block = _together(batch.part(places), request, frequencies, method)
        except TorsionnetError:  # one of them is to blame
            singly.append(places)
            continue
        follow = len(places) == 1 + places[-1] - places[0]
        where = slice(int(places[0]), int(places[-1]) + 1) if follow else places
        found.values[where], found.conditioning[where] = block
    for index in np.concatenate(singly).tolist():
        model = batch.model(index)
        try:
            one = responses([model], request_for_model(model, request), frequencies, method)
        except TorsionnetError as error:
            refused(error)
            one = Evaluated(*(np.full((1, *part.shape[1:]), np.nan) for part in found))
        found.values[index], found.conditioning[index] = one.values[0], one.conditioning[0]
    return found


def _blocks(places: NDArray[np.intp], n_frequencies: int) -> Iterator[NDArray[np.intp]]:
    size = max(1, POINTS_AT_ONCE // max(1, n_frequencies))
    return (places[start : start + size] for start in range(0, len(places), size))


def _together(batch: Batch, request: TransferRequest, f: FloatArray, method: str) -> Evaluated:
    """Transfer functions (n, n_f, n_out, n_in) in SI units of variants with the same rows, solved together."""
    moving, shape = f > 0, (len(batch), len(f))
    if moving.all():
        found = evaluate(SingleAssemblies(batch), request, f, method, batch.law_stiffness(2 * np.pi * f))
        scale_stresses(found.values, batch, request)
        return found
    values = np.empty((*shape, len(request.outputs), len(request.measured)), dtype=complex)
    found = Evaluated(values, np.ones(shape))
    if moving.any():
        kappa = batch.law_stiffness(2 * np.pi * f[moving])
        part = evaluate(SingleAssemblies(batch), request, f[moving], method, kappa)
        found.values[:, moving], found.conditioning[:, moving] = part
    if not moving.all():
        found.values[:, ~moving] = _static(batch, request, method)[:, None]
    scale_stresses(found.values, batch, request)
    return found


def _static(batch: Batch, request: TransferRequest, method: str) -> Any:
    """Transfer functions (n, n_out, n_in) in SI units at 0 Hz, as for single drivetrains.

    See :func:`torsionnet.linear.responses.transfer.responses`.
    """
    n_out, n_in = len(request.outputs), len(request.measured)
    found = np.full((len(batch), n_out, n_in), np.inf + 0j)
    single = np.ones(len(batch), dtype=bool)
    if not rigid_motions(batch.drivetrain.assembly.kinematics):
        points = transfer_functions(request, batch.law_stiffness(np.zeros(1)), method)
        found, single = points.values, points.uncertain | ~np.isfinite(points.values).all(axis=(1, 2))
    for index in np.flatnonzero(single):
        found[index] = at_zero(batch.model(int(index)), request)
    return found


def scale_stresses(values: Any, batch: Batch, request: TransferRequest) -> None:
    """Scale the stresses among ``values`` in place from the drivetrain's section moduli to those of the variants."""
    for place, reading in enumerate((*request.outputs, *(request.measured if request.is_measured else ()))):
        sensor = reading.sensor
        if sensor is None or sensor.quantity != "stress" or sensor.of not in batch.moduli:
            continue
        ratio = batch.moduli[sensor.of][:, None, None]
        if place < len(request.outputs):
            values[:, :, place] /= ratio
        else:
            values[:, :, :, place - len(request.outputs)] *= ratio
