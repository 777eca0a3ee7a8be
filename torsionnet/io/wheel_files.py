"""Files of the wheels of a test (YAML): teeth, gap, gearing, pitch pattern and reading of each channel of pulses."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.atomic import write_text
from torsionnet.base.entries.composite import Listed, Named, Nested, PairOf
from torsionnet.base.entries.declared import FORMAT_VERSION, KEY, Declared, version_faults
from torsionnet.base.entries.spec import Count, EntryError, Flag, OneOf, Schema, Spec, Text, entry
from torsionnet.base.errors import Fault, ModelError, UsageError, got
from torsionnet.model.files.fault_places import located_faults, read_document
from torsionnet.signals.recording import Recording
from torsionnet.signals.records.recording_files import pulse_names, read_even
from torsionnet.signals.rotation.counter import PulseReading
from torsionnet.signals.rotation.wheel import WheelPattern
from torsionnet.signals.rotation.wheel_channel import WheelChannel, counted_reading

# Entries of the file of a wheel's pitch pattern.

UNITS: Mapping[str, float] = {"deg": math.pi / 180, "rad": 1.0}
"""Factor to rad of each unit in which a file of a pitch pattern may hold its angles."""


class AngleOfTooth(Spec[float]):
    """Entry of a plain number, an angle in the unit that the file of a pitch pattern names."""

    def coerce(self, raw: object) -> float:
        if isinstance(raw, bool) or not isinstance(raw, int | float) or not math.isfinite(raw):
            raise EntryError(f"expected a number, in the unit that the file names, {got(raw)}", kind="not-a-number")
        return float(raw)

    def schema(self) -> Schema:
        return {"type": "number", "description": self.description}

    @property
    def accepted(self) -> str:
        return "float"


@dataclass(frozen=True, kw_only=True)
class WheelPatternFile(Declared):
    """A pitch pattern of a wheel as its file holds it, tooth by tooth.

    Examples
    --------
    >>> WheelPatternFile(teeth=2, unit="deg", positions=[[0.1, 0.01], [-0.1, 0.01]]).positions[0]
    (0.1, 0.01)
    """

    kind: ClassVar[str] = "wheel pattern"
    article: ClassVar[str] = "a wheel pattern"
    head: ClassVar[tuple[str, ...]] = (KEY,)

    name: str = entry(Text("the wheel, its machine, the date of the calibration"), "")
    teeth: int = entry(Count("teeth of the wheel, missing ones included", lower=2, upper=10_000_000))
    missing_teeth: int = entry(Count("teeth that the gap lacks, the last ones of a turn", lower=0), 0)
    first_tooth: str = entry(Text("which tooth is 0, as: the first after the gap"), "")
    reversed: bool = entry(Flag("whether the wheel turned against the sense of the model"), False)
    unresolved_orders: tuple[int, ...] = entry(
        Listed("whole orders that may be vibration and are left out", Count("a whole order", lower=1)), ()
    )
    notes: tuple[str, ...] = entry(Listed("records, method, what was assumed", Text("a sentence")), ())
    unit: str = entry(OneOf("unit of the positions", tuple(UNITS)))
    positions: tuple[tuple[float, float], ...] = entry(
        Listed(
            "of each tooth, how far it stands beyond its place, and half of the 95 % interval",
            PairOf("position and half width", AngleOfTooth("an angle"), "[position, half width]"),
            form="a list of [position, half width] of each tooth",
        )
    )

    def contradictions(self) -> list[Fault]:
        faults = []
        if len(self.positions) != self.teeth:
            text = f"{len(self.positions)} positions are given for {self.teeth} teeth, missing ones included"
            faults.append(Fault(text, ("positions",), kind="wrong-count"))
        if self.missing_teeth >= self.teeth - 1:
            text = f"a wheel of {self.teeth} teeth cannot lack {self.missing_teeth}"
            faults.append(Fault(text, ("missing_teeth",), kind="out-of-range"))
        pitch = 2 * math.pi / self.teeth / UNITS[self.unit]
        for place, (position, half_width) in enumerate(self.positions):
            if abs(position) >= pitch / 2:
                text = f"tooth {place} stands {position:g} {self.unit} beyond its place, half a pitch or more"
                faults.append(Fault(f"{text}; check the unit", ("positions", place), kind="wrong-unit"))
            if half_width < 0:
                faults.append(
                    Fault(f"the half width of tooth {place} is negative", ("positions", place, 1), kind="out-of-range")
                )
        return faults


# Files of the pitch pattern of a wheel: YAML that a person can read, one tooth a line.

DIGITS = 10
"""Significant digits of angles in a file of a pitch pattern, far below what any pickup resolves."""


def write_wheel_pattern(pattern: WheelPattern, path: str | os.PathLike[str]) -> None:
    """Write the pitch pattern of a wheel as a YAML file in degrees, whole or not at all.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "flywheel.yaml")
    >>> write_wheel_pattern(WheelPattern(np.radians([0.1, -0.1]), np.zeros(2), name="flywheel"), path)
    >>> read_wheel_pattern(path).name
    'flywheel'
    """
    write_text(path, "\n".join([*_lines(pattern), ""]))


def _lines(pattern: WheelPattern) -> Iterator[str]:
    yield f"{KEY}: {FORMAT_VERSION}"
    yield f"name: {_text(pattern.name)}"
    yield f"teeth: {pattern.teeth}"
    yield f"missing_teeth: {pattern.missing}"
    yield f"first_tooth: {_text(pattern.first)}"
    yield f"reversed: {str(pattern.reversed).lower()}"
    yield f"unresolved_orders: {list(pattern.unresolved)}"
    yield "notes:" if pattern.notes else "notes: []"
    for note in pattern.notes:
        yield f"  - {_text(note)}"
    yield "unit: deg"
    yield "positions:  # by how much each tooth stands beyond its place, and half of the 95 % interval"
    for tooth, angles in enumerate(np.degrees(np.column_stack([pattern.positions, pattern.half_widths]))):
        yield f"  - [{', '.join(f'{angle:.{DIGITS}g}' for angle in angles)}]  # tooth {tooth}"


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def read_wheel_pattern(path: str | os.PathLike[str]) -> WheelPattern:
    """Read the pitch pattern of a wheel from its file, angles in rad.

    Raises
    ------
    ModelError
        With every fault of the file and its place.
    UsageError
        There is no such file.
    """
    file = Path(path)
    document = read_document(file)
    if not isinstance(document.data, dict):
        text = f"this is no wheel pattern; torsionnet calibrate-wheel writes one, with {KEY}: 1, teeth: and positions:"
        raise ModelError([Fault(text, position=document.position(), kind="wrong-file")], file.name)
    pattern, faults = WheelPatternFile.read(document.data)
    faults = [*document.faults, *version_faults(document.data, "wheel pattern"), *faults]
    if pattern is None or faults:
        raise ModelError(located_faults(faults, document), file.name)
    angles = np.array(pattern.positions) * UNITS[pattern.unit]
    return WheelPattern(
        positions=angles[:, 0],
        half_widths=angles[:, 1],
        missing=pattern.missing_teeth,
        name=pattern.name,
        first=pattern.first_tooth,
        unresolved=tuple(pattern.unresolved_orders),
        notes=tuple(pattern.notes),
        reversed=pattern.reversed,
    )


WHEELS = Named(
    "wheels by the channel of their pulses",
    Nested("a wheel", lambda: WheelChannel, "wheel"),
    form="wheels by channel, as n1: {teeth: 60}",
    fewest=1,
)
"""Entry of a file of wheels, which is the whole file."""


@dataclass(frozen=True, eq=False)
class WheelOfTest:
    """Wheel of a test, with the pitch pattern of its file; None where it has none."""

    channel: WheelChannel
    pattern: WheelPattern | None = None


def read_wheels(path: str | os.PathLike[str]) -> dict[str, WheelOfTest]:
    """Read the wheels of a test by the channel of their pulses, with the pitch patterns that the file names.

    Patterns lie in the folder of the file, or below.

    Raises
    ------
    ModelError
        With every fault of the file and its place.
    UsageError
        There is no such file.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "wheels.yaml")
    >>> _ = path.write_text("n1: {teeth: 60, missing_teeth: 2, clock: 80 MHz, bits: 32}")
    >>> {name: wheel.channel.teeth for name, wheel in read_wheels(path).items()}
    {'n1': 60}
    """
    file = Path(path)
    document = read_document(file)
    wheels, faults = WHEELS.read(document.data)
    of_test: dict[str, WheelOfTest] = {}
    for name, wheel in wheels.items():
        pattern, wrong = pattern_of(wheel, file.parent)
        faults = [*faults, *(fault.under(name) for fault in wrong)]
        of_test[name] = WheelOfTest(wheel, pattern)
    if document.faults or faults:
        raise ModelError(located_faults([*document.faults, *faults], document), file.name)
    return of_test


def channels_of(wheels: Mapping[str, WheelOfTest]) -> dict[str, WheelChannel]:
    """Channels of the wheels of a test, by name."""
    return {name: wheel.channel for name, wheel in wheels.items()}


def patterns_of(wheels: Mapping[str, WheelOfTest]) -> dict[str, WheelPattern]:
    """Pitch patterns (rad) of those wheels of a test that have one, by name."""
    return {name: wheel.pattern for name, wheel in wheels.items() if wheel.pattern is not None}


def pattern_of(wheel: WheelChannel, folder: Path) -> tuple[WheelPattern | None, list[Fault]]:
    """Pitch pattern of a wheel from its file, and faults of that."""
    if not wheel.pattern_file:
        return None, []
    try:
        pattern = read_wheel_pattern(folder / wheel.pattern)
    except UsageError as error:
        return None, [error.fault.under("pattern")]
    except ModelError as error:
        count = len(error.faults)
        text = f"{wheel.pattern} has {count} error{'s' * (count > 1)}"
        return None, [Fault(text, ("pattern",), kind="unreadable-file"), *error.faults]
    if (pattern.teeth, pattern.missing) != (wheel.teeth, wheel.missing_teeth):
        text = f"{wheel.pattern} is the pattern of {pattern.teeth} teeth of which {pattern.missing} are missing"
        return None, [Fault(text, ("pattern",), kind="unfit-wheel")]
    return pattern, []


# Records of turning machines: the pulses of their wheels and marks, whatever the file holds of them.

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
    sampled = [name for name, pulse_reading in readings.items() if pulse_reading.is_of_a_signal and name not in stored]
    sampled += [pulse_reading.second for pulse_reading in readings.values() if pulse_reading.second]
    stamped = {
        name: counted_reading(pulse_reading)
        for name, pulse_reading in readings.items()
        if name not in sampled and (name not in stored or pulse_reading.seconds is not None)
    }
    given = dict(reading.pop("quantities", None) or {})
    names = list(dict.fromkeys([*readings, *sampled, *kept]))
    try:
        return _read(path, names, given, sampled, stamped, reading)
    except ModelError as error:
        # What is neither times nor counts may be the signal of teeth, whose unit no quantity of ours has.
        others = [
            name for name, pulses in stamped.items() if pulses.seconds is None and name in _channels(error.faults)
        ]
        if not others:
            raise
        left = {name: pulse_reading for name, pulse_reading in stamped.items() if name not in others}
        try:
            record = _read(path, names, given, [*sampled, *others], left, reading)
        except ModelError as second:
            raise (error if {*others} & _channels(second.faults) else second) from None
        if any(np.mean(np.diff(record[name].values) > 0) >= MOSTLY_RISING for name in others):
            raise
        return record


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
