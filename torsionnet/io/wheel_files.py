"""Files of the wheels of a test (YAML): teeth, gap, gearing, pitch pattern and reading of each channel of pulses."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from torsionnet.base.entries.composite import Named, Nested
from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.io.wheel_pattern_files import read_wheel_pattern
from torsionnet.model.files.library import decode
from torsionnet.model.files.located_yaml import compose
from torsionnet.model.files.reader import located_faults, presentable_faults
from torsionnet.signals.rotation.wheel_channel import WheelChannel
from torsionnet.signals.rotation.wheel_pattern import WheelPattern

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
    >>> {name: one.channel.teeth for name, one in read_wheels(path).items()}
    {'n1': 60}
    """
    file = Path(path)
    try:
        document = compose(decode(file.read_bytes(), str(file)).removeprefix("\ufeff"), str(file))
    except OSError as error:
        raise UsageError(f"{file} cannot be read: {error.strerror or error}") from None
    except ModelError as error:
        raise ModelError(presentable_faults(error.faults), file.name) from None
    wheels, faults = WHEELS.read(document.data)
    found: dict[str, WheelOfTest] = {}
    for name, wheel in wheels.items():
        pattern, wrong = pattern_of(wheel, file.parent)
        faults = [*faults, *(fault.under(name) for fault in wrong)]
        found[name] = WheelOfTest(wheel, pattern)
    if document.faults or faults:
        raise ModelError(located_faults([*document.faults, *faults], document), file.name)
    return found


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
        return None, [Fault(str(error), ("pattern",))]
    except ModelError as error:
        count = len(error.faults)
        text = f"{wheel.pattern} has {count} error{'s' * (count > 1)}"
        return None, [Fault(text, ("pattern",)), *error.faults]
    if (pattern.teeth, pattern.missing) != (wheel.teeth, wheel.missing_teeth):
        text = f"{wheel.pattern} is the pattern of {pattern.teeth} teeth of which {pattern.missing} are missing"
        return None, [Fault(text, ("pattern",))]
    return pattern, []
