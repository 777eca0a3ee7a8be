"""Choice of the channels of a file that are read, with the quantity of each and the factor to SI."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from torsionnet.base.delimited.dialect import plain_unit
from torsionnet.base.errors import Fault, comma_list, nearest, remedy, unknown_name
from torsionnet.base.notes import NoteOrText
from torsionnet.base.units import ANGLES, DIMENSIONS, Dimension, UnitError, parse_unit
from torsionnet.signals.recording import QUANTITY_UNITS
from torsionnet.signals.records.source import FileChannel, Source
from torsionnet.signals.rotation.counter import PulseReading

# Options of the caller for reading a recording from a file.


@dataclass(frozen=True)
class ReadOptions:
    """Options of the caller for reading a recording (names, units, sampling rate in Hz, encoder pulses and so on)."""

    names: Sequence[str] | Mapping[str, str] | None = None
    quantities: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    sampling_rate: float | None = None
    pulses: Mapping[str, float] = field(default_factory=dict)
    readings: Mapping[str, PulseReading] = field(default_factory=dict)
    resample: bool = False
    between: Mapping[str, str] = field(default_factory=dict)


# Quantity of a recorded channel from its unit, and the factor that converts its values to SI.

_DIMENSIONS = {"torque": "torque", "angle": "angle", "velocity": "speed", "acceleration": "acceleration"}
"""Dimensions of the quantities of a channel that its unit tells.

A pressure may be that of a gas, so stress is not among them.
"""
_USUAL_NAMES = {
    "angle": re.compile(
        r"(?:a|(?i:phi|theta|alpha|beta|gamma|psi|varphi|φ|θ|ang(?:le)?|winkel|twist|enc(?:oder)?|pos(?:ition)?))(?![^\W\d_])"
    ),
    "velocity": re.compile(r"(?:w|n|(?i:omega|ω|rpm|speed|drehzahl|vel(?:ocity)?|tacho))(?![^\W\d_])"),
    "acceleration": re.compile(r"(?i:acc(?:eleration)?|eps(?:ilon)?|domega)(?![^\W\d_])"),
}
"""Beginnings of the names that channels of a quantity usually have."""
_ANGULAR = re.compile("|".join([*sorted(ANGLES), "°"]))


def quantity_of(unit: str) -> str:
    """Quantity of a channel (torque, angle, ...) that has a unit; empty where none or more than one has it.

    >>> quantity_of("kNm"), quantity_of("deg"), quantity_of("rpm"), quantity_of("V")
    ('torque', 'angle', 'velocity', '')
    """
    try:
        dimension = parse_unit(plain_unit(unit)).dimension
    except UnitError:
        return ""
    quantity = quantity_of_dimension(dimension)
    # A bare number or per cent has the dimension of an angle, and so have many other things.
    return quantity if quantity != "angle" or _ANGULAR.search(unit) else ""


def likely_quantity(name: str) -> str:
    """Quantity that a channel of this name probably holds, for an example; a torque where the name tells nothing.

    >>> likely_quantity("phi_2"), likely_quantity("n1"), likely_quantity("M1")
    ('angle', 'velocity', 'torque')
    """
    return next((quantity for quantity, usual in _USUAL_NAMES.items() if usual.match(name)), "torque")


def quantity_of_dimension(dimension: Dimension) -> str:
    """Quantity of a channel that has a dimension, empty where there is none."""
    return next((quantity for quantity, name in _DIMENSIONS.items() if dimension == DIMENSIONS[name]), "")


def factor_to_si(unit: str, quantity: str) -> float:
    """Factor that converts values to SI, or :class:`UnitError` where the unit is not one of the quantity.

    >>> factor_to_si("kNm", "torque")
    1000.0
    """
    read = parse_unit(plain_unit(unit))
    if read.dimension != DIMENSIONS[_DIMENSIONS.get(quantity, "pressure")]:
        raise UnitError(f'"{unit}" is no unit of {quantity}; expected one like {QUANTITY_UNITS[quantity]}')
    return float(read.factor)


MOST_LISTED = 10
"""Number of channels of a file that a message lists at most."""


@dataclass(frozen=True)
class ChannelChoice:
    """Channel of a file to be read, with its name in the recording, its quantity and the factor to SI."""

    channel: FileChannel
    name: str
    quantity: str = ""
    factor: float = 1.0
    notes: tuple[NoteOrText, ...] = ()


def choose(
    source: Source,
    names: Sequence[str] | Mapping[str, str] | None,
    quantities: Mapping[str, str],
    units: Mapping[str, str],
) -> tuple[list[ChannelChoice], list[Fault]]:
    """Channels of a file to be read, and all faults in names, quantities and units, by the names in the file."""
    known = {channel.name: channel for channel in reversed(source.channels)}
    asked = list(names) if names is not None else []
    faults = [
        unknown_name("channel", name, known, ("channels",), rest=_there_are(name, known))
        for name in dict.fromkeys([*asked, *quantities, *units])
        if name not in known
    ]
    channels = source.channels if names is None else [known[name] for name in asked if name in known]
    choices = []
    if names is None and not all(channel.over for channel in channels):
        channels = [channel for channel in channels if not channel.over]  # left out, with a note
    for channel in channels:
        if channel.over:
            whose = f"the values of {channel.name}" if channel.position else "its values"  # a place hides the path
            text = f"{whose} are over {channel.over}, no record over time; export it over time"
            faults.append(Fault(text, ("channels", channel.name), position=channel.position))
            continue
        try:
            choice = _choice(channel, quantities.get(channel.name), units.get(channel.name, channel.unit), names)
            choices.append(choice)
        except UnitError as error:
            faults.append(Fault(str(error), ("channels", channel.name), position=channel.position))
    if not channels and not faults:
        faults.append(Fault("there is no channel of numbers in the file"))
    return choices, faults


def _there_are(name: str, known: Collection[str]) -> str:
    """Text on the channels of several groups or places that have this name, or on all where none is like it."""
    alike = [other for other in known if other.rpartition("/")[2] == name or other.startswith(f"{name} ")]
    others = [] if nearest(name, known) else list(known)[::-1]
    listed = comma_list(sorted(alike) or others, MOST_LISTED, none="none of numbers")
    return f"the file has {listed}" if alike or others or not known else ""


def _choice(
    channel: FileChannel, given: str | None, unit: str, names: Sequence[str] | Mapping[str, str] | None
) -> ChannelChoice:
    name = names[channel.name] if isinstance(names, Mapping) else channel.name
    quantity = next(known for known in (given, channel.quantity, quantity_of(unit)) if known is not None)
    if quantity and quantity not in QUANTITY_UNITS:
        raise UnitError(f'"{quantity}" is no quantity; expected {", ".join(QUANTITY_UNITS)}')
    if not quantity:
        if names is not None and given is None:
            raise UnitError(_unknown(unit, channel.name))
        if channel.quantity == "":
            return ChannelChoice(channel, name, notes=channel.notes)
        note = f"values as in the file{f' in {unit}' if unit else ''}: the quantity is not known"
        return ChannelChoice(channel, name, notes=(*channel.notes, note))
    if not unit:
        factor = channel.implied.get(quantity, 1.0)
        said = f"no unit of its own: multiplied by {factor:.6g} by the units of the file"
        note = f"no unit in the file: taken for {QUANTITY_UNITS[quantity]}" if factor == 1.0 else said
        return ChannelChoice(channel, name, quantity, factor, (*channel.notes, note))
    factor = factor_to_si(unit, quantity)
    notes = channel.notes if factor == 1.0 else (*channel.notes, f"converted from {unit}")
    return ChannelChoice(channel, name, quantity, factor, notes)


def _unknown(unit: str, name: str) -> str:
    says = f'its unit "{unit}" does not tell its quantity' if unit else "it has no unit"
    example = remedy("quantities=", {name: likely_quantity(name)})
    return f"{says}; give one of {', '.join(QUANTITY_UNITS)}, for example {example}"


def length_faults(source: Source, choices: Iterable[ChannelChoice]) -> list[Fault]:
    """Fault that lists how many values every channel of a file has, where they differ; empty where they agree."""
    channels = [choice.channel for choice in choices] + ([source.time] if source.time else [])
    lengths = {channel.name: channel.length for channel in channels if channel.length is not None}
    if len(set(lengths.values())) < 2:
        return []
    groups = Counter(lengths.values()).most_common()
    parts = [
        f"{', '.join(name for name, length in lengths.items() if length == size)} has {size} values"
        if count == 1
        else f"{', '.join(name for name, length in lengths.items() if length == size)} have {size}"
        for size, count in groups
    ]
    return [Fault(f"channels of different lengths: {'; '.join(parts)}; name channels of one length")]
