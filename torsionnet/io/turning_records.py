"""Records of turning machines: the pulses of their wheels and marks, whatever the file holds of them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from torsionnet.base.errors import Fault, ModelError
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.recording_files import pulse_names, read_even
from torsionnet.signals.rotation.counter import PulseReading
from torsionnet.signals.rotation.wheel_channel import WheelChannel, counted_reading

MOSTLY_RISING = 0.9
"""Share of values larger than the one before above which a channel holds times of pulses, if faulty ones."""


def read_turning_record(
    path: str | os.PathLike[str],
    wheels: Mapping[str, WheelChannel],
    marks: Mapping[str, PulseReading] | None = None,
    kept: Sequence[str] = (),
    **reading: Any,
) -> Recording:
    r"""Record of the wheels of a test, of index and cam pulses, and of the signals that are kept, in SI.

    Times and counts of pulses become ``Recording.pulses``; signals of teeth stay signals, from which
    :func:`~torsionnet.signals.rotation.wheel_channel.wheel_pulses` takes the pulses.

    Parameters
    ----------
    path : str or path
    wheels : mapping of str to WheelChannel
        Wheels by the channel of their pulses.
    marks : mapping of str to PulseReading, optional
        Other channels of pulses. The index of a wheel that is not among them is read with the counter of the wheel.
    kept : sequence of str
        Signals.
    **reading
        Arguments of :func:`read_recording`, without ``names`` and ``pulse_readings``.

    Raises
    ------
    ModelError
        The file is faulty, or lacks a channel.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> path = Path(tempfile.mkdtemp(), "ticks.csv")
    >>> _ = path.write_text("n1\n" + "\n".join(str(1000 * k) for k in range(100)))
    >>> wheel = WheelChannel(teeth=60, tick="1 us")
    >>> read_turning_record(path, {"n1": wheel}).pulses_of("n1").times[:3].tolist()
    [0.0, 0.001, 0.002]
    """
    indices = {wheel.index: counted_reading(wheel) for wheel in wheels.values() if wheel.index}
    readings: dict[str, PulseReading] = {**indices, **(marks or {}), **wheels}
    stored = pulse_names(path, **{word: reading[word] for word in ("separator", "decimal") if word in reading})
    sampled = [name for name, one in readings.items() if one.is_of_a_signal and name not in stored]
    sampled += [one.second for one in readings.values() if one.second]
    stamped = {
        name: counted_reading(one)
        for name, one in readings.items()
        if name not in sampled and (name not in stored or one.seconds is not None)
    }
    given = dict(reading.pop("quantities", None) or {})
    names = list(dict.fromkeys([*readings, *sampled, *kept]))
    try:
        return _read(path, names, given, sampled, stamped, reading)
    except ModelError as error:
        # What is neither times nor counts may be the signal of teeth, whose unit no quantity of ours has.
        others = [name for name, one in stamped.items() if one.seconds is None and name in _channels(error.faults)]
        if not others:
            raise
        left = {name: one for name, one in stamped.items() if name not in others}
        try:
            found = _read(path, names, given, [*sampled, *others], left, reading)
        except ModelError as second:
            raise (error if {*others} & _channels(second.faults) else second) from None
        if any(np.mean(np.diff(found[name].values) > 0) >= MOSTLY_RISING for name in others):
            raise
        return found


def _read(
    path: str | os.PathLike[str],
    names: Sequence[str],
    quantities: Mapping[str, str],
    sampled: Iterable[str],
    stamped: Mapping[str, PulseReading],
    reading: Mapping[str, Any],
) -> Recording:
    as_in_file = dict.fromkeys(sampled, "")
    return read_even(path, names=names, quantities={**as_in_file, **quantities}, pulse_readings=stamped, **reading)


def _channels(faults: Iterable[Fault]) -> set[str]:
    return {str(fault.path[1]) for fault in faults if len(fault.path) > 1 and fault.path[0] == "channels"}
