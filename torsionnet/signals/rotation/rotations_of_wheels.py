"""Rotations of all wheels of a record, from the channels of their pulses."""

from __future__ import annotations

from collections.abc import Mapping

from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.signals.recording import Recording
from torsionnet.signals.rotation.pulse_reading import PulseReading
from torsionnet.signals.rotation.wheel_channel import WheelChannel, counted_reading, wheel_pulses
from torsionnet.signals.rotation.wheel_pattern import WheelPattern
from torsionnet.signals.rotation.wheel_rotation import WheelRotation, wheel_rotation


def rotations_of_wheels(
    record: Recording,
    wheels: Mapping[str, WheelChannel],
    patterns: Mapping[str, WheelPattern] | None = None,
    *,
    marks: Mapping[str, PulseReading] | None = None,
    index: str = "",
) -> dict[str, WheelRotation]:
    """Rotation of the reference shaft in rad as each wheel of a record shows it, by the channel of its pulses.

    Parameters
    ----------
    record : Recording
        Record with the pulses of the wheels or the signals of their teeth.
    wheels : mapping of str to WheelChannel
    patterns : mapping of str to WheelPattern, optional
        Pitch patterns of the wheels that have one, which are removed.
    marks : mapping of str to PulseReading, optional
        How channels of index pulses are read; those left out are read with the counter of their wheel.
    index : str, optional
        Index pulse of the reference shaft: that of wheels which turn as fast and have neither gap nor index.

    Raises
    ------
    ModelError
        Channels that hold no pulses, or pulses that do not fit their wheel; of all wheels at once.

    Examples
    --------
    >>> import numpy as np
    >>> from torsionnet.signals import PulseChannel
    >>> record = Recording((), 600.0, pulses=(PulseChannel("n1", np.arange(600) / 600),))
    >>> print(f"{rotations_of_wheels(record, {'n1': WheelChannel(teeth=60)})['n1'].revolutions:.3f}")
    9.983
    """
    found: dict[str, WheelRotation] = {}
    faults: list[Fault] = []
    for name, wheel in wheels.items():
        try:
            mark = wheel.index or (index if index != name and wheel.ratio == 1 and not wheel.shows_tooth_0 else "")
            reading = (marks or {}).get(mark) or counted_reading(wheel)
            pulses = wheel_pulses(record, mark, reading) if mark else None
            pattern = (patterns or {}).get(name)
            found[name] = wheel_rotation(wheel_pulses(record, name, wheel), wheel, pattern, index=pulses)
        except UsageError as error:
            faults.append(Fault(str(error)))
    if faults:
        raise ModelError(faults, record.title or "record")
    return found
