"""State of motion from which a simulation starts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class MotionStart:
    """Angles in rad and speeds in rad/s of nodes at the first sample of a simulation; nodes not named stand at zero.

    Attributes
    ----------
    angles : mapping
        Node -> rad.
    speeds : mapping
        Node -> rad/s.

    Examples
    --------
    >>> MotionStart(speeds={"rotor": 2.0}).speeds["rotor"]
    2.0
    """

    angles: Mapping[str, float] = field(default_factory=dict)
    speeds: Mapping[str, float] = field(default_factory=dict)
