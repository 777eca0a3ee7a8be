"""Measured orders that a report lays beside the amplitudes expected at the places of its measurement plan."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsionnet.base.errors import ModelError, UsageError
from torsionnet.model.channels import parse_sensor

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.linear.frequency_response import Channel
    from torsionnet.signals.orders.tracked_orders import MeasuredOrder

FORM = "CONFIGURATION=FILE, or CONFIGURATION:SENSOR=FILE"
"""Pattern, for error messages, of the text that names a file of measured orders, its condition and its sensor."""


@dataclass(frozen=True)
class MeasuredFile:
    """Path of a file with measured orders, the configuration they were measured in, and the sensor, empty if not said.

    Both names are empty where they are not said.
    """

    path: Path
    configuration: str = ""
    place: str = ""


@dataclass(frozen=True, eq=False)
class PlaceTest:
    """Measured orders of one file at a place of the plan, with those of the model along the speed of a fast run-up.

    Attributes
    ----------
    orders : tuple of MeasuredOrder
        SI.
    swept : tuple of MeasuredOrder
        Empty where the steady response is compared.
    remarks : tuple of str
        Peaks that the run-up did not reach.
    """

    orders: tuple[MeasuredOrder, ...]
    swept: tuple[MeasuredOrder, ...] = ()
    remarks: tuple[str, ...] = ()


def measured_files(raw: Any, model: Drivetrain) -> tuple[MeasuredFile, ...]:
    """Files with measured orders from paths, texts ``CONFIGURATION=FILE`` or a mapping of paths by configuration.

    Raises
    ------
    UsageError
        No such configuration, or none is said although the model has several.
    """
    found = []
    pairs: Iterable[tuple[str, Any]]
    pairs = raw.items() if isinstance(raw, Mapping) else (("", one) for one in raw)
    for name, paths in pairs:
        listed = [paths] if isinstance(paths, (str, os.PathLike, MeasuredFile)) else list(paths)
        found += [one if isinstance(one, MeasuredFile) else _parsed(name, os.fspath(one), model) for one in listed]
    return tuple(found)


def _parsed(name: str, text: str, model: Drivetrain) -> MeasuredFile:
    before, _, file = ("", "", text) if name or Path(text).exists() else text.rpartition("=")
    configuration, _, place = (name or before).rpartition(":")
    if not configuration and not (place in model.sensors or parse_sensor(place)):
        configuration, place = place, ""
    try:
        chosen = model.configured(configuration).configuration if configuration else model.configuration
    except (UsageError, ModelError) as error:
        raise UsageError(f'measured orders "{text}": {error}; write {FORM}') from None
    return MeasuredFile(Path(file), chosen, place)


def read_measured(
    file: MeasuredFile, places: Sequence[Channel], configuration: str
) -> dict[str, tuple[MeasuredOrder, ...]]:
    """Measured orders in a file, by the name of the place of the plan that they were measured at.

    A file of ``torsionnet orders`` names its places; others are told by their unit.

    Raises
    ------
    UsageError
        No place has the unit of the file, or several have it; the message names the file and says what to do.
    """
    from torsionnet.io.order_tables import is_written_table, read_orders

    names = [place.name for place in places]
    if file.place and file.place not in names:
        raise UsageError(
            f"{file.path.name}: {file.place} is no place of the measurement plan, which has {', '.join(names)}; add it "
            f"to report: {{measure: [{', '.join([*names, file.place])}]}}"
        )
    found, refusals = {}, []
    for place in places:
        if file.place in ("", place.name):
            try:
                found[place.name] = read_orders(file.path, place, configuration)
            except UsageError as error:
                refusals.append(str(error))
    if not found:
        reasons = "; ".join(dict.fromkeys(refusals))
        raise UsageError(
            f"{reasons}. The plan measures {', '.join(f'{place.name} in {place.unit}' for place in places)}; give the "
            "file another unit, or name other sensors in report: {measure: [...]}"
        )
    if len(found) > 1 and not is_written_table(file.path):
        raise UsageError(
            f"{file.path.name} may be of {' or '.join(found)}, which have the same unit; say which: "
            f"{configuration or 'CONFIGURATION'}:{next(iter(found))}={file.path.name}"
        )
    return found
