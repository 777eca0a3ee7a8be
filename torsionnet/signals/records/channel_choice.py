"""Channels of a file that are read: their choice, quantities and factors to SI, and which were sampled together."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from torsionnet.base.delimited.dialect import plain_unit
from torsionnet.base.errors import Fault, comma_list, nearest, remedy, unknown_name
from torsionnet.base.notes import NoteOrText, warning
from torsionnet.base.units import ANGLES, DIMENSIONS, Dimension, UnitError, parse_unit
from torsionnet.signals.foreign.content import Blocks
from torsionnet.signals.recording import QUANTITY_UNITS, FloatArray
from torsionnet.signals.records.clock import (
    UNIFORM_TOLERANCE,
    Clock,
    clock_in_days,
    clock_of,
    coarse_clock,
    is_coarse,
    order_faults,
    time_unit_warnings,
    value_faults,
)
from torsionnet.signals.records.source import FileChannel, Source, seconds_in
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
        raise UnitError(
            f'"{unit}" is no unit of {quantity}; expected one like {QUANTITY_UNITS[quantity]}', kind="wrong-unit"
        )
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
    choices: list[ChannelChoice] = []
    untold: dict[str, str] = {}
    if names is None and not all(channel.over for channel in channels):
        channels = [channel for channel in channels if not channel.over]  # left out, with a note
    for channel in channels:
        if channel.over:
            whose = f"the values of {channel.name}" if channel.position else "its values"  # a place hides the path
            text = f"{whose} are over {channel.over}, no record over time; export it over time"
            faults.append(Fault(text, ("channels", channel.name), position=channel.position, kind="wrong-file"))
            continue
        unit = units.get(channel.name, channel.unit)
        try:
            choices.append(_choice(channel, quantities.get(channel.name), unit, names))
        except _UntoldQuantityError:
            untold[channel.name] = unit
        except UnitError as error:
            faults.append(replace(error.fault, path=("channels", channel.name), position=channel.position))
    if untold:
        faults.append(
            untold_quantities(untold).at(next(channel.position for channel in channels if channel.name in untold))
        )
    if not channels and not faults:
        faults.append(Fault("there is no channel of numbers in the file", kind="wrong-file"))
    return choices, faults


def _there_are(name: str, known: Collection[str]) -> str:
    """Text on the channels of several groups or places that have this name, or on all where none is like it."""
    alike = [other for other in known if other.rpartition("/")[2] == name or other.startswith(f"{name} ")]
    others = [] if nearest(name, known) else list(known)[::-1]
    listed = comma_list(sorted(alike) or others, MOST_LISTED, none="none of numbers")
    return f"the file has {listed}" if alike or others or not known else ""


class _UntoldQuantityError(UnitError):
    """A channel that is asked for by name has no unit that tells its quantity."""


def _choice(
    channel: FileChannel, given: str | None, unit: str, names: Sequence[str] | Mapping[str, str] | None
) -> ChannelChoice:
    name = names[channel.name] if isinstance(names, Mapping) else channel.name
    quantity = next(known for known in (given, channel.quantity, quantity_of(unit)) if known is not None)
    if quantity and quantity not in QUANTITY_UNITS:
        raise UnitError(f'"{quantity}" is no quantity; expected {", ".join(QUANTITY_UNITS)}', kind="unknown-word")
    if not quantity:
        if names is not None and given is None:
            raise _UntoldQuantityError("its quantity is not known", kind="missing-unit")
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


def untold_quantities(units: Mapping[str, str]) -> Fault:
    """Fault of channels by name whose units, mostly empty, do not tell their quantities.

    >>> print(untold_quantities({"phi_2": "", "T_M": ""}))
    channels: error: phi_2, T_M have no unit; give one of torque, angle, velocity, acceleration, stress for each, for \
example quantities={"phi_2": "angle", "T_M": "torque"} [missing-unit]
    """
    bare = [name for name, unit in units.items() if not unit]
    says = [f"{comma_list(bare, MOST_LISTED)} {'have' if len(bare) > 1 else 'has'} no unit"] if bare else []
    says += [f'the unit "{unit}" of {name} does not tell its quantity' for name, unit in units.items() if unit]
    some = list(units)[:MOST_LISTED]
    example = remedy("quantities=", {name: likely_quantity(name) for name in some})
    each = " for each" if len(units) > 1 else ""
    text = f"{'; '.join(says)}; give one of {', '.join(QUANTITY_UNITS)}{each}, for example {example}"
    return Fault(text, ("channels", *(some if len(units) == 1 else ())), kind="missing-unit")


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
    return [
        Fault(f"channels of different lengths: {'; '.join(parts)}; name channels of one length", kind="unlike-results")
    ]


# Rasters of a file: which of its channels were sampled together, by their rates, starts and time stamps.

EQUAL_RATES = 1e-7
"""Relative difference of sampling rates that are the same, as those of intervals with rounded decimals are."""
SAME_START, START_STEP = UNIFORM_TOLERANCE, 1e-6
"""Share of a sampling interval by which samples of channels may be apart and count as taken together, as even time
stamps may be off by it, and the step in s in which programs write the times at which channels began."""
MOST_NAMED = 5
"""Number of channels of one rate that a message names at most, so that it stays short."""


@dataclass(frozen=True)
class Raster:
    """Channels of one sampling rate in Hz; those at uneven time stamps are a raster of their own."""

    rate: float
    choices: list[ChannelChoice]

    @property
    def is_even(self) -> bool:
        """Whether the channels were sampled at even steps."""
        return all(choice.channel.clock is None for choice in self.choices)


@dataclass(frozen=True)
class OwnClocks:
    """Choices of channels that carry rate and start of their time stamps, and stamps (n,) in s by their column."""

    choices: list[ChannelChoice]
    stamps: Mapping[int, FloatArray] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)
    notes: tuple[NoteOrText, ...] = ()


def own_clocks(source: Source, choices: Sequence[ChannelChoice], rate: float | None = None) -> OwnClocks:
    """Read the time stamps of channels that have some of their own; of even ones rate and start are kept.

    The sampling ``rate`` in Hz, if given, is that of stamps coarser than the sampling.
    """
    clocks = {choice.channel.clock.column: choice.channel.clock for choice in choices if choice.channel.clock}
    raw = {column: next(source.blocks([column], 0), [np.empty(0)])[0] for column in clocks}
    stamps, even, faults, notes = dict[int, FloatArray](), dict[int, Clock](), list[Fault](), list[NoteOrText]()
    zero: float | None = None  # numbers of days count from that of the first
    for column, given in clocks.items():
        clock, said = clock_in_days(given, raw[column])
        zero = clock.zero if zero is None and said else zero
        scale, origin = seconds_in(clock.unit), (zero or 0.0) if said else 0.0
        stamps[column] = (raw[column] - origin) * scale
        timed_by = replace(source, time=clock)
        wrong = value_faults(stamps[column], timed_by)
        is_coarser = bool(rate) and not wrong and is_coarse(stamps[column])
        if is_coarser:
            own, wrong = _coarse_clock(stamps[column], rate or 1.0, float(raw[column][0] * scale), clock.name)
        else:
            own = Clock(1.0, 0.0) if wrong else clock_of(raw[column], None, scale=scale)
        uneven = own.times is not None
        even[column] = replace(own, start=own.start - origin * scale, times=stamps[column] if uneven else None)
        faults += wrong or (order_faults(stamps[column], timed_by) if uneven else [])
        notes += [warning(f"{clock.name} is coarser than the sampling: the rate given was taken")] * is_coarser
        notes += filter(None, [said, own.note and f"{clock.name}: {own.note}"])
        notes += () if wrong or faults else time_unit_warnings(stamps[column], timed_by)
    if faults:
        return OwnClocks(list(choices), stamps, faults)
    # Equal stamps in two columns are one raster.
    same = {column: next(at for at in stamps if np.array_equal(stamps[at], stamps[column])) for column in stamps}

    def timed(choice: ChannelChoice) -> ChannelChoice:
        if choice.channel.clock is None:
            return choice
        column = same[choice.channel.clock.column]
        own = None if even[column].times is None else clocks[column]
        channel = replace(choice.channel, rate=even[column].rate, start=even[column].start, clock=own)
        return replace(choice, channel=channel)

    return OwnClocks([timed(choice) for choice in choices], stamps, notes=tuple(notes))


def _coarse_clock(stamps: FloatArray, rate: float, begin: float, name: str) -> tuple[Clock, list[Fault]]:
    clock = coarse_clock(stamps, rate, begin)
    return (Clock(rate, begin), [replace(clock, path=("channels", name))]) if isinstance(clock, Fault) else (clock, [])


def rasters_of(choices: Sequence[ChannelChoice]) -> list[Raster]:
    """Rasters of channels by rising rate; a channel without rate belongs to each."""
    rasters: list[Raster] = []
    for choice in sorted(
        (choice for choice in choices if choice.channel.rate), key=lambda choice: choice.channel.rate or 0.0
    ):
        rate, clock = choice.channel.rate or 0.0, choice.channel.clock
        fitting = [
            raster for raster in rasters if raster.choices[0].channel.clock == clock and _is_of(choice, raster.rate)
        ]
        if fitting:
            fitting[0].choices.append(choice)
        else:
            rasters.append(Raster(rate, [choice]))
    return rasters


def in_raster(raster: Raster, choices: Sequence[ChannelChoice]) -> tuple[list[ChannelChoice], list[ChannelChoice]]:
    """Choices that belong to a raster, or have no rate, and the others, in their order."""
    columns = {choice.channel.column for choice in raster.choices}
    inside = [not choice.channel.rate or choice.channel.column in columns for choice in choices]
    kept, others = (
        [choice for choice, here in zip(choices, inside, strict=True) if here is side] for side in (True, False)
    )
    return kept, others


def own_start(choice: ChannelChoice, source: Source) -> float:
    """Time in s of the first sample of a channel."""
    return source.start if choice.channel.start is None else choice.channel.start


def is_whole(shift: float, rate: float) -> bool:
    """Whether a time in s is a whole number of sampling intervals.

    >>> is_whole(0.25, 1000.0), is_whole(0.0001, 1000.0)
    (True, False)
    """
    count = shift * rate
    return abs(count - round(count)) <= max(SAME_START, START_STEP * rate)


def cut_together(source: Source, kept: Sequence[ChannelChoice], rate: float) -> tuple[Source, list[ChannelChoice]]:
    """Channels of one rate cut to where all of them were recorded; their starts differ by whole samples.

    ``length`` of a channel is 0 where there is no time in common.
    """
    starts = [own_start(choice, source) for choice in kept]
    latest = max(starts)
    skips = {choice.channel.column: round((latest - start) * rate) for choice, start in zip(kept, starts, strict=True)}
    lengths = [choice.channel.length or 0 for choice in kept]
    if not any(skips.values()) and len(set(lengths)) < 2:
        return replace(source, rate=rate, start=latest), list(kept)
    count = max(0, min(length - skip for length, skip in zip(lengths, skips.values(), strict=True)))
    where = comma_list([_span(choice, source, rate) for choice in kept], MOST_NAMED)
    note = f"cut to where all channels were recorded, from {latest:.6g} to {latest + (count - 1) / rate:.6g} s: {where}"
    together = replace(source, blocks=_cut_blocks(source.blocks, skips, count), rate=rate, start=latest)
    cut = [replace(choice, channel=replace(choice.channel, start=latest, length=count)) for choice in kept]
    return replace(together, notes=(*together.notes, note)), cut


def _cut_blocks(blocks: Blocks, skips: Mapping[int, int], count: int) -> Blocks:
    """Reader of blocks of channels that begin with different samples, each of which is read as a whole."""

    def cut(columns: Sequence[int], size: int) -> Iterator[list[FloatArray]]:
        values = [next(blocks([column], 0))[0][skips[column] : skips[column] + count] for column in columns]
        step = size or max(count, 1)
        for first in range(0, count, step):
            yield [samples[first : first + step] for samples in values]

    return cut


def _span(choice: ChannelChoice, source: Source, rate: float) -> str:
    start = own_start(choice, source)
    return f"{choice.channel.name} from {start:.6g} to {start + ((choice.channel.length or 1) - 1) / rate:.6g} s"


def _is_of(choice: ChannelChoice, rate: float) -> bool:
    own, count = choice.channel.rate, choice.channel.length or 1
    return own is None or abs(own / rate - 1) <= max(EQUAL_RATES, SAME_START / count)


def listed(choices: Sequence[ChannelChoice], source: Source) -> str:
    """Channels with their rates and starts, for a message."""
    return comma_list([f"{choice.channel.name} ({_clock(choice, source)})" for choice in choices], MOST_NAMED)


def _clock(choice: ChannelChoice, source: Source) -> str:
    uneven = " at uneven stamps" if choice.channel.clock else ""
    return f"{choice.channel.rate or 0:g} Hz{uneven} from {own_start(choice, source):.9g} s"
