"""Torques or motions of one excitation by order at the rated speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from torsionnet.base.result_rows import Out
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.machinery.orders.order_solution import shaft_speeds

# Torques or motions of an excitation by order at one speed, as plain rows.


@dataclass(frozen=True)
class ExcitationLine:
    """Amplitude (N m or rad) and phase (rad) of one order or fixed frequency of an excitation at one speed.

    Attributes
    ----------
    excitation, node : str
        Name of the excitation, and the node or element it acts on; of several the one with the largest amplitude.
    order : float
        Vibrations per revolution of its own shaft; 0 for a fixed frequency.
    fixed : float
        Frequency in Hz beside the order.
    amplitude : float
        Peak value, N m of a torque, rad of an angle or twist.
    share : float
        Amplitude over the mean torque at this speed; nan where the excitation states none.
    phase : float
        Of the cosine, rad; of a torque in the direction of rotation.
    """

    excitation: Annotated[str, Out("excitation")]
    node: Annotated[str, Out("acts on")]
    order: Annotated[float, Out("order")]
    fixed: Annotated[float, Out("frequency", "Hz", "fixed_Hz")]
    amplitude: Annotated[float, Out("amplitude", digits=4)]
    share: Annotated[float, Out("share of mean torque", "%", digits=3, factor=100)]
    phase: Annotated[float, Out("phase", "deg", digits=4)]


EQUAL_AMPLITUDES = 1e-9
"""Relative difference up to which amplitudes on several nodes count as equal, no more than rounding."""


def excitation_lines(drivetrain: AssembledModel, excitation: str) -> tuple[ExcitationLine, ...]:
    """Torques in N m, or motions in rad, of an excitation by order at the rated speed, or the highest if none is rated.

    Examples
    --------
    >>> import torsionnet as tn
    >>> first, _ = excitation_lines(tn.load("two_stroke_ship").configured("normal"), "propeller")
    >>> first.order, round(first.amplitude), round(first.share, 6)  # 6 % of 1280 kN m
    (4.0, 76800, 0.06)
    """
    _, own = shaft_speeds(drivetrain, excitation)
    acting = drivetrain.definition.excitations[excitation]
    torques = acting.torques(np.array([own]))
    rating = acting.rating
    mean = math.nan
    if rating is not None and acting.quantity == "torque":
        # Mean torque (n/n_rated)^exponent T_rated at the speed of the lines.
        follows = (own / rating.speed) ** rating.exponent if rating.speed and rating.exponent else 1.0
        mean = abs(rating.torque) * follows
    fixed = np.zeros(len(torques.orders)) if torques.fixed is None else torques.fixed
    lines = []
    for line, (order, hertz) in enumerate(zip(torques.orders.tolist(), fixed.tolist(), strict=True)):
        sizes = np.abs(torques.amplitudes[0, line])
        place = int(np.argmax(sizes >= (1 - EQUAL_AMPLITUDES) * sizes.max()))  # of equal ones the first
        amplitude = complex(torques.amplitudes[0, line, place])
        share = abs(amplitude) / mean if mean else math.nan
        phase = float(np.angle(amplitude))
        lines.append(ExcitationLine(excitation, torques.nodes[place], order, hertz, abs(amplitude), share, phase))
    return tuple(lines)
