"""The same-estimator route for responses that remember the record they were estimated from."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.identification.residuals.instrument import Instrument
from torsionnet.identification.residuals.memory import MOST, demand
from torsionnet.identification.residuals.operator import WindowedEstimate, windowed_estimate
from torsionnet.identification.residuals.steps import SensorSteps
from torsionnet.response import FrequencyResponse
from torsionnet.signals.welch import Welch


def remembered_estimate(
    chosen: FrequencyResponse,
) -> tuple[WindowedEstimate, NDArray[np.bool_], SensorSteps] | None:
    """How lines of one pair follow from a transfer function, which of them are compared, and the sensor's steps.

    None without a record, where it was not swept (an average over a stationary input is smoothed alike wherever the
    record begins), for estimators that are not linear in the transfer function, and for records that would take too
    much memory.
    """
    origin, f = chosen.estimation, chosen.frequencies
    output, driven = chosen.outputs[0].name, chosen.inputs[0].name
    if origin is None or origin.record is None or not origin.swept:
        return None
    signal = {("H1", 0): driven, ("H2", 0): output, ("Hr", 1): "".join(origin.references)}.get(
        (origin.estimator, len(origin.references)), ""
    )
    if not {output, driven, signal} <= set(origin.record.names):
        return None
    instrument = Instrument(origin.estimator, signal, plain=True)
    detrend: Any = origin.detrend
    settings, band = Welch(origin.window, origin.seconds, origin.overlap, detrend), (float(f[0]), float(f[-1]))
    if demand(origin.record, settings, band).most > MOST:
        return None
    windowed = windowed_estimate(origin.record, output, driven, settings, band, instrument=instrument)
    kept = np.asarray(np.isclose(windowed.frequencies[:, None], f, rtol=1e-9).any(axis=1), dtype=np.bool_)
    if np.count_nonzero(kept) != len(f):
        return None
    return windowed, kept, SensorSteps(origin.steps.get(output, 0.0), origin.decimation)
