"""Tests that the explore page lays over what it calculates: responses with their misfit, and measured orders."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.app.explore.state import State
from torsionnet.base.conventions import Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import DERIVATIVE_ORDERS, Channel, FloatArray, FrequencyResponse
from torsionnet.machinery.orders.order_response import OrderResponse

if TYPE_CHECKING:
    from torsionnet.signals.orders.tracked_orders import MeasuredOrder


# Measured response that the explore page lays over the calculated one, and the misfit between both.

MOST_LINES = 4000
"""Largest number of measured frequencies that are drawn and compared; a screen has fewer columns of pixels."""


def matching_response(overlay: FrequencyResponse | None, state: State) -> FrequencyResponse | None:
    """Measured response of the output and input shown, in the quantity shown; None if the test holds no such pair."""
    if overlay is None:
        return None
    try:
        pair = overlay.select(state.output, state.input)
    except UsageError:
        return None
    is_motion = pair.outputs[0].unit in DERIVATIVE_ORDERS
    pair = getattr(pair, state.quantity)() if state.quantity and is_motion else pair
    return pair.between(np.nextafter(0, 1), np.inf)


def overlay_data(overlay: FrequencyResponse | None, state: State) -> dict[str, Any] | None:
    """Measured frequencies in Hz, magnitude in SI, phase in degrees and trust, at most :data:`MOST_LINES` of each."""
    pair = matching_response(overlay, state)
    if pair is None:
        return None
    step = -(-len(pair.frequencies) // MOST_LINES) or 1
    values, kept = pair.values[::step, 0, 0], slice(None, None, step)
    good = np.isfinite(values) & (values != 0)
    return {
        "frequencies": pair.frequencies[kept][good].tolist(),
        "magnitude": np.abs(values[good]).tolist(),
        "phase": np.degrees(np.angle(values[good])).tolist(),
        "trusted": _trusted(pair)[kept][good].tolist(),
        "unit": pair.unit(),
        "notes": list(map(str, pair.notes)),
    }


def _trusted(pair: FrequencyResponse) -> FloatArray:
    from torsionnet.signals.advice import LEAST_COHERENCE  # loads what a page without a test can do without

    good = np.ones(len(pair.frequencies), dtype=bool)
    if pair.coherence is not None:
        good &= pair.coherence[:, 0, 0] >= LEAST_COHERENCE
    if pair.usable_up_to is not None:
        good &= pair.frequencies <= pair.usable_up_to
    return np.asarray(good)


def misfit(
    overlay: FrequencyResponse | None,
    state: State,
    respond: Callable[[FloatArray], FrequencyResponse],
    band: tuple[float, float],
) -> dict[str, Any] | None:
    """RMS difference in dB and degrees and the FRAC over the trusted lines of a test in the band.

    None where there is no test of this response, or no line that can be trusted.
    """
    pair = matching_response(overlay, state)
    if pair is None:
        return None
    from torsionnet.signals.comparison import difference, frac

    values = pair.values[:, 0, 0]
    good = _trusted(pair).astype(bool) & np.isfinite(values) & (values != 0)
    good &= (pair.frequencies >= band[0]) & (pair.frequencies <= band[1])
    lines = np.flatnonzero(good)
    lines = lines[:: -(-len(lines) // MOST_LINES) or 1]
    if not lines.size:
        return None
    test = FrequencyResponse(pair.frequencies[lines], pair.values[lines], pair.outputs, pair.inputs)
    model = respond(test.frequencies)
    if test.unit() != model.unit():
        return None
    apart = difference(test, model)
    return {
        "decibels": float(np.sqrt(np.mean(apart.decibels**2))),
        "degrees": float(np.sqrt(np.mean(apart.degrees**2))),
        "frac": float(frac(test, model)[0, 0]),
        "lines": int(lines.size),
    }


# Numbers and units as the explore page shows them.

CONVENTIONS_BY_ANGLE = {angle: Conventions(angle=angle) for angle in ("rad", "deg")}
"""Conventions by the unit of angles that is chosen on the page."""


def json_numbers(values: NDArray[np.float64]) -> list[float | None]:
    """List of numbers for JSON, with None for nan and inf, which JSON lacks."""
    if np.isfinite(values).all():
        return list(values.tolist())
    return [float(value) if np.isfinite(value) else None for value in values]


# Measured orders of a test that the explore page draws over the calculated ones while parameters slide.

MOST_DOTS = 1000
"""Largest number of measured speeds drawn of an order; a screen has about as many columns of pixels."""


def orders_of_test(path: str | os.PathLike[str] | None, output: Channel) -> tuple[MeasuredOrder, ...]:
    """Measured orders (SI) of an output in a file; empty without a file, or where it holds no such output."""
    if path is None:
        return ()
    from torsionnet.io.tracked_order_tables import read_orders  # loads what a page without a test can do without

    try:
        return read_orders(path, output)
    except UsageError:
        return ()


def tested_orders(run: OrderResponse, measured: Sequence[MeasuredOrder], most: int) -> list[dict[str, Any]]:
    """Measured orders as JSON data, amplitudes and half widths in SI over rpm, with the calculated curve and a verdict.

    Those of largest measured amplitude, at most ``most``; empty where none of them is calculated.
    """
    if not measured:
        return []
    from torsionnet.machinery.orders.order_comparison import (
        NO_INTERVAL,
        compared_orders,
    )  # loads what a page without a test does without

    try:
        pairs = compared_orders(run, None, measured)
    except UsageError:
        return []
    largest = sorted(pairs, key=lambda one: -float(one.measured.amplitude.max()))[:most]
    found = []
    for one in largest:
        step = -(-len(one.measured.speeds) // MOST_DOTS)
        agreement, widths = one.agreement, one.pair.half_widths
        known = agreement.verdict != NO_INTERVAL and agreement.sentence
        phase = "" if agreement.phase_rms is None else f", phase {agreement.phase_rms:.3g}° RMS"
        apart = f"amplitude {agreement.peak:+.3g} %{phase}"
        found.append({
            "name": f"order {one.measured.order:g}",
            "curve": json_numbers(one.curve),
            "rpm": json_numbers(one.measured.speeds[::step] * RPM),
            "magnitude": json_numbers(one.measured.amplitude[::step]),
            "half_widths": None if widths is None else json_numbers(np.asarray(widths[::step])),
            "verdict": f"{agreement.verdict}: {apart}" + (f"; {agreement.sentence}" if known else ""),
        })  # fmt: skip
    return found
