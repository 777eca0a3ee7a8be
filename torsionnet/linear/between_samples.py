"""Course of a sampled torque between its samples, and what that does to responses between samples.

A torque with samples u_n at the rate F has the spectrum S(f) U(f), where U is that of the samples, repeated about every
multiple of F, x = f/F, and

    held:          S = sinc(x) exp(-j pi x)    the value of a sample holds until the next one
    straight:      S = sinc(x)^2               straight lines join the samples
    band_limited:  S = 1 up to F/2             nothing above half the rate

A motion is sampled as well, so that images of a response G(f) fold onto each other. The response from the samples of
the torque to those of the motion is the sum of S(f + k F) G(f + k F) over all whole k; with m = 1 where the torque is
held and m = 2 where it is straight, S(f + k F) = s(x)/(pi (x + k))^m, whose numerator is the same for all k.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError, did_you_mean

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Between: TypeAlias = Literal["held", "straight", "band_limited"]
WAYS: tuple[Between, ...] = get_args(Between)
"""Courses that a signal may have between its samples."""
NOTED_EFFECT = 0.01
"""Share of a response's magnitude by which the course between samples must matter for a note on it."""
NEAR_IMAGES, FAR_IMAGES = (1, 2, 256), (3, 24, 32)
"""First and last image to either side whose values are calculated, and the number of frequencies at which they are.

Between these they are interpolated: far images vary little over half a sampling rate."""
ASYMPTOTE_RATES = (100.0, 200.0)
"""Multiples of the sampling rate at which the asymptote of a response is taken, for all images further off."""


def check_between(between: str) -> Between:
    """Course between samples unchanged if it is known (held, straight, band_limited), else an error is raised."""
    for known in WAYS:
        if between == known:
            return known
    hint = did_you_mean(str(between), WAYS)
    raise UsageError(
        f"between its samples a signal is {', '.join(WAYS[:-1])} or {WAYS[-1]}, not {between!r}{hint}",
        kind="unknown-word",
    )


@dataclass(frozen=True)
class BetweenSamples:
    """Course of a signal between samples at a rate in Hz.

    Examples
    --------
    >>> BetweenSamples("straight", 200.0).share(np.array([30.0])).real.round(4).tolist()
    [0.9281]
    """

    between: Between
    rate: float

    @property
    def is_band_limited(self) -> bool:
        """Whether there is nothing above half the rate, so that samples say all."""
        return self.between == "band_limited"

    def share(self, frequencies: FloatArray) -> ComplexArray:
        """Spectrum of the signal over that of its samples at frequencies in Hz, (n_f,), complex, without unit."""
        x = np.asarray(frequencies, dtype=float) / self.rate
        held, straight = np.sinc(x) * np.exp(-1j * np.pi * x), np.sinc(x) ** 2 + 0j
        # A signal brought to a higher rate has nothing above half of its own.
        way = {"held": held, "straight": straight, "band_limited": np.ones_like(held)}[self.between]
        return np.where(x <= 0.5, way, 1.0)

    def lowering(self, frequency: float) -> float:
        """Share by which the magnitude of a response from the samples is too low at a frequency in Hz."""
        return float(1 - np.abs(self.share(np.array([frequency])))[0])


@dataclass(frozen=True, eq=False)
class _Weights:
    """Factors of the terms of a response between samples at the lines up to half the rate.

    Attributes
    ----------
    images : tuple of (n_nodes, n_images, 1) array
        1/(pi (x + k))^m of near and of far images.
    negative : tuple of (n_nodes, n_images, 1) array
        Whether an image is of a negative frequency.
    far : tuple of (n, 1) array
        Sums over all images further off, for each term of the asymptote.
    share, numerator : (n, 1) array
        S(x) and s(x).
    step : (n, 1) array or None
        Share of twice the constant of the asymptote that is read after a step, where the torque is held.
    """

    images: tuple[FloatArray, ...]
    negative: tuple[NDArray[np.bool_], ...]
    far: tuple[FloatArray, ...]
    share: ComplexArray
    numerator: NDArray[Any]
    step: ComplexArray | None


@dataclass(frozen=True, eq=False)
class Folding:
    """Map from a response in continuous time, (n_f, ...), to that between samples, (n_lines, ...).

    ``lines`` are frequencies in Hz; those above half the rate stay as they are.

    Examples
    --------
    Torques on an inertia of 1 kg m^2 that are held for 1 s move it by (z + 1)/(2 (z - 1)^2) rad/(N m).

    >>> folding = Folding(BetweenSamples("held", 1.0), np.array([0.1, 0.3]))
    >>> sampled = folding.folded(-1 / (2 * np.pi * folding.frequencies) ** 2)
    >>> z = np.exp(2j * np.pi * folding.lines)
    >>> bool(np.allclose(sampled, (z + 1) / 2 / (z - 1) ** 2, rtol=1e-6))
    True
    """

    course: BetweenSamples
    lines: FloatArray

    @cached_property
    def _below(self) -> NDArray[np.bool_]:
        """Mask (n_lines,) of the lines up to half the rate; a signal brought to a higher one has nothing beyond."""
        return np.asarray(self.lines <= self.course.rate / 2)

    @cached_property
    def _images(self) -> tuple[tuple[FloatArray, FloatArray], ...]:
        """Frequencies (n_nodes,) and image numbers (n_images,) of near and far images."""
        images = []
        for first, last, count in (NEAR_IMAGES, FAR_IMAGES):
            nodes = np.unique(self.lines[self._below])
            if len(nodes) > count:
                nodes = np.linspace(nodes[0], nodes[-1], count)
            away = np.arange(first, last + 1.0)
            images.append((nodes, np.concatenate([-away[::-1], away])))
        return tuple(images)

    @cached_property
    def frequencies(self) -> FloatArray:
        """Frequencies at which the response in continuous time is needed, Hz, (n_f,): the lines first."""
        if self.course.is_band_limited:
            return self.lines
        images = [np.abs(nodes[:, None] + k * self.course.rate).ravel() for nodes, k in self._images]
        return np.concatenate([self.lines, *images, np.array(ASYMPTOTE_RATES) * self.course.rate])

    @cached_property
    def _weights(self) -> _Weights:
        """Factors of the terms of the sum, which depend on no response."""
        held, rate = self.course.between == "held", self.course.rate
        lines, power = self.lines[self._below], 1 if held else 2
        x = lines / rate
        numerator = np.sin(np.pi * x) * np.exp(-1j * np.pi * x) if held else np.sin(np.pi * x) ** 2
        return _Weights(
            images=tuple(((np.pi * (nodes[:, None] / rate + k)) ** -power)[:, :, None] for nodes, k in self._images),
            negative=tuple((nodes[:, None] + k * rate < 0)[:, :, None] for nodes, k in self._images),
            far=tuple((_far_sum(each, x, FAR_IMAGES[1]) / np.pi**power)[:, None] for each in range(power, power + 3)),
            share=self.course.share(lines)[:, None],
            numerator=numerator[:, None],
            # The sum is the mean of what is read just before and just after a step; a sample is read after it.
            step=(1 - np.exp(-2j * np.pi * x))[:, None] if held else None,
        )

    def folded(self, values: NDArray[Any]) -> ComplexArray:
        """Response between samples, (n_lines, ...), from that in continuous time at ``frequencies``, (n_f, ...)."""
        if self.course.is_band_limited:
            return np.asarray(values, dtype=complex)
        G, weights = np.asarray(values).reshape(len(values), -1), self._weights
        lines, G_lines = self.lines[self._below], G[: len(self.lines)]
        rest, done = np.zeros((len(lines), G.shape[1]), dtype=complex), len(G_lines)
        for (nodes, k), factors, negative in zip(self._images, weights.images, weights.negative, strict=True):
            count = len(nodes) * len(k)
            image = G[done : done + count].reshape(len(nodes), len(k), -1)
            # G(-f) is the conjugate of G(f)
            image = np.where(negative, image.conj(), image)
            rest += _interpolated(nodes, (factors * image).sum(axis=1), lines)
            done += count
        constant, terms = self._asymptote(G[-2:])
        for term, far in zip(terms, weights.far, strict=True):
            rest += term * far
        G_between = G_lines.astype(complex)
        G_between[self._below] = weights.share * G_lines[self._below] + weights.numerator * rest
        if weights.step is not None:
            G_between[self._below] += constant * weights.step / 2
        return G_between.reshape(len(G_between), *values.shape[1:])

    def _asymptote(self, far: ComplexArray) -> tuple[FloatArray, tuple[NDArray[Any], ...]]:
        """Constant (n,) of G = c + a/(j omega) + b/(j omega)^2 far up, and the terms of powers of 1/(x + k)."""
        first, second = 2 * np.pi * np.array(ASYMPTOTE_RATES) * self.course.rate
        # Re G = c - b/omega^2 and Im G = -a/omega at two frequencies far above every pole.
        b = (far[1].real - far[0].real) / (first**-2 - second**-2)
        a = -second * far[1].imag
        c = far[1].real + b / second**2
        per_rate = 1 / (2j * np.pi * self.course.rate)
        return c, (c, a * per_rate, b * per_rate**2)


def _interpolated(nodes: FloatArray, values: ComplexArray, lines: FloatArray) -> ComplexArray:
    """Values (n_lines, n) between those (n_nodes, n) at the nodes, by cubic splines, or at the nodes themselves."""
    if len(nodes) <= len(lines) and np.isin(lines, nodes).all():
        return np.asarray(values[np.searchsorted(nodes, lines)])
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(nodes, values, axis=0)(lines))


def _far_sum(power: int, x: FloatArray, last: int) -> FloatArray:
    """Sum of 1/(x + k)^power over all whole k beyond ``last`` on either side, (n,)."""
    from scipy.special import psi, zeta

    # Sums to infinity of 1/(k + x)^n are Hurwitz' zeta; of 1/(k + x) - 1/(k - x) two digammas.
    up, down = last + 1 + x, last + 1 - x
    if power == 1:
        return np.asarray(psi(down) - psi(up))
    return np.asarray(zeta(power, up) + (-1) ** power * zeta(power, down))


def course_remark(name: str, course: BetweenSamples, highest: float) -> str:
    """Note on the course of a torque between samples where it matters by more than 1 % up to a frequency in Hz.

    Empty where it matters less.

    >>> course_remark("T_M", BetweenSamples("held", 200.0), 20.0)
    'T_M is held between samples: at 20 Hz its vibration is 1.6 % smaller than its samples and 2.5 ms late, allowed for'
    """
    ways = [BetweenSamples(way, course.rate) for way in WAYS[:-1]] if course.is_band_limited else [course]
    effects = [way.lowering(highest) for way in ways]
    if max(effects) < NOTED_EFFECT:
        return ""
    shares = [f"{100 * effect:.2g} %" for effect in effects]
    if course.is_band_limited:
        text = f"{name} is taken for band-limited between samples: at {highest:.3g} Hz its vibration would be"
        return f"{text} {shares[0]} smaller if held and {shares[1]} if straight; say which by between"
    late = f" and {1e3 / (2 * course.rate):.3g} ms late" if course.between == "held" else ""
    text = f"{name} is {course.between} between samples: at {highest:.3g} Hz its vibration is"
    return f"{text} {shares[0]} smaller than its samples{late}, allowed for"
