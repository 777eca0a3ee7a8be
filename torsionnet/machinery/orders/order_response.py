"""Order response of a drivetrain, complex amplitudes by speed, order and output, and their sum over a cycle."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import SavedResult
from torsionnet.base.table import Column, Table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import Channel, ComplexArray, FloatArray
from torsionnet.machinery.orders.engine_angles import at_worst_angles
from torsionnet.machinery.orders.order_line import (
    OrderLine,
    engine_blocks,
    has_unknown_angles,
    lines_of_one_frequency,
    near_fraction,
    sum_name,
    summed_sizes,
    sums_of_lines,
)
from torsionnet.machinery.orders.synthesis import common_cycle, cycle_extremes, waveforms

if TYPE_CHECKING:
    import pandas

SUMS_NOTE = "sums of lines of one frequency, with their phases, are what a test measures"
"""Text of the note below tables with sums of order lines of one frequency."""
PHASE_NOTE = "order h acts with cos(h phi + phase), phi the angle of the shaft of its excitation"
"""Text of the note on the phase of orders below tables."""

NOT_MET = "at some speeds no motion was found that is stable"
"""Text of the remark on values of which some are those of a motion that is not met."""


@runtime_checkable
class MeanValues(Protocol):
    """Protocol of mean values in SI, shape (n_speeds, n_out), with their speeds and outputs, as of a mean response."""

    @property
    def speeds(self) -> FloatArray: ...

    @property
    def values(self) -> FloatArray: ...

    @property
    def outputs(self) -> tuple[Channel, ...]: ...


@dataclass(frozen=True, eq=False, repr=False)
class OrderResponse(SavedResult):
    """Order response of a drivetrain, complex amplitudes in SI by speed, order line and output.

    Attributes
    ----------
    speeds : (n_speeds,) array
        Speeds of the reference shaft, rad/s.
    reference : str
        Node of the reference shaft.
    lines : tuple of OrderLine
    values : (n_speeds, n_lines, n_out) complex array
        Peak amplitudes X_h of x(t) = Re sum_h X_h exp(j h phi), SI units.
    outputs : tuple of Channel
    title : str
        Name of the model with its configuration.
    notes : tuple of str
        Remarks, as on the operating point of laws of motion.
    """

    picture: ClassVar[str] = "order_response"

    speeds: FloatArray
    reference: str
    lines: tuple[OrderLine, ...]
    values: ComplexArray
    outputs: tuple[Channel, ...]
    title: str = ""
    notes: tuple[str, ...] = field(default=(), kw_only=True)

    @property
    def rpm(self) -> FloatArray:
        """Speeds of the reference shaft in r/min, shape (n_speeds,)."""
        return np.asarray(self.speeds * RPM)

    @property
    def frequencies(self) -> FloatArray:
        """Frequencies of the order lines in Hz, shape (n_speeds, n_lines); negative for a slip above synchronism."""
        relative = np.array([float(line.relative) for line in self.lines])
        fixed = np.array([line.fixed for line in self.lines])
        return np.asarray(self.speeds[:, None] * relative / (2 * math.pi) + fixed)

    @property
    def sizes(self) -> FloatArray:
        """Amplitude of each order line in SI units of the outputs, shape (n_speeds, n_lines, n_out).

        The largest one if there are several cases.
        """
        return np.abs(self.values)

    @property
    def case_responses(self) -> tuple[OrderResponse, ...]:
        """Order responses of single cases (firing conditions), or this response if there is one case only."""
        return (self,)

    @property
    def case_values(self) -> tuple[ComplexArray, ...]:
        """Arrays (n_speeds, n_lines, n_out) of complex amplitudes in SI, one for each firing condition.

        Empty if there is one only.
        """
        return ()

    @cached_property
    def revolutions(self) -> int | None:
        """Number of revolutions of the reference shaft after which the sum of all order lines repeats.

        None without a cycle.
        """
        # A fixed frequency has no whole number of periods in any number of revolutions, and engines at unknown angles
        # have no one sum to repeat.
        if any(line.fixed for line in self.lines) or len(engine_blocks(self.lines)) > 1:
            return None
        return common_cycle([line.relative for line in self.lines])

    def output(self, name: str | None = None) -> int:
        """Index of an output of the order response by its name, or of the only output without one.

        Raises
        ------
        UsageError
            There is no such output, or there are several and none is named.
        """
        names = [channel.name for channel in self.outputs]
        if name is None and len(names) == 1:
            return 0
        if name not in names:
            what = f'no output is named "{name}"{did_you_mean(str(name), names)}' if name else "say which output"
            raise UsageError(f"{what}; there are {', '.join(names)}", kind="unknown-channel")
        return names.index(name)

    def of_order(self, order: float, output: str | None = None, excitation: str | None = None) -> ComplexArray:
        """Complex amplitudes of an order in SI units of the output over speed, shape (n_speeds,).

        Several excitations of one shaft are added.

        Raises
        ------
        UsageError
            No excitation has this order, or shafts of different speeds have it and no excitation is named.
        """
        places = [
            place
            for place, line in enumerate(self.lines)
            if not line.fixed and math.isclose(line.order, order) and excitation in (None, line.excitation)
        ]
        if not places:
            raise UsageError(
                f"no order {order:g} acts; there are {', '.join(map(str, self.lines))}", kind="unknown-order"
            )
        if len({self.lines[place].relative for place in places}) > 1:
            names = " and ".join(self.lines[place].excitation for place in places)
            raise UsageError(
                f"order {order:g} of {names} is not one frequency; say which excitation", kind="ambiguous-name"
            )
        # Lines of one order and speed keep their phases to each other: complex values add.
        return np.asarray(self.values[:, places, self.output(output)].sum(axis=1))

    def amplitude_of_order(self, order: float, output: str | None = None) -> FloatArray:
        """Largest possible amplitude of an order of all excitations in SI units of the output, shape (n_speeds,).

        Excitations are added with their phases, engines without a known angle between them by their magnitudes.

        Raises
        ------
        UsageError
            As of :meth:`of_order`.
        """
        own = self.of_order(order, output)  # refuses unknown orders and orders of several frequencies
        blocks = engine_blocks(self.lines)
        if len(blocks) == 1:
            return np.abs(own)
        place = self.output(output)
        has_it = [not line.fixed and math.isclose(line.order, order) for line in self.lines]
        each = [self.values[:, [at for at in block.places if has_it[at]], place].sum(axis=1) for block in blocks]
        # One order of engines at a free angle to each other: sum of |X|, which some angle reaches.
        return np.asarray(np.abs(each).sum(axis=0))

    def of_frequency(self, frequency: float, output: str | None = None, excitation: str | None = None) -> ComplexArray:
        """Complex amplitudes of a fixed frequency in SI units of the output over speed, shape (n_speeds,).

        Raises
        ------
        UsageError
            No excitation has this frequency.
        """
        places = [
            place
            for place, line in enumerate(self.lines)
            if not line.order and math.isclose(line.fixed, frequency) and excitation in (None, line.excitation)
        ]
        if not places:
            raise UsageError(
                f"nothing acts at {frequency:g} Hz; there are {', '.join(map(str, self.lines))}", kind="unknown-order"
            )
        return np.asarray(self.values[:, places, self.output(output)].sum(axis=1))

    def waveform(self, output: str | None = None, points: int | None = None) -> tuple[FloatArray, FloatArray]:
        """Angles in rad over a common cycle (n,), and at them the sum of all orders of an output in SI, (n_speeds, n).

        Returns
        -------
        angle : (n,) array
            Angle of the reference shaft, rad.
        values : (n_speeds, n) array

        Raises
        ------
        UsageError
            There is no common cycle.
        """
        cycle = self._cycle()
        place = self.output(output)
        counts = [int(line.relative * cycle) for line in self.lines]
        waves = waveforms(self._spectrum(range(len(self.lines)), counts)[:, :, place : place + 1], points)[:, 0]
        return 2 * np.pi * cycle * np.arange(waves.shape[1]) / waves.shape[1], waves

    @property
    def bounds(self) -> FloatArray:
        """Largest and smallest sum of all order lines over a cycle, SI units of outputs, shape (2, n_speeds, n_out).

        Without a common cycle, shafts and sources of fixed frequencies take every position to each other sooner or
        later: their extremes add up. Lines without a cycle of their own add their magnitudes. Engines of one speed with
        an unknown angle between them are at the angle of largest (max - min)/2; extremes of other engines add up.
        """
        return self._bounds(range(len(self.outputs)))

    def _bounds(self, places: Sequence[int]) -> FloatArray:
        """Bounds of outputs by their indices, shape (2, n_speeds, n_places); those of each are worked out once."""
        missing = [place for place in places if place not in self._known_bounds]
        if missing:
            values, lines = self.values[:, :, missing], self.lines
            if has_unknown_angles(lines):
                worst = at_worst_angles(values, lines)
                values, lines = worst.values, worst.lines
            bounds = np.zeros((2, len(self.speeds), len(missing)))
            for family, counts in _families(lines):
                # Phases without a cycle drift through all positions: the extremes are +-sum |X|.
                alone = np.abs(values[:, family]).sum(axis=1)
                bounds += [alone, -alone] if counts is None else cycle_extremes(values[:, family], counts)
            self._known_bounds.update(zip(missing, np.moveaxis(bounds, 2, 0), strict=True))
        known = [self._known_bounds[place] for place in places]
        return np.stack(known, axis=2) if known else np.zeros((2, len(self.speeds), 0))

    @cached_property
    def _known_bounds(self) -> dict[int, FloatArray]:
        return {}

    @property
    def unmet(self) -> NDArray[np.bool_]:
        """Whether no motion is known at a speed that can be met, shape (n_speeds,); a linear response always is one."""
        return np.zeros(len(self.speeds), dtype=bool)

    @property
    def half_range(self) -> FloatArray:
        """Half range (max - min)/2 of the sum of all orders in SI units of the outputs, shape (n_speeds, n_out)."""
        return half_ranges_of(self, range(len(self.outputs)))

    @property
    def peak_to_peak(self) -> FloatArray:
        """Range (max - min) of the sum of all orders in SI units of the outputs, shape (n_speeds, n_out)."""
        return 2 * self.half_range

    @property
    def peak(self) -> FloatArray:
        """Largest deviation of the sum of all orders from its mean in SI units of outputs, shape (n_speeds, n_out)."""
        return np.asarray(np.abs(self.bounds).max(axis=0))

    def extremes(self, mean: ArrayLike | MeanValues) -> tuple[FloatArray, FloatArray]:
        """Largest and smallest value of mean plus vibration in SI units of the outputs, each (n_speeds, n_out).

        Parameters
        ----------
        mean : MeanResponse, or (n_speeds, n_out) or (n_out,) array
            Mean values of the outputs, SI.

        Raises
        ------
        UsageError
            Another shape, or a mean response of other speeds or outputs.
        """
        if isinstance(mean, MeanValues):
            same = len(mean.speeds) == len(self.speeds) and np.allclose(mean.speeds, self.speeds, rtol=1e-9)
            if not same or [channel.name for channel in mean.outputs] != [channel.name for channel in self.outputs]:
                raise UsageError(
                    "the mean values have other speeds or outputs than the order response; calculate both for the same",
                    kind="unlike-results",
                )
        given = np.asarray(mean.values if isinstance(mean, MeanValues) else mean, dtype=float)
        if given.shape not in (self.bounds.shape[1:], self.bounds.shape[2:]):
            size = f"{len(self.speeds)} speeds and {len(self.outputs)} outputs"
            raise UsageError(f"the response has {size}, but the mean has the shape {given.shape}", kind="wrong-count")
        high, low = self.bounds + given
        return np.asarray(high), np.asarray(low)

    @cached_property
    def rms(self) -> FloatArray:
        """Root mean square of the sum of all orders in SI units of the outputs, shape (n_speeds, n_out).

        Of several cases, that of the case with the largest half range.
        """
        # Parseval: x_rms^2 = sum |X_f|^2/2 over different frequencies, hence lines of one frequency are added first.
        return np.asarray(np.sqrt((np.abs(self.by_frequency()) ** 2).sum(axis=1) / 2))

    def notebook_tables(self) -> tuple[Table, ...]:
        """Tables of the largest orders of every output, as a notebook shows them."""
        return tuple(self.table(channel.name) for channel in self.outputs)

    def table(self, output: str | None = None, conventions: Conventions = SI, most: int = 6) -> Table:
        """Table of an output's largest half range and largest orders, with the speeds in rpm at which they occur."""
        place = self.output(output)
        channel, total = self.outputs[place], self.half_range[:, place]
        scale, worst = conventions.scale(channel.unit), int(np.argmax(total))
        sizes, shown = self.sizes[:, :, place], np.abs(self.values[worst, :, place])
        # Ranked by the peak of each order wherever it lies, not by its share at the speed of the largest sum.
        chosen = np.argsort(-sizes.max(axis=0), kind="stable")[:most]
        exact = self.revolutions is not None
        first = "synthesised, half range" if exact else f"half ranges {self._of_whom}, added"
        rows: list[tuple[object, ...]] = [(first, self.rpm[worst], total[worst] * scale, total[worst] * scale)]
        for line in chosen.tolist():
            at = int(np.argmax(sizes[:, line]))
            rows.append((str(self.lines[line]), self.rpm[at], sizes[at, line] * scale, shown[line] * scale))
        sums = [places for places in lines_of_one_frequency(self.lines) if len(places) > 1 and {*places} & {*chosen}]
        rows += [self._sum_row(places, place, worst, scale) for places in sums]
        unit = conventions.unit(channel.unit)
        columns = (
            Column("order"),
            Column("speed", "rpm"),
            Column("largest", unit),
            Column(f"at {self.rpm[worst]:.6g} rpm", unit),
        )
        notes = [f"speeds of {self.reference}; peak amplitudes; {self._phases}"]
        if exact:
            notes.append(
                f"common cycle: {self.revolutions} revolution{'s' * (self.revolutions != 1)} of {self.reference}"
            )
        else:
            notes.append(self.no_cycle)
        if sums:
            notes.append(SUMS_NOTE)
        if len(chosen) < len(self.lines):
            notes.append(f"{len(chosen)} of {len(self.lines)} orders, the largest")
        return Table(f"{self.title}: {channel.name}", columns, tuple(rows), (*notes, *self.notes))

    def _sum_row(self, places: list[int], output: int, worst: int, scale: float) -> tuple[object, ...]:
        number = lines_of_one_frequency(self.lines).index(places)
        sizes = summed_sizes(self)[:, number, output]
        at, shown = int(np.argmax(sizes)), abs(self.values[worst, places, output].sum())
        return (sum_name([self.lines[place] for place in places]), self.rpm[at], sizes[at] * scale, shown * scale)

    def to_dataframe(self) -> pandas.DataFrame:
        """All orders at all speeds as a pandas.DataFrame, the columns of :meth:`long_table`."""
        return self.long_table().to_dataframe()

    def long_table(self) -> Table:
        """Table of real and imaginary parts of all order amplitudes in SI, a row per speed in rpm and order line.

        Lines of one frequency, such as of an engine and of the propeller on its shaft, have a row each and, after the
        other lines of that speed, a row for their sum with its order of the reference shaft.
        """
        names = [(channel.name, part) for channel in self.outputs for part in ("real", "imag")]
        columns = [Column("speed", "rpm"), Column("excitation"), Column("order"), Column("frequency", "Hz")]
        columns += [Column(f"{name} {part}", self.outputs[place // 2].unit) for place, (name, part) in enumerate(names)]
        sums = sums_of_lines(self.lines)
        kinds = [(line.excitation, line.order, [place]) for place, line in enumerate(self.lines)]
        kinds += [(line_sum.name, line_sum.order, [*line_sum.places]) for line_sum in sums]
        rows = []
        for number, speed in enumerate(self.speeds.tolist()):
            for name, order, places in kinds:
                cells, line = self.values[number, places].sum(axis=0), self.lines[places[0]]
                parts = [part for value in cells.tolist() for part in (value.real, value.imag)]
                f = abs(speed * float(line.relative) / (2 * math.pi) + line.fixed)
                rows.append((speed * RPM, name, order, f, *parts))
        notes = [f"speeds of {self.reference}; {self._phases}", *([SUMS_NOTE] if sums else [])]
        return Table(f"{self.title}: order response", tuple(columns), tuple(rows), (*notes, *self.notes))

    @property
    def no_cycle(self) -> str:
        """Sentence on why the order lines have no common cycle, for responses without a cycle."""
        engines = [block.engine for block in engine_blocks(self.lines)]
        if len(engines) > 1:
            return f"{' and '.join(engines)} turn at unequal speeds with no phase between them: half ranges are added"
        if any(line.fixed for line in self.lines):
            return "lines that do not follow the speed have no common cycle with it: half ranges add up sooner or later"
        return "the shafts have no short common cycle: their half ranges add up sooner or later"

    @property
    def engine_notes(self) -> tuple[str, ...]:
        """Notes on the angles assumed between engines where the model gives none."""
        return (self.no_cycle,) if len(engine_blocks(self.lines)) > 1 else ()

    @property
    def _phases(self) -> str:
        if not any(line.fixed for line in self.lines):
            return PHASE_NOTE
        return f"{PHASE_NOTE}; a frequency f beside it adds 2 pi f t"

    @property
    def sum_label(self) -> str:
        """Text of a legend for the curve of all orders together: their half range, and how it is meant.

        Where shafts have no short common cycle the half ranges of each are added: the worst position to each other.
        """
        if self.revolutions is not None:
            return "all orders, half range"
        where = "worst timing" if any(line.fixed for line in self.lines) else "worst position of shafts"
        return f"all orders, half range, {where}"

    @property
    def _of_whom(self) -> str:
        return "of speed and fixed frequencies" if any(line.fixed for line in self.lines) else "of the shafts"

    def _cycle(self) -> int:
        if self.revolutions is None:
            raise UsageError(f"{self.no_cycle}; use half_range", kind="no-period")
        return self.revolutions

    def by_frequency(self) -> ComplexArray:
        """Complex amplitudes in SI, order lines of one frequency summed, shape (n_speeds, n_frequencies, n_out)."""
        frequencies = [(line.relative, line.fixed) for line in self.lines]
        places = {frequency: number for number, frequency in enumerate(dict.fromkeys(frequencies))}
        summed = np.zeros((len(self.speeds), len(places), len(self.outputs)), dtype=complex)
        for number, frequency in enumerate(frequencies):
            summed[:, places[frequency]] += self.values[:, number]
        return summed

    def _spectrum(self, places: Sequence[int], counts: Sequence[int]) -> ComplexArray:
        """Complex amplitudes (SI) by number of periods in a cycle, shape (n_speeds, highest count + 1, n_out)."""
        shape = (len(self.speeds), max(counts, default=0) + 1, len(self.outputs))
        spectrum = np.zeros(shape, dtype=complex)
        for place, count in zip(places, counts, strict=True):
            spectrum[:, count] += self.values[:, place]
        return spectrum


def half_ranges_of(run: OrderResponse, places: Sequence[int]) -> FloatArray:
    """Half ranges in SI units of some outputs of a response, by their indices, shape (n_speeds, n_places)."""
    bounds = run._bounds(places)  # noqa: SLF001  # not for users, who name outputs
    return np.asarray((bounds[0] - bounds[1]) / 2)


def _families(lines: Sequence[OrderLine]) -> Iterator[tuple[list[int], list[int] | None]]:
    """Yield indices of order lines of fixed phases to each other, and their periods in a common cycle, or None.

    A group holds all lines of engines at known angles if these have a cycle; otherwise the lines of each shaft,
    those of all fixed frequencies (assumed to come from one electrical line), and each slip alone.
    """
    for block in engine_blocks(lines):
        relatives = [lines[place].relative for place in block.places]
        has_fixed = any(lines[place].fixed for place in block.places)
        cycle = None if has_fixed else common_cycle(relatives)
        if cycle is None:
            yield from _by_shaft(lines, block.places)
        else:
            yield [*block.places], [int(relative * cycle) for relative in relatives]


def _by_shaft(lines: Sequence[OrderLine], block: Sequence[int]) -> Iterator[tuple[list[int], list[int] | None]]:
    families: dict[object, list[int]] = {}
    for place in block:
        line = lines[place]
        # Lines locked to each other: those of one shaft, all constant frequencies, and a slip with lines of the
        # same slip.
        family = ("fixed" if not line.order else (line.relative, line.fixed)) if line.fixed else line.ratio
        families.setdefault(family, []).append(place)
    for places in families.values():
        some = [lines[place] for place in places]
        if some[0].fixed and some[0].order:
            yield places, None
            continue
        rates = [near_fraction(line.fixed) if line.fixed else line.exact_order for line in some]
        # Constant frequencies have no revolutions: their common cycle is counted in periods of the highest one.
        top = max(rates)
        cycle = common_cycle([rate / top for rate in rates] if some[0].fixed else rates)
        if cycle is None:
            yield places, None
        else:
            yield places, [int(rate / top * cycle if some[0].fixed else rate * cycle) for rate in rates]
