"""Describing functions in closed form: mean torque and first harmonic of laws of motion under one harmonic of twist.

Under gamma = m + a cos(w t) a law answers with the mean torque T_0 and the first harmonic Re (k' + j k'') a e^(jwt).
With x = (g - m)/a of a corner g, and x kept between -1 and 1, a slope that grows by dk at g adds

    k' = dk (acos x - x sqrt(1 - x^2))/pi,   T_0 = dk a (sqrt(1 - x^2) - x acos x)/pi,

which is dk (1 - N(x))/2 with N(x) = 2/pi (asin x + x sqrt(1 - x^2)); a torque that steps up by P at g adds
k' = 2 P sqrt(1 - x^2)/(pi a) and T_0 = P acos(x)/pi (A. Gelb, W. E. Vander Velde, Multiple-Input Describing Functions
and Nonlinear System Design, 1968).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.model.element_base.laws import MotionState, TorqueCurve
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope
from torsionnet.model.motion_laws.smooth_curves import CubicCurve

FloatArray = NDArray[np.float64]

QUADRATURE = 4096
"""Points in a period at which a curve without a closed form is read; smooth ones are exact with far fewer."""


@dataclass(frozen=True)
class Describing:
    """Answer of a law to one harmonic of twist: mean torque in N m and complex stiffness k' + j k'' in N m/rad."""

    mean_torque: float
    stiffness: complex

    def scaled(self, scale: float) -> Describing:
        """Answer of a law with so many times the torque."""
        return Describing(scale * self.mean_torque, scale * self.stiffness)


def describing_function(curve: TorqueCurve, amplitude: float, mean: float = 0.0, omega: float = 1.0) -> Describing:
    """Describing function of a torque curve at an amplitude in rad about a mean twist in rad.

    ``omega`` in rad/s matters for curves over the rate and for damping; curves over the rate turn about rest.

    Examples
    --------
    >>> from torsionnet.model.motion_laws.piece_curve import symmetric_curve
    >>> disc = symmetric_curve("twist", (Slope(0, 460, lower=0, upper=0.12), Slope(-124.8, 1500, lower=0.12)))
    >>> round(describing_function(disc, 0.2).stiffness.real, 7)
    756.1472591
    """
    if isinstance(curve, CubicCurve):
        torque, stiffness = _of_cubic(curve, amplitude, mean)
        return Describing(float(torque), complex(stiffness))
    if isinstance(curve, PieceCurve) and not _pushes_only(curve):
        if curve.over == "twist":
            torque, stiffness = _of_pieces(curve, amplitude, mean, omega)
            return Describing(float(torque), complex(stiffness))
        # Over the rate the same corners act on the rate's amplitude a w, a quarter of a period ahead: k'' = k'(a w) w.
        torque, stiffness = _of_pieces(curve, amplitude * omega, 0.0, omega)
        return Describing(float(torque), 1j * omega * float(stiffness.real))
    if isinstance(curve, PieceCurve):
        torque, stiffness = _of_contacts(curve, amplitude, mean, omega)
        return Describing(float(torque), complex(stiffness))
    return _by_quadrature(curve, amplitude, mean, omega)


def slider_describing_function(stiffness: float, torque: float, amplitude: float) -> complex:
    """Complex stiffness k' + j k'' in N m/rad of friction of a torque in N m behind a spring, at an amplitude in rad.

    Below T/k the spring alone acts. Beyond it slips, and with cos(th) = 1 - 2 T/(k a) the reversal turns back the
    angle th before it slips again: k' = k (th - sin(2 th)/2)/pi, k'' = 4 T (a - T/k)/(pi a^2).

    >>> slider_describing_function(300.0, 4.0, 0.01)
    (300+0j)
    """
    return complex(slider_stiffness_over(stiffness, torque, np.array([amplitude]))[0])


def stiffness_over(
    curve: TorqueCurve, amplitude: FloatArray, mean: FloatArray, omega: FloatArray
) -> NDArray[np.complex128]:
    """Complex stiffness k' + j k'' (n,) in N m/rad of a torque curve at amplitudes and means in rad, omega in rad/s."""
    if isinstance(curve, CubicCurve):
        return np.asarray(_of_cubic(curve, amplitude, mean)[1], dtype=np.complex128)
    if isinstance(curve, PieceCurve) and not _pushes_only(curve):
        if curve.over == "twist":
            return np.asarray(_of_pieces(curve, amplitude, mean, omega)[1], dtype=np.complex128)
        # The rate swings by a omega about 0; its slope c acts as j omega c over the twist.
        rate = _of_pieces(curve, amplitude * omega, np.zeros_like(mean), omega)[1]
        return np.asarray(1j * omega * rate.real)
    if isinstance(curve, PieceCurve):
        return np.asarray(_of_contacts(curve, amplitude, mean, omega)[1], dtype=np.complex128)
    rows = zip(amplitude.tolist(), mean.tolist(), omega.tolist(), strict=True)
    return np.array([_by_quadrature(curve, *row).stiffness for row in rows])


def slider_stiffness_over(stiffness: float, torque: float, amplitude: FloatArray) -> NDArray[np.complex128]:
    """Complex stiffness (n,) in N m/rad of friction behind a spring, see :func:`slider_describing_function`."""
    ratio = np.minimum(torque / stiffness / np.maximum(amplitude, np.finfo(float).tiny), 1.0)
    # The spring twists by 2 T/k from a reversal on before it slips: that part of the swing is cos(phi) > 1 - 2 T/(k a).
    turned = np.arccos(1 - 2 * ratio)
    elastic = stiffness * (turned - np.sin(2 * turned) / 2) / np.pi
    return np.asarray(elastic + 4j * stiffness * ratio * (1 - ratio) / np.pi)


def _pushes_only(curve: PieceCurve) -> bool:
    """Whether a contact has damping, so that it leaves before its twist has gone back."""
    return any(isinstance(piece, Slope) and piece.side and piece.damping for piece in curve.pieces)


def _of_cubic(curve: CubicCurve, a: Any, m: Any) -> tuple[Any, Any]:
    """Mean torque and stiffness of k (m + a cos) + k_3 (m + a cos)^3 by the formulas of powers of the cosine."""
    k, third = float(curve.stiffness), float(curve.cubic)
    # cos^2 has the mean 1/2, cos^3 the first harmonic 3/4.
    return k * m + third * (m**3 + 1.5 * m * a**2), k + third * (0.75 * a**2 + 3 * m**2)


def _of_pieces(curve: PieceCurve, a: Any, m: Any, omega: Any) -> tuple[Any, Any]:
    """Mean torque and stiffness as a sum over the corners of a curve, from its first straight piece on."""
    over_twist = curve.over == "twist"
    slopes = [piece for piece in curve.pieces if isinstance(piece, Slope)]
    first = slopes[0]
    k = float(first.stiffness if over_twist else first.damping)
    torque = float(first.torque) + k * m
    stiffness = k + 1j * omega * (float(first.damping) if over_twist else 0.0)
    size = np.maximum(a, np.finfo(float).tiny)
    for before, after in pairwise(slopes):
        corner = float(after.lower if after.lower is not None else before.upper)
        grown = float(after.stiffness - before.stiffness if over_twist else after.damping - before.damping)
        step = float(after.torque - before.torque) + grown * corner
        # Beyond the swing the whole of the corner counts: h = 0 above, m - g below.
        x = np.clip((corner - m) / size, -1.0, 1.0)
        root, turned = np.sqrt(1 - x * x), np.arccos(x)
        stiffness = stiffness + grown * (turned - x * root) / np.pi
        inside = np.abs(x) < 1
        torque = torque + grown * np.where(inside, a * (root - x * turned) / np.pi, np.maximum(0.0, m - corner))
        stiffness = stiffness + np.where(inside & (a > 0), 2 * step * root / (np.pi * size), 0.0)
        torque = torque + step * turned / np.pi
        if over_twist and after.damping != before.damping:
            # A damper on one side of the corner acts while gamma > g: 2/pi of the integral of sin^2 there.
            stiffness = stiffness + 1j * omega * float(after.damping - before.damping) * (turned - x * root) / np.pi
    return torque, stiffness


def _of_contacts(curve: PieceCurve, a: Any, m: Any, omega: Any) -> tuple[Any, Any]:
    """Mean torque and stiffness of contacts on either side of a gap, in which nothing acts."""
    both = [_of_contact(piece, a, m, omega) for piece in curve.pieces if isinstance(piece, Slope) and piece.side]
    return sum(contact[0] for contact in both), sum(contact[1] for contact in both)


def _of_contact(piece: Slope, a: Any, m: Any, omega: Any) -> tuple[Any, Any]:
    """Mean torque and stiffness of a contact max(0, k d + c d') at a penetration d = side gamma - g.

    Under d = a cos(phi) - d_0 contact pushes while both a cos(phi) > d_0 and R cos(phi + delta) > k d_0, with
    R exp(j delta) = a (k + j w c): from -theta, where the sides meet, to the phase at which the damper would pull.
    """
    k, c, side = float(piece.stiffness), float(piece.damping), piece.side
    apart = -side * (float(piece.torque) / k + m)  # d_0 = g - side m
    size = np.maximum(a, np.finfo(float).tiny)
    lag, reach = np.arctan2(omega * c, k), np.hypot(k, omega * c) * size
    theta, pushed = np.arccos(np.clip(apart / size, -1, 1)), np.arccos(np.clip(k * apart / reach, -1, 1))
    first = np.where(theta < np.pi, np.maximum(-theta, -pushed - lag), -pushed - lag)
    last = np.where(theta < np.pi, np.minimum(theta, pushed - lag), pushed - lag)
    last = np.maximum(first, last)

    def integral(phi: Any) -> tuple[Any, Any]:
        # of T and of T exp(-j phi), T = k (a cos(phi) - d_0) - w c a sin(phi)
        sine, cosine = np.sin(phi), np.cos(phi)
        along = size * (k * (phi / 2 + sine * cosine / 2 - 0.5j * sine**2))
        across = -omega * c * size * (sine**2 / 2 - 0.5j * (phi - sine * cosine))
        level = -k * apart * (sine + 1j * cosine)
        return k * (size * sine - apart * phi) + omega * c * size * cosine, along + across + level

    before, after = integral(first), integral(last)
    return side * (after[0] - before[0]) / (2 * np.pi), (after[1] - before[1]) / (np.pi * size)


def _by_quadrature(curve: TorqueCurve, a: float, m: float, omega: float) -> Describing:
    # Midpoints: neither reversal, where the rate has no sign, is among them.
    phases = 2 * np.pi * (np.arange(QUADRATURE) + 0.5) / QUADRATURE
    pairs = zip((m + a * np.cos(phases)).tolist(), (-a * omega * np.sin(phases)).tolist(), strict=True)
    torques = np.array([float(curve.torque(twist, rate)) for twist, rate in pairs])
    first = 2 * np.mean(torques * np.exp(-1j * phases))
    if a:
        return Describing(float(torques.mean()), complex(first / a))
    return Describing(float(torques.mean()), complex(float(curve.slopes(MotionState(m))[0])))


def has_steps(curve: TorqueCurve) -> bool:
    """Whether a curve stands still at a step: friction that sticks, or springs with a preload."""
    return isinstance(curve, PieceCurve) and any(isinstance(piece, Hold) for piece in curve.pieces)
