"""Torques and scales of a simulation from what a caller gives: lists at samples, or histories and a duration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.motion.driving import Driving
from torsionnet.motion.scenarios.time_history import SAMPLE_SLACK, TimeHistory
from torsionnet.motion.smooth_laws import Scale
from torsionnet.motion.torque_courses import torque_courses
from torsionnet.signals.recording import Signal, is_rate

Torque: TypeAlias = ArrayLike | Signal | TimeHistory

MOST_SAMPLES = 20_000_000
"""Most samples of a duration, some hundred MB for each output."""


def require_request(inputs: Mapping[str, Torque], rate: float, duration: float | None) -> None:
    """Require a rate in Hz and, if given, a duration in s that fit each other and the lists of torques.

    Raises
    ------
    UsageError
        No rate or duration, too many samples, or lists of another length.
    """
    if not (isinstance(rate, int | float | np.number) and is_rate(float(rate))):
        raise UsageError(f"the sampling rate must be a positive number of Hz, got {rate}")
    if duration is None:
        return
    if not (isinstance(duration, int | float | np.number) and math.isfinite(duration) and duration >= 0):
        raise UsageError(f"the duration must be a number of seconds that is not below zero, got {duration}")
    if duration * rate > MOST_SAMPLES:
        text = f"{duration:g} s at {rate:g} Hz are more than {MOST_SAMPLES} samples"
        raise UsageError(f"{text}; give a lower rate or a shorter duration")
    listed = [one.values if isinstance(one, Signal) else one for one in inputs.values()]
    lengths = {len(np.atleast_1d(one)) for one in listed if not isinstance(one, TimeHistory)}
    _one_length({*lengths, sample_count(duration, rate)})


def sample_count(duration: float, rate: float) -> int:
    """Number of samples at a rate in Hz within a duration in s, with those at its beginning and at its end."""
    return int(np.floor(duration * rate + SAMPLE_SLACK)) + 1


def driving_of(
    inputs: Mapping[str, Torque], rate: float, duration: float | None, scales: Mapping[Scale, TimeHistory]
) -> tuple[Driving, FloatArray]:
    """Torques and scales over time, and the torques (n_in, n) at the samples.

    Raises
    ------
    UsageError
        Unlike lengths, numbers that are not finite, or histories without a duration.
    """
    listed = {name: one for name, one in inputs.items() if not isinstance(one, TimeHistory)}
    arrays = dict(zip(listed, torque_courses(listed).samples, strict=True)) if listed or not inputs else {}
    lengths = {len(one) for one in arrays.values()}
    if duration is not None:
        lengths.add(sample_count(duration, rate))
    n = _one_length(lengths)
    entries = [arrays.get(name, one) for name, one in inputs.items()]
    driving = Driving((*entries, *scales.values()), rate, n)
    torques = np.array([one.samples(rate, n) if isinstance(one, TimeHistory) else one for one in entries])
    if not np.isfinite(torques).all():
        raise UsageError("the torques of a simulation are finite numbers in N m")
    return driving, torques


def _one_length(lengths: set[int]) -> int:
    if not lengths:
        raise UsageError("torques as histories have no end: give the duration in s")
    if len(lengths) > 1:
        text = " and ".join(map(str, sorted(lengths)))
        raise UsageError(f"the torques have {text} samples; give lists of one length, that of the duration")
    (n,) = lengths
    return n
