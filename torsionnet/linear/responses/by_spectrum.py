"""Motion over time of drivetrains with frequency-dependent stiffness, by frequency response and torque spectrum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.between_samples import Between, BetweenSamples, Folding
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest
from torsionnet.linear.responses.transfer import responses


def by_spectrum(
    drivetrain: AssembledModel,
    request: TransferRequest,
    torques: FloatArray,
    between: Sequence[Between],
    sampling_rate: float,
) -> FloatArray:
    """Readings (n_out, n) in SI units over time under torques (n_in, n) in N m that are zero before and after.

    The record is followed by as much silence, in which the motion dies away. A hysteretic law is no system that knows
    only the past, so a response begins faintly before its cause.

    Raises
    ------
    UsageError
        The drivetrain is free to turn, or its response has no finite static value.
    """
    count = torques.shape[1]
    size = int(scipy.fft.next_fast_len(2 * count, real=True))
    frequencies: FloatArray = np.asarray(np.fft.rfftfreq(size, 1 / sampling_rate), dtype=np.float64)
    courses = {way: Folding(BetweenSamples(way, sampling_rate), frequencies) for way in between}
    asked = next((course.frequencies for way, course in courses.items() if way != "band_limited"), frequencies)
    H_asked = responses([drivetrain], request, asked, "graph").values[0]
    if not np.isfinite(H_asked).all():
        raise UsageError(
            f"{drivetrain.title} has frequency-dependent laws and no finite static response: lock it to simulate it",
            kind="unsupported-law",
        )
    H = np.array(H_asked[: len(frequencies)])
    # Not band-limited, a course between samples has parts beyond half the rate, which samples fold back.
    for number, way in enumerate(between):
        if way != "band_limited":
            H[:, :, number] = courses[way].folded(H_asked[:, :, number])
    spectra = np.fft.rfft(torques, size, axis=1)
    # At 0 Hz the real part alone makes a real motion.
    H[0] = H[0].real
    motion = np.fft.irfft(np.einsum("foi,if->of", H, spectra), size, axis=1)
    return np.asarray(motion[:, :count])
