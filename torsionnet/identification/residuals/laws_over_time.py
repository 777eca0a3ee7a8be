"""Torques of elements with laws of motion along twists over time, or over all harmonics of a steady motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.model.element_base.laws import Row, WholePart
from torsionnet.model.elements import Element, Law, MotionLaw
from torsionnet.model.motion_laws.element_stiffness import slider_of
from torsionnet.model.motion_laws.piece_curve import PieceCurve, Slope
from torsionnet.motion.periodic.law_forces import CurveForce, SliderForce
from torsionnet.signals.stepped_levels import HARMONICS

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Slider: TypeAlias = Callable[[float, float, FloatArray], FloatArray]
"""Torque of friction behind a spring from its stiffness, its torque and the twist."""

PHASES, FINE = 256, 4
"""Phases of a steady motion at which laws are evaluated, and times as many of one that is measured."""
ROUNDS, SETTLED, LOST = 12, 1e-7, 1e-3
"""Most steps of Newton's method by which harmonics are found, their change over the amplitude at which they have
settled, and that of a step above which it has found none, so that one harmonic is compared."""
DIFFERENCE = 1e-5
"""Share of the amplitude by which harmonics are differenced."""


def torque_over_time(
    element: Element, parts: Sequence[WholePart], row: Row, twist: FloatArray, rate: FloatArray, slider: Slider
) -> FloatArray:
    """Torque in N m of an element at twists in rad and rates in rad/s of any shape.

    Raises
    ------
    UsageError
        A law depends on frequency, or on more than twist and rate.
    """
    if element.kind == "friction" and getattr(element, "stiffness", None) is not None:
        return slider(*slider_of(element, parts), twist)
    torque = np.zeros(twist.shape)
    for part in parts:
        if isinstance(part, MotionLaw) and part.row == row and not part.lag and not part.sensed:
            torque += _over(part, twist, rate)
        elif isinstance(part, Law) and part.row == row and part.table is None and not part.loss_factor:
            torque += float(part.stiffness) * twist + float(part.damping) * rate
        elif not (isinstance(part, Law) and part.row != row):
            text = f"{element.name} has a law that depends on frequency or on more than its twist and rate"
            raise UsageError(f"{text}, which has no torque over them", kind="unsupported-law")
    return torque


def _over(law: MotionLaw, twist: FloatArray, rate: FloatArray) -> FloatArray:
    curve, scale = law.curve, float(law.scale)
    if not isinstance(curve, PieceCurve):
        return CurveForce(law).answer_to(twist.ravel(), rate.ravel()).torque.reshape(twist.shape)
    slopes = [piece for piece in curve.pieces if isinstance(piece, Slope)]
    ends = [after.lower if after.lower is not None else before.upper for before, after in pairwise(slopes)]
    piece = np.searchsorted(np.array([float(end) for end in ends]), twist if curve.over == "twist" else rate)
    torque, k, c, side = (
        np.array([float(getattr(slope, name)) for slope in slopes])[piece]
        for name in ("torque", "stiffness", "damping", "side")
    )
    torque = torque + k * twist + c * rate
    # Contacts push and never pull.
    return np.asarray(scale * np.where(side * torque < 0, 0.0, torque))


def slider_torque(stiffness: float, torque: float, twist: FloatArray) -> FloatArray:
    """Torque (n,) in N m of friction of a torque behind a spring along a twist in rad; at first the spring is slack.

    >>> slider_torque(128.0, 2.0, np.array([0.0, 1, 3, 2]) / 128).tolist()
    [0.0, 1.0, 2.0, 1.0]
    """
    most, foot, strains = torque / stiffness, float(twist[0]), np.empty(len(twist))
    for place, angle in enumerate(twist.tolist()):
        # The far end of the spring is dragged along once the torque reaches its limit.
        foot = min(max(foot, angle - most), angle + most)
        strains[place] = angle - foot
    return stiffness * strains


def _steady_slider(stiffness: float, torque: float, twist: FloatArray) -> FloatArray:
    """Torque (n, N) in N m of friction behind a spring over a period of each of n steady twists."""
    return np.stack([SliderForce(stiffness, torque).answer_to(course, None).torque for course in twist])


Laws: TypeAlias = Sequence[tuple[Element, Sequence[WholePart], Row]]
"""Elements with their parts and the row of their twist."""


def _answer(
    laws: Laws, twists: ComplexArray, means: FloatArray, omega: FloatArray, phases: int = PHASES
) -> ComplexArray:
    """Harmonics (n, HARMONICS) of the torque of laws in N m along steady twists of as many harmonics in rad."""
    phi = 2 * np.pi * (np.arange(phases) + 0.5) / phases
    orders = np.arange(1, HARMONICS + 1)
    turns = np.exp(1j * np.outer(orders, phi))
    twist = means[:, None] + (twists @ turns).real
    rate = omega[:, None] * ((1j * orders * twists) @ turns).real
    # Harmonics in, course over a period, torque over it, and harmonics out again: 2/N sum T exp(-j n phi).
    torque = sum(torque_over_time(*law, twist, rate, _steady_slider) for law in laws)
    return np.asarray(2 / phases * torque @ turns.conj().T)


def stiffness_along(
    laws: Laws, amplitudes: FloatArray, means: FloatArray, omega: FloatArray, shape: ComplexArray
) -> ComplexArray:
    """Change (n,) in N m/rad of the complex stiffness of laws by harmonics that a twist was measured to have.

    ``shape``: these from the second on over the first, by its phase, (n, HARMONICS - 1).
    """
    first = amplitudes[:, None].astype(complex)
    sine, measured = (
        _answer(laws, np.concatenate([first, first * more], axis=1), means, omega, FINE * PHASES)
        for more in (np.zeros_like(shape), shape)
    )
    return np.asarray((measured - sine)[:, 0] / amplitudes)


def stiffness_by_harmonics(
    laws: Laws,
    amplitudes: FloatArray,
    means: FloatArray,
    omega: FloatArray,
    spring: float,
    receptances: ComplexArray,
) -> ComplexArray:
    """Change (n,) in N m/rad by harmonics of the twist of the complex stiffness that laws have to its first one.

    The drive is a sine: of the harmonic m of the torque tau beside a spring k_0 the twist gets gamma_m = -b_m tau_m.

    Parameters
    ----------
    laws : sequence of (element, parts, row)
    amplitudes, means, omega : (n,) arrays
        First harmonics and means of the twist in rad, rad/s.
    spring : float
        k_0 in N m/rad.
    receptances : (n, HARMONICS - 1) array
        b_m at the harmonics from the second on, rad/(N m).
    """
    further = np.zeros((len(amplitudes), HARMONICS - 1), dtype=complex)

    def answered(of: ComplexArray) -> ComplexArray:
        return _answer(laws, np.column_stack([amplitudes, of]), means, omega)

    def missed(of: ComplexArray) -> FloatArray:
        gap = of + receptances * (answered(of)[:, 1:] - spring * of)
        return np.concatenate([gap.real, gap.imag], axis=1)

    plain = answered(further)[:, 0]
    change = further
    for _ in range(ROUNDS):  # Newton's method, for all steps at once
        rest, slopes = missed(further), np.empty((len(amplitudes), 2 * HARMONICS - 2, 2 * HARMONICS - 2))
        for place in range(2 * HARMONICS - 2):
            moved = further.copy()
            moved[:, place % (HARMONICS - 1)] += DIFFERENCE * amplitudes * (1 if place < HARMONICS - 1 else 1j)
            slopes[:, :, place] = (missed(moved) - rest) / (DIFFERENCE * amplitudes[:, None])
        step = np.linalg.solve(slopes, rest[:, :, None])[:, :, 0]
        change = step[:, : HARMONICS - 1] + 1j * step[:, HARMONICS - 1 :]
        further = further - change
        if np.abs(change).max() < SETTLED * amplitudes.max():
            break
    by_harmonics = (answered(further)[:, 0] - plain) / amplitudes
    lost = ~(np.abs(change).max(axis=1) < LOST * amplitudes)
    return np.asarray(np.where(lost, 0.0, by_harmonics))
