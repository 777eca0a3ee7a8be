"""Whether a stored pitch pattern can be that of a wheel."""

from __future__ import annotations

from torsionnet.base.errors import UsageError
from torsionnet.signals.rotation.wheel import Wheel
from torsionnet.signals.rotation.wheel_pattern import WheelPattern


def check_pattern(name: str, wheel: Wheel, pattern: WheelPattern) -> None:
    """Refuse a pitch pattern that cannot be that of a wheel.

    Raises
    ------
    UsageError
        Other numbers of teeth or of missing teeth, or the other sense of rotation; all of them at once.

    Examples
    --------
    >>> import numpy as np
    >>> check_pattern("n1", Wheel(teeth=60), WheelPattern(np.zeros(60), np.zeros(60)))
    """
    faults = []
    if pattern.teeth != wheel.teeth:
        faults.append(f"a pattern of {pattern.teeth} teeth does not fit a wheel of {wheel.teeth}")
    if pattern.missing != wheel.missing_teeth:
        faults.append(f"the pattern's gap lacks {pattern.missing} teeth, the wheel's {wheel.missing_teeth}")
    if pattern.reversed != wheel.reversed:
        senses = ("in the sense of the model", "against the sense of the model")
        faults.append(
            f"the pattern was calibrated while the wheel turned {senses[pattern.reversed]}, but it turns "
            f"{senses[wheel.reversed]}: the pickup sees the other edges in the other sequence; calibrate in this sense"
        )
    if faults:
        raise UsageError(f"{name}: {'; '.join(faults)}")
