"""Lines of a frequency response for a fit of modes, with values, weights, and powers of s to receptances."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.linear.frequency_response import Channel, FrequencyResponse

# Settings of a fit of modes to frequency responses (method, order, band, residual terms, weights, criteria).

Method: TypeAlias = Literal["auto", "rational", "lscf"]
Residuals: TypeAlias = Literal["both", "lower", "upper", "none"]
Weights: TypeAlias = Literal["uniform", "relative", "coherence"]

DEFAULT_HIGHEST_ORDER = {"auto": 40, "rational": 10, "lscf": 40}
"""Highest order of the polynomials for each method, of which an oscillatory mode takes two."""


@dataclass(frozen=True)
class Criteria:
    """Criteria by which a pole at one order of a stabilisation diagram counts as the same at the next.

    Attributes
    ----------
    frequency, damping : float
        Largest relative change of ``|lambda|`` and of the damping ratio.
    shape : float
        Least MAC of the shapes.
    least_orders : int
        Orders in a row that make a cluster; by default a tenth of the orders of the diagram, at least 4.
    """

    frequency: float = 0.01
    damping: float = 0.05
    shape: float = 0.98
    least_orders: int | None = None

    def __post_init__(self) -> None:
        for name in ("frequency", "damping", "shape"):
            value = getattr(self, name)
            if not (math.isfinite(value) and 0 < value <= 1):
                raise UsageError(
                    f"the criterion for {name} must be a fraction above 0 and up to 1, got {value}", kind="out-of-range"
                )
        if self.least_orders is not None and self.least_orders < 2:
            raise UsageError(
                f"a cluster needs the poles of at least 2 orders, got least_orders={self.least_orders}",
                kind="out-of-range",
            )

    def enough(self, orders: int) -> int:
        """Number of orders in a row over which a pole must stay to be a mode, in a diagram of ``orders`` orders."""
        return max(4, orders // 10) if self.least_orders is None else self.least_orders


@dataclass(frozen=True)
class Settings:
    """Method and options of a fit of modes to frequency responses (order, band, residual terms, weights).

    Attributes
    ----------
    method : {"auto", "rational", "lscf"}
        ``"auto"``: the method with the lower Schwarz criterion (BIC); the rational fraction unless that is clear.
        ``"rational"``: a quotient of polynomials in s = j omega, orthogonal over the lines, solved repeatedly with the
        last denominator as weight; for few modes of any damping, overdamped ones too. ``"lscf"``: least
        squares of complex frequency, polynomials in z = exp(j omega / (2 f_max)); for many modes of light damping.
    highest_order : int, optional
        Order of the polynomials; an oscillatory mode takes two orders, a real pole one. By default 10 or 40, which
        ``auto`` takes for each.
    band : (float, float), optional
        Hz; by default all frequencies above 0 up to where a test says that it can be used.
    residuals : {"both", "lower", "upper", "none"}
        Real terms of the receptance for what is below the band, ``L / s^2``, and above it, ``U``.
    weights : {"uniform", "relative", "coherence"}
        ``"uniform"``: a transfer function is equally uncertain over the band; ``"relative"``: in proportion to its
        size; ``"coherence"``: as its coherence says.
    criteria : Criteria

    Examples
    --------
    >>> Settings("lscf").order
    40
    """

    method: Method = "auto"
    highest_order: int | None = None
    band: tuple[float, float] | None = None
    residuals: Residuals = "both"
    weights: Weights = "uniform"
    criteria: Criteria = field(default_factory=Criteria)

    def __post_init__(self) -> None:
        for name, known in (("method", Method), ("residuals", Residuals), ("weights", Weights)):
            chosen = getattr(self, name)
            if chosen not in get_args(known):
                choices = ", ".join(get_args(known))
                raise UsageError(
                    f'{name} "{chosen}" is not known{did_you_mean(str(chosen), get_args(known))}; choose {choices}',
                    kind="unknown-word",
                )
        if self.order < 1:
            raise UsageError(f"the highest order must be at least 1, got {self.highest_order}", kind="out-of-range")
        if self.band is not None and not 0 <= self.band[0] < self.band[1]:
            raise UsageError(
                f"the band must be from a lower to a higher frequency in Hz, got {self.band}", kind="unordered-rows"
            )

    @property
    def order(self) -> int:
        """Highest order of the polynomials in a fit of modes, as set or the default of the method."""
        return DEFAULT_HIGHEST_ORDER[self.method] if self.highest_order is None else self.highest_order

    @property
    def has_lower(self) -> bool:
        """Whether the fit has a residual term that stands for modes below the band."""
        return self.residuals in ("both", "lower")

    @property
    def has_upper(self) -> bool:
        """Whether the fit has a residual term that stands for modes above the band."""
        return self.residuals in ("both", "upper")


FloatArray: TypeAlias = NDArray[np.float64]
ComplexArray: TypeAlias = NDArray[np.complex128]

ORDERS = {"rad": 0, "rad/s": 1, "rad/s^2": 2}
"""Power of s by which each unit of motion (rad, rad/s, rad/s^2) differs from an angle."""
FEWEST_LINES = 4
"""Fewest lines to which modes are fitted, as one mode with residual terms has as many complex unknowns."""
HIGHEST_COHERENCE = 1 - 1e-6
"""Highest coherence that is assumed for weights, as at 1 the weight of a line would be infinite."""


@dataclass(frozen=True, eq=False)
class Lines:
    """Values and weights (n_f, n_out, n_in) of the lines of all transfer functions, as a fit of modes takes them.

    Attributes
    ----------
    s : (n_f,) complex array
        j omega in rad/s, without 0.
    values : (n_f, n_out, n_in) complex array
    powers : (n_out, n_in) int array
        Each transfer function is ``s**power`` times a receptance.
    weights : (n_f, n_out, n_in) array
        Inverse of the uncertainty, up to a factor.
    drive : (n_f,) complex array, optional
        Spectrum of the input of a record: values are then spectra of the outputs, ``s**power`` times a receptance times
        this, plus the transients of a record that neither begins nor ends at rest.
    """

    s: ComplexArray
    values: ComplexArray
    powers: NDArray[np.int_]
    weights: FloatArray
    drive: ComplexArray | None = None

    @property
    def balance(self) -> FloatArray:
        """Inverse RMS of each transfer function over its lines, (n_out, n_in), which makes quantities comparable."""
        size = np.sqrt(np.mean(np.abs(self.values) ** 2, axis=0))
        return np.asarray(1 / np.where(size > 0, size, 1.0))


def power_over_receptance(output: Channel, input: Channel) -> int:
    """Power of s by which a transfer function between these two channels differs from a receptance.

    Angles over torques, angles over angles and torque ratios have that form themselves; velocities and accelerations
    have s and s^2 in front. A torque over an angle grows like an acceleration.

    >>> angle, torque = Channel("a", "rad/s^2"), Channel("T", "N*m")
    >>> power_over_receptance(angle, torque), power_over_receptance(torque, angle)
    (2, 0)
    """
    for channel in (output, input):
        if channel.unit not in (*ORDERS, "N*m"):
            raise UsageError(
                f'{channel.name} is in "{channel.unit}"; modes are fitted to {", ".join(ORDERS)} and N*m',
                kind="wrong-unit",
            )
    if input.unit == "N*m":
        return ORDERS.get(output.unit, 0)
    return ORDERS.get(output.unit, 2) - ORDERS[input.unit]


def powers_of(outputs: Sequence[Channel], inputs: Sequence[Channel]) -> NDArray[np.int_]:
    """Power of s by which each transfer function differs from a receptance, (n_out, n_in); see :func:`power`."""
    return np.array([[power_over_receptance(output, into) for into in inputs] for output in outputs], dtype=int)


def lines_of(response: FrequencyResponse, settings: Settings) -> Lines:
    """Lines of a response that a fit of modes uses, in the band, above 0 Hz, finite, with weights.

    Raises
    ------
    UsageError
        Too few lines, a response that is zero or has no phase, or weights by a coherence that is not there.
    """
    if not response.has_phase:
        raise UsageError(
            "modes are fitted to complex responses; this response has magnitudes only, give its phases too",
            kind="missing-data",
        )
    powers = powers_of(response.outputs, response.inputs)
    low, high = settings.band or (0.0, response.usable_up_to or np.inf)
    chosen = response.between(low, high)
    usable = (chosen.frequencies > 0) & np.isfinite(chosen.values).all(axis=(1, 2))
    if usable.sum() < FEWEST_LINES:
        where = "" if settings.band is None and np.isinf(high) else f" from {low:g} to {high:g} Hz"
        raise UsageError(
            f"a fit of modes needs at least {FEWEST_LINES} frequencies above 0{where}, there are {usable.sum()}; "
            "use finer lines or a wider band",
            kind="too-short",
        )
    values = chosen.values[usable]
    dead = [
        f"{output.name}/{into.name}"
        for o, output in enumerate(chosen.outputs)
        for i, into in enumerate(chosen.inputs)
        if not values[:, o, i].any()
    ]
    if dead:
        raise UsageError(f"{', '.join(dead)} is zero at every frequency; leave it out", kind="needless-entry")
    coherence = None if chosen.coherence is None else chosen.coherence[usable]
    s = np.asarray(2j * np.pi * chosen.frequencies[usable], dtype=np.complex128)
    return Lines(s, values, powers, _weights(values, coherence, settings))


def band_notes(response: FrequencyResponse, band: tuple[float, float] | None) -> tuple[str, ...]:
    """Note that a test is usable only up to some frequency (Hz), where no band is given; otherwise no note."""
    limit = response.usable_up_to
    if band is not None or limit is None or limit >= response.frequencies[-1]:
        return ()
    return (f"only up to {limit:.4g} Hz, where the test can be used; give a band for more",)


def _weights(values: ComplexArray, coherence: FloatArray | None, settings: Settings) -> FloatArray:
    size = np.abs(values)
    mean = np.sqrt(np.mean(size**2, axis=0))
    if settings.weights == "uniform":
        return np.broadcast_to(1 / mean, size.shape).copy()
    # An antiresonance must not have all the weight.
    relative = 1 / np.maximum(size, 1e-6 * mean)
    if settings.weights == "relative":
        return np.asarray(relative)
    if coherence is None:
        raise UsageError(
            'weights="coherence" need a coherence, which only an estimate from recordings has; use "uniform"',
            kind="missing-data",
        )
    # The variance of a line is in proportion to |H|^2 (1 - coherence)/coherence.
    certain = np.clip(coherence, 0, HIGHEST_COHERENCE)
    return np.asarray(relative * np.sqrt(certain / (1 - certain)))
