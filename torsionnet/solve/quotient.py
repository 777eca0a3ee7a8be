"""Readings of lanes, and transfer functions as one reading over another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.assembly.law_stiffness import LawStiffness
from torsionnet.assembly.rows import ComplexArray, FloatArray
from torsionnet.solve import dense, starmesh
from torsionnet.solve.doubt import LARGE
from torsionnet.solve.posed import Posed
from torsionnet.solve.problem import Problem
from torsionnet.solve.question import Question
from torsionnet.solve.sweep import Sweep

Respond: TypeAlias = Callable[[Problem, LawStiffness], Sweep]
METHODS: dict[str, Respond] = {
    "auto": starmesh.respond,
    "graph": starmesh.respond_in_numpy,
    "compiled": starmesh.respond_compiled,
    "dense": dense.respond,
}


@dataclass(frozen=True)
class Lanes:
    """Transfer functions (n_lanes, n_out, n_in), the conditioning (n_lanes,) of measured inputs, and lanes in doubt."""

    values: ComplexArray
    conditioning: FloatArray
    doubtful: NDArray[np.bool_]


def transfer_functions(question: Question, kappa: LawStiffness, method: str = "auto") -> Lanes:
    """Outputs over inputs."""
    posed, n_out = question.posed, len(question.outputs)
    found = METHODS[method](posed.problem, kappa)
    with np.errstate(invalid="ignore"):
        readings = _readings(posed, kappa, found.values)
    values, doubtful, conditioning = readings[:, :n_out], found.doubtful, np.ones(kappa.n_lanes)
    if question.is_measured:
        measured = readings[:, n_out:]
        values = _divide(values, measured)
        apart = _independence(measured)
        conditioning = _shares(posed, kappa, found.values, measured).max(axis=2).min(axis=1) * apart
        doubtful = doubtful | ~(apart * LARGE > 1) | ~np.isfinite(values).all(axis=(1, 2))
    return Lanes(values, conditioning, doubtful)


def _readings(posed: Posed, kappa: LawStiffness, solved: ComplexArray) -> ComplexArray:
    """Readings (n_lanes, n_readings, n_exc)."""
    values = np.empty((kappa.n_lanes, len(posed.parts), solved.shape[1]), dtype=complex)
    for number, part in enumerate(posed.parts):
        values[:, number] = part.of(kappa, solved).T
    return values


def _shares(posed: Posed, kappa: LawStiffness, solved: ComplexArray, measured: ComplexArray) -> FloatArray:
    """How large measured inputs (n_lanes, n_in, n_exc) are against the sums of their terms' magnitudes."""
    sizes = np.zeros(measured.shape)
    first = len(posed.parts) - measured.shape[1]
    with np.errstate(all="ignore"):
        for number in range(measured.shape[1]):
            terms = (np.abs(part.of(kappa, solved)).T for part in posed.terms[first + number])
            sizes[:, number] = sum(terms, start=np.abs(posed.applied[first + number]))
        return np.divide(np.abs(measured), sizes, out=np.zeros(sizes.shape), where=sizes > 0)


def _divide(outputs: ComplexArray, measured: ComplexArray) -> ComplexArray:
    """Y_out Y_in^-1 for every lane; inf where the measured inputs do not tell the excitations apart."""
    if measured.shape[1:] == (1, 1):
        with np.errstate(divide="ignore", invalid="ignore"):
            quotient = outputs / measured
        return np.where(measured == 0, np.inf + 0j, quotient)
    result = np.empty((len(outputs), outputs.shape[1], measured.shape[1]), dtype=complex)
    for number, (above, below) in enumerate(zip(outputs, measured, strict=True)):
        try:
            result[number] = np.linalg.solve(below.T, above.T).T
        except np.linalg.LinAlgError:
            result[number] = np.inf
    return result


def _independence(measured: ComplexArray) -> FloatArray:
    """How well several measured inputs tell the excitations apart: 1 at best, 0 not at all."""
    if measured.shape[1] == 1:
        return np.ones(len(measured))
    with np.errstate(divide="ignore", invalid="ignore"):
        normed = measured / np.abs(measured).max(axis=2, keepdims=True)
    normed[~np.isfinite(normed)] = 0.0
    singular = np.linalg.svd(normed, compute_uv=False)
    return np.asarray(singular[:, -1] / np.maximum(singular[:, 0], 1e-300))
