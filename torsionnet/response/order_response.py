"""What excitation by orders makes of a drivetrain over its speed: complex amplitudes, and what they sum up to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from torsionnet.core.errors import UsageError, did_you_mean
from torsionnet.response.conventions import SI, Conventions
from torsionnet.response.frequency_response import Channel, ComplexArray, FloatArray
from torsionnet.response.table import Column, Table

PER_PERIOD = 64
"""Points on a waveform for each period of its highest order."""
MOST_REVOLUTIONS, HIGHEST_LINE = 1000, 5000
"""A common cycle of more revolutions, or with more periods in it, is none that anybody waits for."""
FINEST = 10**6
"""Largest denominator of an order."""
MOST_POINTS = 4_000_000
"""Points of waveforms that are held at a time."""
RPM = 60 / (2 * math.pi)
PHASE_NOTE = "order h acts with cos(h phi + phase), phi the angle of the shaft of its excitation"


@dataclass(frozen=True)
class OrderLine:
    """One order of one excitation.

    Attributes
    ----------
    excitation : str
    order : float
        Vibrations per revolution of the shaft the excitation runs with.
    ratio : Fraction
        Revolutions of that shaft per revolution of the reference shaft, above 0.
    """

    excitation: str
    order: float
    ratio: Fraction

    @property
    def exact_order(self) -> Fraction:
        return Fraction(float(self.order)).limit_denominator(FINEST)

    @property
    def relative(self) -> Fraction:
        """Vibrations per revolution of the reference shaft."""
        return self.exact_order * self.ratio

    def __str__(self) -> str:
        return f"{self.excitation} {self.order:g}"


@dataclass(frozen=True, eq=False)
class OrderResponse:
    """Complex amplitudes by speed, order and output.

    Attributes
    ----------
    speeds : (n_speeds,) array
        Of the reference shaft, rad/s.
    reference : str
        Its node.
    lines : tuple of OrderLine
    values : (n_speeds, n_lines, n_out) complex array
        Peak amplitudes X_h of x(t) = Re sum_h X_h exp(j h phi), SI units.
    outputs : tuple of Channel
    title : str
        The model with its configuration.
    """

    speeds: FloatArray
    reference: str
    lines: tuple[OrderLine, ...]
    values: ComplexArray
    outputs: tuple[Channel, ...]
    title: str = ""

    @property
    def rpm(self) -> FloatArray:
        """Speeds of the reference shaft, r/min."""
        return np.asarray(self.speeds * RPM)

    @cached_property
    def revolutions(self) -> int | None:
        """Revolutions of the reference shaft after which everything repeats; None where that takes too long."""
        return _common_cycle([line.relative for line in self.lines])

    def output(self, name: str | None = None) -> int:
        """Place of an output by its name; of the only one without.

        Raises
        ------
        UsageError
            No such output, or several and no name.
        """
        names = [channel.name for channel in self.outputs]
        if name is None and len(names) == 1:
            return 0
        if name not in names:
            what = f'no output is named "{name}"{did_you_mean(str(name), names)}' if name else "say which output"
            raise UsageError(f"{what}; there are {', '.join(names)}")
        return names.index(name)

    def of_order(self, order: float, output: str | None = None, excitation: str | None = None) -> ComplexArray:
        """Amplitudes over speed, shape (n_speeds,), of an order; several excitations of one shaft are added.

        Raises
        ------
        UsageError
            Nothing has this order, or shafts of different speeds have it and no excitation is named.
        """
        found = [
            place
            for place, line in enumerate(self.lines)
            if math.isclose(line.order, order) and excitation in (None, line.excitation)
        ]
        if not found:
            raise UsageError(f"no order {order:g} acts; there are {', '.join(map(str, self.lines))}")
        if len({self.lines[place].relative for place in found}) > 1:
            names = " and ".join(self.lines[place].excitation for place in found)
            raise UsageError(f"order {order:g} of {names} is not one frequency; say which excitation")
        return np.asarray(self.values[:, found, self.output(output)].sum(axis=1))

    def waveform(self, output: str | None = None, points: int | None = None) -> tuple[FloatArray, FloatArray]:
        """The sum of all orders over the common cycle, with their phases.

        Returns
        -------
        angle : (n,) array
            Of the reference shaft, rad.
        values : (n_speeds, n) array

        Raises
        ------
        UsageError
            There is no common cycle.
        """
        cycle = self._cycle()
        place = self.output(output)
        waves = _synthesised(self._spectrum(range(len(self.lines)), cycle)[:, :, place : place + 1], points)[:, 0]
        return 2 * np.pi * cycle * np.arange(waves.shape[1]) / waves.shape[1], waves

    @cached_property
    def half_range(self) -> FloatArray:
        """(max - min)/2 of the sum of all orders over the common cycle, shape (n_speeds, n_out).

        Where there is none, shafts take every position to each other sooner or later: their half ranges add up. Of a
        shaft without a cycle of its own it is the sum of the magnitudes.
        """
        if self.revolutions is not None:
            return self._half_range(range(len(self.lines)), self.revolutions)
        total = np.zeros((len(self.speeds), len(self.outputs)))
        for ratio in dict.fromkeys(line.ratio for line in self.lines):
            places = [place for place, line in enumerate(self.lines) if line.ratio == ratio]
            cycle = _common_cycle([self.lines[place].exact_order for place in places])
            alone = np.abs(self.values[:, places]).sum(axis=1)
            total += self._half_range(places, cycle / ratio) if cycle else alone
        return total

    def _half_range(self, places: Sequence[int], cycle: Fraction | int) -> FloatArray:
        spectrum = self._spectrum(places, cycle)
        together = max(1, MOST_POINTS // (PER_PERIOD * spectrum.shape[1] * spectrum.shape[2]))
        found = []
        for start in range(0, len(spectrum), together):
            waves = _synthesised(spectrum[start : start + together])
            found.append((_highest(waves) + _highest(-waves)) / 2)
        return np.concatenate(found)

    @cached_property
    def rms(self) -> FloatArray:
        """Root mean square of the sum of all orders, shape (n_speeds, n_out)."""
        return np.asarray(np.sqrt((np.abs(self._by_frequency()) ** 2).sum(axis=1) / 2))

    def table(self, output: str | None = None, conventions: Conventions = SI, most: int = 6) -> Table:
        """Worst speed of an output and the orders that make it, and the worst speed of each of these orders."""
        place = self.output(output)
        channel, total = self.outputs[place], self.half_range[:, place]
        scale, worst = conventions.scale(channel.unit), int(np.argmax(total))
        sizes = np.abs(self.values[:, :, place])
        chosen = np.argsort(-sizes.max(axis=0), kind="stable")[:most]
        exact = self.revolutions is not None
        first = "synthesised, half range" if exact else "half ranges of the shafts, added"
        rows: list[tuple[object, ...]] = [(first, self.rpm[worst], total[worst] * scale, total[worst] * scale)]
        for line in chosen.tolist():
            at = int(np.argmax(sizes[:, line]))
            rows.append((str(self.lines[line]), self.rpm[at], sizes[at, line] * scale, sizes[worst, line] * scale))
        unit = conventions.unit(channel.unit)
        columns = (
            Column("order"),
            Column("speed", "rpm"),
            Column("largest", unit),
            Column(f"at {self.rpm[worst]:.6g} rpm", unit),
        )
        notes = [f"speeds of {self.reference}; peak amplitudes; {PHASE_NOTE}"]
        if exact:
            notes.append(
                f"common cycle: {self.revolutions} revolution{'s' * (self.revolutions != 1)} of {self.reference}"
            )
        else:
            notes.append("the shafts have no short common cycle: their half ranges add up sooner or later")
        if len(chosen) < len(self.lines):
            notes.append(f"{len(chosen)} of {len(self.lines)} orders, the largest")
        return Table(f"{self.title}: {channel.name}", columns, tuple(rows), tuple(notes))

    def long_table(self) -> Table:
        """Every amplitude: speed, excitation, order, then real and imaginary part of each output; SI."""
        names = [(channel.name, part) for channel in self.outputs for part in ("real", "imag")]
        columns = [Column("speed", "rpm"), Column("excitation"), Column("order"), Column("frequency", "Hz")]
        columns += [Column(f"{name} {part}", self.outputs[place // 2].unit) for place, (name, part) in enumerate(names)]
        rows = []
        for number, speed in enumerate(self.speeds.tolist()):
            for place, line in enumerate(self.lines):
                cells = self.values[number, place]
                parts = [part for value in cells.tolist() for part in (value.real, value.imag)]
                f = speed * float(line.relative) / (2 * math.pi)
                rows.append((speed * RPM, line.excitation, line.order, f, *parts))
        notes = (f"speeds of {self.reference}; {PHASE_NOTE}",)
        return Table(f"{self.title}: order response", tuple(columns), tuple(rows), notes)

    def _cycle(self) -> int:
        if self.revolutions is None:
            raise UsageError("the shafts have no short common cycle; half_range adds up theirs")
        return self.revolutions

    def _by_frequency(self) -> ComplexArray:
        """Lines of one frequency summed, shape (n_speeds, n_frequencies, n_out)."""
        places = {
            relative: number for number, relative in enumerate(dict.fromkeys(line.relative for line in self.lines))
        }
        found = np.zeros((len(self.speeds), len(places), len(self.outputs)), dtype=complex)
        for number, line in enumerate(self.lines):
            found[:, places[line.relative]] += self.values[:, number]
        return found

    def _spectrum(self, places: Sequence[int], cycle: Fraction | int) -> ComplexArray:
        """Amplitudes of some lines by their periods in so many revolutions."""
        counts = {place: int(self.lines[place].relative * cycle) for place in places}
        shape = (len(self.speeds), max(counts.values(), default=0) + 1, len(self.outputs))
        found = np.zeros(shape, dtype=complex)
        for place, count in counts.items():
            found[:, count] += self.values[:, place]
        return found


def _common_cycle(relatives: Sequence[Fraction]) -> int | None:
    """Revolutions that hold a whole number of periods of each; None where that is too many."""
    cycle = math.lcm(*(relative.denominator for relative in relatives))
    highest = max(relatives, default=Fraction(0))
    return cycle if cycle <= MOST_REVOLUTIONS and cycle * highest <= HIGHEST_LINE else None


def _synthesised(spectrum: ComplexArray, points: int | None = None) -> FloatArray:
    """Re sum_k X_k exp(j k phi) at even steps, shape (n_speeds, n_out, n)."""
    highest = spectrum.shape[1] - 1
    n = points or _even_steps(PER_PERIOD * max(highest, 1))
    if n <= 2 * highest:
        raise UsageError(f"{n} points do not show {highest} periods; take more than {2 * highest}")
    # Waves that lie in one piece are transformed and searched in less than half the time.
    return np.asarray(np.fft.irfft(np.ascontiguousarray(spectrum.transpose(0, 2, 1)), n) * (n / 2))


def _even_steps(least: int) -> int:
    """At least so many, and a number for which the Fourier transform is fast."""
    return min(factor << max(0, math.ceil(math.log2(least / factor))) for factor in (1, 3, 5))


def _highest(waves: FloatArray) -> FloatArray:
    """Largest value along the cycle, by the parabola through the largest point and its neighbours."""
    at = np.argmax(waves, axis=-1)[:, :, None]
    n = waves.shape[-1]
    before, peak, after = (np.take_along_axis(waves, (at + step) % n, axis=-1)[:, :, 0] for step in (-1, 0, 1))
    curvature = before - 2 * peak + after
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where(curvature < 0, (before - after) ** 2 / (-8 * curvature), 0)
    return np.asarray(peak + rise)
