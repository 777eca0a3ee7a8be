"""Complex stiffness k' + j k'' of an element at an amplitude of its twist: describing functions of all its laws.

A linear law gives k (1 + j eta) + j omega c, a law of motion its describing function, friction behind a spring that of
a slider, and arc springs the first harmonic of their slow loop. Parallel laws add up.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import FLOAT
from torsionnet.model.element_base.element import Element
from torsionnet.model.element_base.laws import Law, MotionLaw, Row, Values, WholePart
from torsionnet.model.motion_laws.describing_functions import (
    Describing,
    describing_function,
    slider_describing_function,
    slider_stiffness_over,
    stiffness_over,
)

FloatArray = NDArray[np.float64]


def element_stiffness(
    element: Element, parameters: Any, amplitude: float, mean_twist: float, mean_torque: float, omega: float
) -> Describing:
    """Mean torque and k' + j k'' of an element at an amplitude in rad about a mean twist in rad, at omega in rad/s.

    ``mean_torque`` in N m is that of arc springs, which their history leaves open at a twist.

    Raises
    ------
    UsageError
        A law of the element has no describing function: a preload behind which it stands still, a table over
        frequency, a lag.

    Examples
    --------
    >>> import torsionnet as tn
    >>> ring = tn.Friction("ring", nodes=("a", "b"), torque=4.0, stiffness=300.0)
    >>> element_stiffness(ring, {}, 0.02, 0.0, 0.0, 1.0).stiffness
    (212.462578...+84.882636...j)
    """
    value = Values(parameters, FLOAT)
    if element.over_time is not element:
        return _of_arc_springs(element, value, amplitude, mean_torque, omega)
    parts = element.whole_parts(value)
    if element.kind == "friction" and getattr(element, "stiffness", None) is not None:
        return Describing(0.0, slider_describing_function(*slider_of(element, parts), amplitude))
    row = element.twist(value)
    torque, stiffness = 0.0, 0j
    for part in parts:
        if isinstance(part, MotionLaw) and part.row == row and not part.lag and not part.sensed:
            describing = describing_function(part.curve, amplitude, mean_twist, omega).scaled(float(part.scale))
            torque, stiffness = torque + describing.mean_torque, stiffness + describing.stiffness
        elif isinstance(part, Law) and part.row == row and part.table is None:
            k, c = float(part.stiffness), float(part.damping)
            torque, stiffness = torque + k * mean_twist, stiffness + complex(k, k * float(part.loss_factor) + omega * c)
        elif not (isinstance(part, Law) and part.row != row):
            raise UsageError(f"{element.name} has no describing function over its twist", kind="unsupported-law")
    return Describing(torque, stiffness)


def stiffness_over_twists(
    element: Element,
    parts: Sequence[WholePart],
    row: Row,
    amplitudes: FloatArray,
    mean_twists: FloatArray,
    omega: FloatArray,
) -> NDArray[np.complex128]:
    """Complex stiffness (n,) in N m/rad of an element at amplitudes in rad about mean twists in rad, omega in rad/s.

    ``parts`` are those of the element with its laws in full, ``row`` is its twist.

    Raises
    ------
    UsageError
        As for :func:`element_stiffness`; also for arc springs, whose torque their history leaves open.
    """
    if element.over_time is not element:
        text = "the torque of its arc springs depends on what went before, which first harmonics do not tell"
        raise UsageError(f"{element.name}: {text}; evaluate its slow loops", kind="unsupported-law")
    if element.kind == "friction" and getattr(element, "stiffness", None) is not None:
        return slider_stiffness_over(*slider_of(element, parts), amplitudes)
    stiffness = np.zeros(len(amplitudes), dtype=complex)
    for part in parts:
        if isinstance(part, MotionLaw) and part.row == row and not part.lag and not part.sensed:
            stiffness = stiffness + float(part.scale) * stiffness_over(part.curve, amplitudes, mean_twists, omega)
        elif isinstance(part, Law) and part.row == row and part.table is None:
            k = float(part.stiffness)
            stiffness = stiffness + k * (1 + 1j * float(part.loss_factor)) + 1j * omega * float(part.damping)
        elif not (isinstance(part, Law) and part.row != row):
            raise UsageError(f"{element.name} has no describing function over its twist", kind="unsupported-law")
    return stiffness


def slider_of(element: Element, parts: Any) -> tuple[float, float]:
    """Stiffness and torque of friction of one torque behind its spring, which turns back before it slips again."""
    springs = [float(part.stiffness) for part in parts if isinstance(part, Law) and part.stiffness]
    curves = [part.curve for part in parts if isinstance(part, MotionLaw)]
    held = [abs(float(curve.torque(0.0, rate))) for curve in curves for rate in (1e-12, 1e3)]
    if len(springs) != 1 or len(curves) != 1 or held[0] != held[1]:
        text = "friction over slip speed behind a spring has no describing function"
        raise UsageError(f"{element.name}: {text}", kind="unsupported-law")
    return springs[0], held[0]


def _of_arc_springs(element: Any, value: Values, amplitude: float, mean_torque: float, omega: float) -> Describing:
    """Springs on an arc, with what its element has beside them, at another swing and mean torque than its entries."""
    from torsionnet.base.expression_reading import scalar

    moved = element.unchecked(swing=scalar(amplitude), torque=scalar(mean_torque))
    law = moved.parts(value)[0]
    k = float(law.stiffness)
    return Describing(mean_torque, complex(k, k * float(law.loss_factor) + omega * float(law.damping)))
