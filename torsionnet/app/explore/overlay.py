"""Measured response that the explore page lays over the calculated one, and the misfit between both."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from torsionnet.app.explore.state import State
from torsionnet.base.errors import UsageError
from torsionnet.linear.frequency_response import DERIVATIVE_ORDERS, FloatArray, FrequencyResponse

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
