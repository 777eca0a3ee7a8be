"""Sampled torques of a simulation with their course between samples, and their values at any place there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.between_samples import Between, check_between
from torsionnet.linear.dynamic_stiffness.triangular import DiagonalBlock
from torsionnet.machinery.passage.exponential_steps import gauss_points, step_weights
from torsionnet.signals.recording import Signal

BEYOND = 256
"""Most samples by which a band-limited torque goes on beyond its ends, reflected about them, and fades out: what it is
there no longer matters between the samples."""
GAUSS_POINTS = 12
"""Gauss points of a sampling interval, which hold half a period, the shortest of a band-limited torque, to rounding."""


@dataclass(frozen=True, eq=False)
class TorqueCourses:
    """Sampled torques (n_in, n) in N m, each with its course between samples."""

    samples: FloatArray
    between: tuple[Between, ...]

    def within(self, places: FloatArray) -> FloatArray:
        """Values (n_in, n - 1, n_places) in N m at places from 0 to 1 in every interval; a step counts after it."""
        first, last = self.samples[:, :-1, None], self.samples[:, 1:, None]
        found = np.repeat(first, len(places), axis=2)
        for number, way in enumerate(self.between):
            if way == "straight":
                found[number] = first[number] * (1 - places) + last[number] * places  # exact at both ends
            elif way == "band_limited":
                found[number] = _band_limited(self.samples[number], places)
        return found

    def gains(self, block: DiagonalBlock, h: float) -> tuple[ComplexArray, ComplexArray]:
        """Matrix exp(T h) of a block of states, and what the torques add to its states in steps of h seconds.

        The shapes are (n_x, n_x) and (n_x, n - 1). Gauss's rule would be exact for straight lines, too; their own
        matrices cost less.
        """
        if "band_limited" in self.between:
            diagonal = block.is_diagonal
            step, weights = step_weights(block.T, h, GAUSS_POINTS, diagonal=diagonal)
            pushed = np.tensordot(block.B, self.within(gauss_points(GAUSS_POINTS)), axes=1)
            added = np.einsum("jk,knj->kn" if diagonal else "jkl,lnj->kn", weights, pushed)
            return (np.diag(step) if diagonal else step), added
        step, before, after = first_order_hold(block.T, block.B, h)
        ends = self.within(np.array([0.0, 1.0]))
        return step, before @ ends[:, :, 0] + after @ ends[:, :, 1]


def torque_courses(
    inputs: Mapping[str, ArrayLike | Signal], between: str | Mapping[str, str] | None = None
) -> TorqueCourses:
    """Sampled torques of a simulation from lists or signals by input, in N m, with their courses between samples.

    Signals run as they say, lists straight, unless ``between`` says otherwise, for all inputs or by name.

    Raises
    ------
    UsageError
        They are no finite numbers, or of unlike lengths; unknown courses or names.
    """
    asked = between if isinstance(between, Mapping) else dict.fromkeys(inputs, between)
    for name in asked:
        if name not in inputs:
            hint = f"{did_you_mean(name, inputs)}; the torques are {', '.join(inputs)}"
            raise UsageError(f'between= names "{name}", which is no torque that acts{hint}')
    ways = tuple(check_between(asked.get(name) or _own_course(one)) for name, one in inputs.items())
    listed = [one.values if isinstance(one, Signal) else one for one in inputs.values()]
    try:
        torques = np.array([np.asarray(values, dtype=float) for values in listed])
    except (TypeError, ValueError):
        torques = np.array(np.nan)
    if torques.ndim != 2 or not torques.size or not np.isfinite(torques).all():
        raise UsageError("the torques of a simulation are lists of finite numbers in N m by input, all of one length")
    return TorqueCourses(torques, ways)


def _own_course(torque: ArrayLike | Signal) -> Between:
    """Course of a list, or of a signal: one brought to another rate is what the filter has left, which is smooth."""
    if not isinstance(torque, Signal):
        return "straight"
    return "band_limited" if torque.course_rate else torque.between


def _band_limited(values: FloatArray, places: FloatArray) -> FloatArray:
    """Values (n - 1, n_places) of a band-limited signal (n,) at places from 0 to 1 in every interval, in its unit."""
    n = len(values)
    beyond = min(n - 1, BEYOND)
    if not beyond:
        return np.zeros((0, len(places)))
    wide = np.pad(values, beyond, mode="reflect", reflect_type="odd")
    fading = np.sin(np.pi / 2 * np.arange(1, beyond + 1) / (beyond + 1)) ** 2
    wide[:beyond] *= fading
    wide[-beyond:] *= fading[::-1]
    size = int(scipy.fft.next_fast_len(len(wide), real=True))
    spectrum, turns = np.fft.rfft(wide, size), 2j * np.pi * np.fft.rfftfreq(size)
    shifted = [np.fft.irfft(spectrum * np.exp(turns * place), size)[beyond : beyond + n - 1] for place in places]
    return np.stack(shifted, axis=1)


def first_order_hold(
    A: FloatArray | ComplexArray, B: FloatArray | ComplexArray, h: float
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Matrices exp(A h), G_0 and G_1 by which a state steps on by h seconds, under torques linear in between."""
    n, n_in = B.shape
    whole = np.zeros((n + 2 * n_in, n + 2 * n_in), dtype=complex)
    whole[:n, :n], whole[:n, n : n + n_in] = A * h, B * h
    whole[n : n + n_in, n + n_in :] = np.eye(n_in)
    power = np.asarray(scipy.linalg.expm(whole), dtype=np.complex128)
    after = power[:n, n + n_in :]
    return power[:n, :n], power[:n, n : n + n_in] - after, after
