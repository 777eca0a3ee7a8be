"""Describing functions in closed form: mean torque and first harmonic of laws of motion under one harmonic of twist.

Under gamma = m + a cos(w t) a law answers with the mean torque T_0 and the first harmonic Re (k' + j k'') a e^(jwt).
With x = (g - m)/a of a corner g, and x kept between -1 and 1, a slope that grows by dk at g adds

    k' = dk (acos x - x sqrt(1 - x^2))/pi,   T_0 = dk a (sqrt(1 - x^2) - x acos x)/pi,

which is dk (1 - N(x))/2 with N(x) = 2/pi (asin x + x sqrt(1 - x^2)); a torque that steps up by P at g adds
k' = 2 P sqrt(1 - x^2)/(pi a) and T_0 = P acos(x)/pi (A. Gelb, W. E. Vander Velde, Multiple-Input Describing Functions
and Nonlinear System Design, 1968).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from torsionnet.model.element_base.laws import MotionState, TorqueCurve
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope
from torsionnet.model.motion_laws.smooth_curves import CubicCurve

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
        return _of_cubic(curve, amplitude, mean)
    if isinstance(curve, PieceCurve) and not any(
        isinstance(one, Slope) and one.side and one.damping for one in curve.pieces
    ):
        if curve.over == "twist":
            return _of_pieces(curve, amplitude, mean, omega)
        # Over the rate the same corners act on the rate's amplitude a w, a quarter of a period ahead: k'' = k'(a w) w.
        rate = _of_pieces(curve, amplitude * omega, 0.0, omega)
        return Describing(rate.mean_torque, 1j * omega * rate.stiffness.real)
    return _by_quadrature(curve, amplitude, mean, omega)


def slider_describing_function(stiffness: float, torque: float, amplitude: float) -> complex:
    """Complex stiffness k' + j k'' in N m/rad of friction of a torque in N m behind a spring, at an amplitude in rad.

    Below T/k the spring alone acts. Beyond it slips, and with cos(th) = 1 - 2 T/(k a) the reversal turns back the
    angle th before it slips again: k' = k (th - sin(2 th)/2)/pi, k'' = 4 T (a - T/k)/(pi a^2).

    >>> slider_describing_function(300.0, 4.0, 0.01)
    (300+0j)
    """
    if amplitude <= torque / stiffness:
        return complex(stiffness)
    turned = math.acos(1 - 2 * torque / (stiffness * amplitude))
    elastic = stiffness * (turned - math.sin(2 * turned) / 2) / math.pi
    return complex(elastic, 4 * torque * (amplitude - torque / stiffness) / (math.pi * amplitude**2))


def _of_cubic(curve: CubicCurve, a: float, m: float) -> Describing:
    """Torque k (m + a cos) + k_3 (m + a cos)^3 by the formulas of powers of the cosine."""
    k, third = float(curve.stiffness), float(curve.cubic)
    return Describing(k * m + third * (m**3 + 1.5 * m * a**2), complex(k + third * (0.75 * a**2 + 3 * m**2)))


def _of_pieces(curve: PieceCurve, a: float, m: float, omega: float) -> Describing:
    """Sum over the corners of a curve, from its first straight piece on."""
    over_twist = curve.over == "twist"
    slopes = [one for one in curve.pieces if isinstance(one, Slope)]
    first = slopes[0]
    k = float(first.stiffness if over_twist else first.damping)
    torque, stiffness = float(first.torque) + k * m, complex(k, omega * float(first.damping) if over_twist else 0.0)
    for before, after in pairwise(slopes):
        corner = float(after.lower if after.lower is not None else before.upper)
        grown = float(after.stiffness - before.stiffness if over_twist else after.damping - before.damping)
        step = float(after.torque - before.torque) + grown * corner
        x = min(1.0, max(-1.0, (corner - m) / a)) if a else math.copysign(1.0, corner - m)
        root, turned = math.sqrt(1 - x * x), math.acos(x)
        stiffness += grown * (turned - x * root) / math.pi
        # Beyond the swing the whole of the corner counts: h = 0 above, m - g below.
        torque += grown * (a * (root - x * turned) / math.pi if abs(x) < 1 else max(0.0, m - corner))
        if a:
            stiffness += 2 * step * root / (math.pi * a)
        torque += step * turned / math.pi
        if over_twist and after.damping != before.damping:
            # A damper on one side of the corner acts while gamma > g: 2/pi of the integral of sin^2 there.
            stiffness += 1j * omega * float(after.damping - before.damping) * (turned - x * root) / math.pi
    return Describing(torque, stiffness)


def _by_quadrature(curve: TorqueCurve, a: float, m: float, omega: float) -> Describing:
    phases = 2 * np.pi * (np.arange(QUADRATURE) + 0.5) / QUADRATURE
    pairs = zip((m + a * np.cos(phases)).tolist(), (-a * omega * np.sin(phases)).tolist(), strict=True)
    torques = np.array([float(curve.torque(twist, rate)) for twist, rate in pairs])
    first = 2 * np.mean(torques * np.exp(-1j * phases))
    if a:
        return Describing(float(torques.mean()), complex(first / a))
    return Describing(float(torques.mean()), complex(float(curve.slopes(MotionState(m))[0])))


def has_steps(curve: TorqueCurve) -> bool:
    """Whether a curve stands still at a step: friction that sticks, or springs with a preload."""
    return isinstance(curve, PieceCurve) and any(isinstance(one, Hold) for one in curve.pieces)
