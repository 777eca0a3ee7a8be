"""Weighted residuals of the first harmonics at the steps of a sine test at several amplitudes."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.identification.orders.parametric_orders import parameters_of_drivetrain
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.identification.residuals.noise import Noise, noise_between_lines
from torsionnet.identification.residuals.response_blocks import ResponseBlock
from torsionnet.identification.residuals.sampled_response import Form, parts
from torsionnet.identification.residuals.stepped_curve import SteppedCurve, stepped_curve
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.signals.stepped_levels import HARMONICS, SteppedStiffness

SAME_LEVEL = 0.1
"""Share by which the torque amplitudes, or else the twists, of the steps of one level differ at most."""


@dataclass(eq=False)
class SteppedBlock(ResponseBlock):
    """Residuals of output over torque at each step, in the order of the test.

    Attributes
    ----------
    steps : SteppedStiffness
        Those compared.
    """

    has_equations: ClassVar[bool] = True

    steps: SteppedStiffness = field(kw_only=True)

    @property
    def curve_of_steps(self) -> SteppedCurve:
        """First harmonic of the model at the steps."""
        assert isinstance(self.response, SteppedCurve)
        return self.response

    @property
    def swings(self) -> FloatArray:
        """Amplitudes in rad of the twist at the steps."""
        return np.abs(self.steps.twists)

    @property
    def typical(self) -> tuple[float, float, float]:
        """Torque in N m, twist in rad and stiffness in N m/rad that are typical of the test."""
        return float(np.median(np.abs(self.steps.torques))), float(np.median(self.swings)), self.curve_of_steps.spring

    @property
    def runs(self) -> tuple[slice, ...]:
        """Slices of the steps of each level, along which frequency or amplitude goes one way."""
        levels, f = np.abs(self.steps.torques), self.frequencies
        ends, way = [0], 0.0
        for place in range(1, len(f)):
            sense = float(np.sign(f[place] - f[place - 1]))
            jumps = abs(levels[place] / levels[place - 1] - 1) > SAME_LEVEL and sense != 0
            if jumps or way * sense < 0:
                ends.append(place)
                # Back to the first frequency of the next level tells nothing of its way; a turn does.
                way = 0.0 if jumps else sense
            else:
                way = sense or way
        return tuple(slice(a, b) for a, b in zip(ends, [*ends[1:], len(f)], strict=True))

    @property
    def description(self) -> str:
        return f"{len(self.frequencies)} steps of {len(self.runs)} level{'s' * (len(self.runs) > 1)}"

    def measured_noise(self, values: FloatArray) -> Noise | None:
        if self.measurement.error is not None:
            return super().measured_noise(values)
        residual, _ = self.residuals(values)
        count = len(self.frequencies)
        lines = residual if self.parts == 1 else residual[:count] + 1j * residual[count:]
        by_run = [noise_between_lines(lines[run], np.eye(run.stop - run.start)) for run in self.runs]
        if any(noise is None for noise in by_run):
            return None
        known = [noise for noise in by_run if noise is not None]
        return Noise(np.concatenate([noise.ratio for noise in known]), sum(noise.certainty for noise in known))

    def equations(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Equations of motion missed at the motion measured, and their deviations by noise."""
        missed, moves = self.curve_of_steps.unbalanced(values[: len(self.response.names)])
        return parts(missed), np.tile(moves * np.sqrt(self.noise), 2)

    def take_harmonics(self, values: FloatArray) -> None:
        """Compare the first harmonic as all harmonics make it at values of the unknowns, no longer by itself."""
        self.response = self.curve_of_steps.with_harmonics(values[: len(self.response.names)])

    @property
    def has_harmonics(self) -> bool:
        """Whether harmonics of the twist are in the first one of the model."""
        return self.curve_of_steps.shape is not None or bool(np.any(self.curve_of_steps.beyond))

    def with_model(self, rig: AssembledModel, measurement: Measurement, parameters: tuple[str, ...]) -> SteppedBlock:
        block = copy(self)
        block.measurement = measurement
        block.response = replace(_curve(rig, measurement, self.steps, parameters), beyond=self.curve_of_steps.beyond)
        return block


def stepped_block(
    rig: AssembledModel, measurement: Measurement, data: SteppedStiffness, parameters: tuple[str, ...], form: Form
) -> SteppedBlock:
    """Weighted residuals between a model with a law of motion and the steps of a sine test, ready for a fit.

    Raises
    ------
    UsageError
        Names or a law of motion that the model lacks, or no step in the band.
    """
    lost = ~np.isfinite(data.twists * data.torques)
    if lost.any():
        text = f"{measurement.label} has steps whose twist or torque is no number, at {data.frequencies[lost][0]:g} Hz"
        raise UsageError(f"{text} first; leave them out", kind="not-finite")
    low, high = measurement.band or (0.0, np.inf)
    # Where nothing moves, or nothing drives, there is no receptance.
    kept = (data.frequencies >= low) & (data.frequencies <= high) & (np.abs(data.torques) > 0)
    kept &= np.abs(data.twists) > 0
    for start, stop in measurement.excluded:
        kept &= (data.frequencies < start) | (data.frequencies > stop)
    if not kept.any():
        text = f"has no step to compare; it has steps from {data.frequencies.min():g} to {data.frequencies.max():g} Hz"
        raise UsageError(f"{measurement.label} {text}", kind="missing-data")
    arrays = ("frequencies", "twists", "torques", "mean_twists", "mean_torques", "distortion")
    steps = replace(data, **{name: getattr(data, name)[kept] for name in arrays})
    if data.harmonics is not None:
        steps = replace(steps, harmonics=data.harmonics[kept])
    names = parameters_of_drivetrain(rig, parameters)
    try:
        response = _curve(rig, measurement, steps, names)
    except UsageError as error:
        raise UsageError(f"{measurement.label}: {error}", kind=error.kind) from None
    lines = FrequencyResponse(
        steps.frequencies,
        _measured(steps)[:, None, None],
        (Channel(measurement.output, "rad"),),
        (Channel(measurement.input, "N*m"),),
    )
    return SteppedBlock(measurement, response, lines, None, form=form, steps=steps)


def _measured(steps: SteppedStiffness) -> ComplexArray:
    return np.asarray(steps.twists / steps.torques)


def _curve(
    rig: AssembledModel, measurement: Measurement, steps: SteppedStiffness, parameters: tuple[str, ...]
) -> SteppedCurve:
    output, into = measurement.model_output or measurement.output, measurement.model_input or measurement.input
    each = (steps.frequencies, np.abs(steps.torques), steps.mean_twists, steps.mean_torques, _measured(steps))
    shape = None
    if steps.harmonics is not None:
        # By the phase of the first one, gamma = a cos(phi) + Re sum s_m exp(j m phi).
        orders, first = np.arange(2, HARMONICS + 1), np.abs(steps.twists)[:, None]
        shape = steps.harmonics / first * (steps.twists[:, None] / first).conj() ** orders
    return stepped_curve(rig, output, into, measurement.excitation, parameters, each, shape)
