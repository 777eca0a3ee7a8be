"""Files of the pitch pattern of a wheel: YAML that a person can read, one tooth a line."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from torsionnet.base.atomic import write_text
from torsionnet.base.entries.declared import FORMAT_VERSION, KEY, version_faults
from torsionnet.base.errors import Fault, ModelError, UsageError
from torsionnet.io.wheel_pattern_entries import UNITS, WheelPatternFile
from torsionnet.model.files.library import decode
from torsionnet.model.files.located_yaml import compose
from torsionnet.model.files.reader import located_faults, presentable_faults
from torsionnet.signals.rotation.wheel_pattern import WheelPattern

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
    try:
        document = compose(decode(file.read_bytes(), str(file)).removeprefix("\ufeff"), str(file))
    except OSError as error:
        raise UsageError(f"{file} cannot be read: {error.strerror or error}") from None
    except ModelError as error:
        raise ModelError(presentable_faults(error.faults), file.name) from None
    if not isinstance(document.data, dict):
        text = f"this is no wheel pattern; torsionnet calibrate-wheel writes one, with {KEY}: 1, teeth: and positions:"
        raise ModelError([Fault(text, position=document.position())], file.name)
    found, faults = WheelPatternFile.read(document.data)
    faults = [*document.faults, *version_faults(document.data, "wheel pattern"), *faults]
    if found is None or faults:
        raise ModelError(located_faults(faults, document), file.name)
    angles = np.array(found.positions) * UNITS[found.unit]
    return WheelPattern(
        positions=angles[:, 0],
        half_widths=angles[:, 1],
        missing=found.missing_teeth,
        name=found.name,
        first=found.first_tooth,
        unresolved=tuple(found.unresolved_orders),
        notes=tuple(found.notes),
        reversed=found.reversed,
    )
