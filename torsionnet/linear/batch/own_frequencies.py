"""Transfer functions of variants that each have frequencies of their own, as in a search for peaks."""

from __future__ import annotations

import numpy as np

from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.batch.batch import Batch
from torsionnet.linear.batch.batched_responses import POINTS_AT_ONCE, SingleAssemblies, scale_stresses
from torsionnet.linear.batch.batched_stiffness import BatchedStiffness
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, request_for_model
from torsionnet.linear.responses.transfer import evaluate, responses


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
    shape = (*frequencies.shape, len(request.outputs), len(request.measured))
    found = np.full(shape, complex(np.nan, np.nan))
    size = max(1, POINTS_AT_ONCE // max(1, frequencies.shape[1]))
    for start in range(0, len(batch.stacked), size):
        places = batch.stacked[start : start + size]
        part, own = batch.part(places), frequencies[places]
        kappa = _law_stiffness(part, 2 * np.pi * own)
        values = evaluate(SingleAssemblies(part), request, own, method, kappa).values
        scale_stresses(values, part, request)
        found[places] = values
    for index in np.flatnonzero(batch.separate & ~batch.impossible):
        model = batch.model(int(index))
        found[index] = responses([model], request_for_model(model, request), frequencies[index], method).values[0]
    return found


def _law_stiffness(batch: Batch, omega: FloatArray) -> LawStiffness:
    """Dynamic stiffness of all laws in N m/rad at omega (n, n_f) in rad/s, which differs by variant."""
    laws = dict.fromkeys(one.law for one in batch.dynamic)
    sampled = {law: np.zeros(omega.shape, dtype=complex) for law in laws}
    for one in batch.dynamic:
        sampled[one.law][one.places] = _kappa(one, omega[one.places])
    s = np.asarray(1j * omega.ravel(), dtype=np.complex128)
    actions = tuple(one.kappa(s).reshape(omega.shape) for one in batch.drivetrain.assembly.system.actions)
    return LawStiffness(batch.inertia, batch.damping, batch.stiffness, omega, tuple(sampled.items()), actions)


def _kappa(one: BatchedStiffness, omega: FloatArray) -> ComplexArray:
    if not len(one.coefficients):
        return np.asarray(one.of.kappa(omega.ravel())).reshape(omega.shape)
    return np.array([one.single(place).kappa(own) for place, own in enumerate(omega)]).reshape(omega.shape)
