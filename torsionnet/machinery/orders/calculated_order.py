"""Calculated side of a comparison with measured orders: values between speeds, and bounds where phases are unknown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from torsionnet.base.phrases import phrase
from torsionnet.linear.frequency_response import ComplexArray, FloatArray
from torsionnet.machinery.orders.engine_blocks import engine_blocks
from torsionnet.machinery.orders.order_response import OrderResponse
from torsionnet.machinery.orders.worst_response import WorstResponse

LEAST_FOR_SPLINE = 4
"""Number of speeds from which complex values between them are taken from a cubic spline."""


def between_speeds(speeds: FloatArray, values: ComplexArray, at: FloatArray) -> ComplexArray:
    """Complex values in SI at speeds between calculated ones, which rise, by a cubic spline, shape (n,)."""
    if len(speeds) < LEAST_FOR_SPLINE:
        return np.asarray(np.interp(at, speeds, values.real) + 1j * np.interp(at, speeds, values.imag))
    from scipy.interpolate import CubicSpline  # loads much that no other path here needs

    return np.asarray(CubicSpline(speeds, values)(at), dtype=np.complex128)


def largest_amplitudes(response: OrderResponse, lines: Sequence[int], output: int) -> FloatArray | None:
    """Largest amplitude (SI) that some lines of one order can have together, shape (n_speeds,).

    None where all phases are known, so that their sum has one value. Engines at unknown angles add their magnitudes;
    of several cases the largest one counts.
    """
    if isinstance(response, WorstResponse):
        parts = [_added(one, lines, output) for one in response.case_responses]
        parts += [_added(one, lines, output) for one in response.each]
        return np.asarray(np.max([np.abs(response.values[:, lines, output].sum(axis=1)), *parts], axis=0))
    owners = [block for block in engine_blocks(response.lines) if {*block.places} & {*lines}]
    return _added(response, lines, output) if len(owners) > 1 else None


def _added(response: OrderResponse, lines: Sequence[int], output: int) -> FloatArray:
    """Sum over engines at unknown angles of the magnitudes of an order, shape (n_speeds,)."""
    parts = [[at for at in block.places if at in lines] for block in engine_blocks(response.lines)]
    sizes = [np.abs(response.values[:, part, output].sum(axis=1)) for part in parts if part]
    return np.asarray(np.sum(sizes, axis=0))


def bound_note(response: OrderResponse) -> str:
    """Note on why the calculated amplitudes are upper bounds without phases."""
    why = []
    if isinstance(response, WorstResponse):
        cases, engines = len(response.labels), " and ".join(one.engine for one in response.angles)
        if cases > 1 and engines:
            why.append(
                phrase("the worst of {count} cases and the worst angle of {engines}", count=cases, engines=engines)
            )
        elif cases > 1 or engines:
            why.append(
                phrase("the worst angle of {engines}", engines=engines)
                if engines
                else phrase("the worst of {count} cases", count=cases)
            )
        why += (
            [phrase("the worst scatter of {names}", names=", ".join(response.scattered))] if response.scattered else []
        )
    else:
        why += ["every angle between engines of which the model gives none"]
    reason = " and ".join(why) or "all cases"
    return phrase(
        "calculated amplitudes are upper bounds, over {why}, and have no phase: name the case that was "
        "tested, or give the phases between engines, to compare phases",
        why=reason,
    )
