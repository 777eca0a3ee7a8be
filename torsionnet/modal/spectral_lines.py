"""The lines of a frequency response as a fit sees them: s, values, weights, and what a mode looks like in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.errors import UsageError
from torsionnet.modal.settings import Settings
from torsionnet.response import Channel, FrequencyResponse

FloatArray: TypeAlias = NDArray[np.float64]
ComplexArray: TypeAlias = NDArray[np.complex128]

ORDERS = {"rad": 0, "rad/s": 1, "rad/s^2": 2}
LEAST_LINES = 4
CERTAIN = 1 - 1e-6


@dataclass(frozen=True, eq=False)
class Lines:
    """What is fitted.

    Attributes
    ----------
    s : (n_f,) complex array
        j omega in rad/s, without 0.
    values : (n_f, n_out, n_in) complex array
    powers : (n_out, n_in) int array
        The transfer function is ``s**power`` times one of the form of a receptance.
    weights : (n_f, n_out, n_in) array
        Inverse of the uncertainty, up to a factor.
    """

    s: ComplexArray
    values: ComplexArray
    powers: NDArray[np.int_]
    weights: FloatArray

    @property
    def balance(self) -> FloatArray:
        """Factor of each pair, (n_out, n_in), that makes unlike quantities comparable."""
        size = np.sqrt(np.mean(np.abs(self.values) ** 2, axis=0))
        return np.asarray(1 / np.where(size > 0, size, 1.0))


def power(output: Channel, input: Channel) -> int:
    """Power of s that leads from the form of a receptance to this transfer function.

    Angles over torques, angles over angles and torque ratios have that form themselves; velocities and accelerations
    have s and s^2 in front. A torque over an angle grows like an acceleration.

    >>> power(Channel("a", "rad/s^2"), Channel("T", "N*m")), power(Channel("T", "N*m"), Channel("a", "rad/s^2"))
    (2, 0)
    """
    for channel in (output, input):
        if channel.unit not in (*ORDERS, "N*m"):
            raise UsageError(f'{channel.name} is in "{channel.unit}"; modes are fitted to {", ".join(ORDERS)} and N*m')
    if input.unit == "N*m":
        return ORDERS.get(output.unit, 0)
    return ORDERS.get(output.unit, 2) - ORDERS[input.unit]


def powers_of(outputs: Sequence[Channel], inputs: Sequence[Channel]) -> NDArray[np.int_]:
    """(n_out, n_in) of :func:`power`."""
    return np.array([[power(output, into) for into in inputs] for output in outputs], dtype=int)


def lines_of(response: FrequencyResponse, settings: Settings) -> Lines:
    """The lines in the band that can be used.

    Raises
    ------
    UsageError
        There are too few, they all hold nothing or have no phase, or coherence is asked for where there is none.
    """
    if not response.has_phase:
        raise UsageError("modes are fitted to complex responses; this one has magnitudes only")
    powers = powers_of(response.outputs, response.inputs)
    low, high = settings.band or (0.0, response.usable_up_to or np.inf)
    chosen = response.between(low, high)
    usable = (chosen.frequencies > 0) & np.isfinite(chosen.values).all(axis=(1, 2))
    if usable.sum() < LEAST_LINES:
        where = "" if settings.band is None and np.isinf(high) else f" from {low:g} to {high:g} Hz"
        raise UsageError(
            f"a fit of modes needs at least {LEAST_LINES} frequencies above 0{where}, there are {usable.sum()}"
        )
    values = chosen.values[usable]
    dead = [
        f"{output.name}/{into.name}"
        for o, output in enumerate(chosen.outputs)
        for i, into in enumerate(chosen.inputs)
        if not values[:, o, i].any()
    ]
    if dead:
        raise UsageError(f"{', '.join(dead)} is zero at every frequency; leave it out")
    coherence = None if chosen.coherence is None else chosen.coherence[usable]
    s = np.asarray(2j * np.pi * chosen.frequencies[usable], dtype=np.complex128)
    return Lines(s, values, powers, _weights(values, coherence, settings))


def left_out(response: FrequencyResponse, band: tuple[float, float] | None) -> tuple[str, ...]:
    """A note where a test says up to where it can be used and no band is given."""
    limit = response.usable_up_to
    if band is not None or limit is None or limit >= response.frequencies[-1]:
        return ()
    return (f"only up to {limit:.4g} Hz, where the test can be used; give a band for more",)


def _weights(values: ComplexArray, coherence: FloatArray | None, settings: Settings) -> FloatArray:
    size = np.abs(values)
    mean = np.sqrt(np.mean(size**2, axis=0))
    if settings.weights == "uniform":
        return np.broadcast_to(1 / mean, size.shape).copy()
    relative = 1 / np.maximum(size, 1e-6 * mean)
    if settings.weights == "relative":
        return np.asarray(relative)
    if coherence is None:
        raise UsageError(
            'weights="coherence" need a coherence, which only an estimate from recordings has; use "uniform"'
        )
    certain = np.clip(coherence, 0, CERTAIN)
    return np.asarray(relative * np.sqrt(certain / (1 - certain)))
