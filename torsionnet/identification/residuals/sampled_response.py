"""Response of the model from the samples of a torque to those of a motion, as a fit compares it with measured ones.

Where a measured torque is the input, its samples and those of the motion follow from the same torque that drives, and
each has images of its own above half the sampling rate: their responses are folded before one is divided by the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.between_samples import BetweenSamples, Folding
from torsionnet.linear.sensitivity import Evaluation, ParametricResponse


@dataclass(frozen=True, eq=False)
class SampledResponse:
    """Transfer function between samples as a function of parameters, with exact derivatives, over that of ``divisor``.

    Attributes
    ----------
    plain : ParametricResponse
        The same in continuous time.
    folded : ParametricResponse
        From what drives to output and measured input, at the frequencies of all images.
    folding : Folding
    divisor : (n_f,) complex array
        What the test was divided by already, without unit.
    """

    plain: ParametricResponse
    folded: ParametricResponse
    folding: Folding
    divisor: ComplexArray

    @property
    def drivetrain(self) -> AssembledModel:
        return self.plain.drivetrain

    @property
    def names(self) -> tuple[str, ...]:
        return self.plain.names

    @property
    def start(self) -> FloatArray:
        return self.plain.start

    @property
    def frequencies(self) -> FloatArray:
        return self.plain.frequencies

    @property
    def unit(self) -> str:
        return self.plain.unit

    def at(self, values: Sequence[float] | FloatArray) -> Evaluation:
        """Transfer function and derivatives between samples, in SI units, for these parameter values (n_p,)."""
        found = self.folded.at(values)
        G, slopes = self.folding.folded(found.values), self.folding.folded(found.jacobian)
        if self.plain.request.is_measured:
            torque = G[:, 1:]
            G = G[:, :1] / torque
            slopes = (slopes[:, :1] - G[..., None] * slopes[:, 1:]) / torque[..., None]
        scale = self.divisor[:, None, None]
        return Evaluation(G / scale, slopes / scale[..., None])


def between_samples(
    response: ParametricResponse, course: BetweenSamples | None, stated: BetweenSamples | None
) -> ParametricResponse | SampledResponse:
    """Response of one output to one input between samples of that course; the plain one where it is band-limited.

    ``stated`` is the course for which a measured response was corrected when it was estimated.
    """
    lines = response.frequencies
    if course is None or (course.is_band_limited and (stated is None or stated.is_band_limited)):
        return response
    folding, request = Folding(course, lines), response.request
    if request.is_measured:
        every = (*request.outputs, *request.measured)
        request = replace(request, outputs=every, measured=(), is_measured=False)
    driven = replace(response, request=request, frequencies=folding.frequencies, _known=[])
    divisor = np.ones(len(lines), dtype=complex) if stated is None else stated.share(lines)
    return SampledResponse(response, driven, folding, divisor)
