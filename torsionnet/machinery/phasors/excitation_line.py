"""Torques or motions of an excitation by order at one speed, as plain rows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from torsionnet.base.result_rows import Out


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
