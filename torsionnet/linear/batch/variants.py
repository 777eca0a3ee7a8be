"""Transfer functions of many variants of a drivetrain, with those of the same rows solved together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.batch.batch import Batch
from torsionnet.linear.batch.batch_plan import batch_plan
from torsionnet.linear.batch.batched_responses import batched_responses
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, cached_request
from torsionnet.linear.responses.grid import Adaptive
from torsionnet.linear.responses.transfer import Evaluated, chosen_frequencies, known_method, responses, warn_infinite
from torsionnet.linear.responses.variant_responses import FrequencyResponses
from torsionnet.model.channels import Channels
from torsionnet.model.operating_values import law_notes


def frequency_responses(
    drivetrain: AssembledModel,
    output: Channels,
    input: Channels,
    frequencies: ArrayLike | Adaptive,
    variants: Mapping[str, ArrayLike],
    *,
    excitation: str | Sequence[str] | None = None,
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
    request = cached_request(drivetrain, output, input, excitation)
    f = chosen_frequencies(drivetrain, frequencies, request)
    batch = _batch(drivetrain, parameters)
    if batch is None:

        def ask(copy: AssembledModel) -> TransferRequest:
            return cached_request(copy, output, input, excitation)

        values, conditioning = _grouped([drivetrain.configured(**row) for row in _rows(parameters)], ask, f, method)
    else:
        values, conditioning = batched_responses(batch, request, f, method)
    warn_infinite(values, conditioning, f)
    return FrequencyResponses(
        parameters,
        f,
        values,
        tuple(reading.channel for reading in request.outputs),
        tuple(reading.channel for reading in request.measured),
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
            "variants are lists of numbers in SI by parameter, all of one length: {'k_2': [400, 460, 500]}"
        )
    return dict(zip(columns, (column.copy() for column in spread), strict=True))


def _rows(columns: Mapping[str, FloatArray]) -> Iterator[dict[str, float]]:
    return (dict(zip(columns, map(float, row), strict=True)) for row in zip(*columns.values(), strict=True))
