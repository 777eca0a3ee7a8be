"""Periodic motions found over frequency or speed, with their stability, the places where they turn, and notes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Annotated, ClassVar, Literal

import numpy as np

from torsionnet.base.conventions import SI, Conventions
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.packages import SavedResult
from torsionnet.base.result_rows import Out
from torsionnet.base.table import Table, result_table
from torsionnet.base.units import RPM
from torsionnet.linear.frequency_response import Channel, ComplexArray, FloatArray
from torsionnet.model.motion_laws.smooth_curves import CubicCurve
from torsionnet.motion.periodic.all_branches import FoundBranch

# Periodic motions found over frequency or speed, with their stability and the places where they turn.

EDGES = ("fold", "doubling", "symmetry", "second frequency")
"""Kinds of places at which a motion lies on the edge of stability."""


@dataclass(frozen=True, eq=False)
class FoundMotion:
    """Periodic motion at one frequency or speed.

    Attributes
    ----------
    at : float
        Frequency in Hz or speed in rad/s.
    branch : int
        Number of its branch.
    turn : str
        ``"fold"``, ``"doubling"``, ``"symmetry"`` (lopsided motions begin) or ``"second frequency"`` (Neimark-Sacker)
        where the branch turns there, ``"peak"`` where an output swings further than at the places beside it; empty at
        a place that was asked for.
    periods : int
        Periods of the torques after which it repeats.
    harmonics : int
        Harmonics of its own period that were taken.
    left_out : float
        What further harmonics would move, over the peak to peak of a law.
    lowest, highest : (n_out,) arrays
        SI units of the outputs.
    amplitudes : (n, n_out) complex array
        One-sided harmonics of its own period in SI units, the mean first.
    multipliers : (m,) complex array
        The largest first; none where they are not determined.
    stability : str
    angles, speeds : mapping
        Node -> rad and rad/s at the beginning of the period, where a simulation may start.
    """

    at: float
    branch: int
    turn: str
    periods: int
    harmonics: int
    left_out: float
    lowest: FloatArray
    highest: FloatArray
    amplitudes: ComplexArray
    multipliers: ComplexArray
    stability: str
    angles: Mapping[str, float] = field(default_factory=dict)
    speeds: Mapping[str, float] = field(default_factory=dict)

    @property
    def on_edge(self) -> bool:
        """Whether the branch turns here, so that the motion lies on the edge of stability."""
        return self.turn in EDGES

    @property
    def is_stable(self) -> bool | None:
        """Whether the motion is stable; None where it is neutral or that is not determined."""
        return None if self.stability.startswith(("stability not", "neutral")) else self.stability == "stable"


@dataclass(frozen=True, eq=False)
class PlacedMotion:
    """Periodic motion at its frequency or speed, seen at an output."""

    at: Annotated[float, Out("frequency or speed", unit_of="at_unit", digits=8)]
    at_unit: Annotated[str, Out("in")]
    branch: Annotated[int, Out("branch")]
    what: Annotated[str, Out("what")]
    output: Annotated[str, Out("output")]
    lowest: Annotated[float, Out("lowest", unit_of="unit", digits=6)]
    highest: Annotated[float, Out("highest", unit_of="unit", digits=6)]
    peak_to_peak: Annotated[float, Out("peak to peak", unit_of="unit", digits=6)]
    unit: Annotated[str, Out("unit", unit_of="unit")]
    stability: Annotated[str, Out("stability")]
    multiplier: Annotated[str, Out("largest multiplier")]
    harmonics: Annotated[int, Out("harmonics")]


@dataclass(frozen=True, eq=False, repr=False)
class PeriodicResponse(SavedResult):
    """Periodic motions of a drivetrain over frequency or speed, all that were found, with their stability.

    Attributes
    ----------
    over : {"frequency", "speed"}
        What ``at`` of the motions is: Hz, or rad/s of ``reference``.
    reference : str
        Node of the speeds, empty over frequency.
    order : float
        Order of harmonic 1 of the torques at the reference; 1 over frequency.
    outputs : tuple of Channel
    motions : tuple of FoundMotion
        Branch by branch, each in its order, with the places where it turns.
    ways : tuple of str
        How each branch was found.
    title : str
    notes : tuple of str
    """

    picture: ClassVar[str] = "periodic_response"
    SHOWN: ClassVar = ("title", "rows", "shown_jumps", "sentences")

    over: Literal["frequency", "speed"]
    reference: str
    order: float
    outputs: tuple[Channel, ...]
    motions: tuple[FoundMotion, ...]
    ways: tuple[str, ...]
    title: str = ""
    notes: tuple[str, ...] = field(default=(), kw_only=True)

    def output(self, name: str | None = None) -> int:
        """Index of an output by its name, or of the only output without one.

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

    def motions_at(self, at: float) -> tuple[FoundMotion, ...]:
        """Motions at a frequency in Hz or speed in rad/s that was asked for."""
        return tuple(motion for motion in self.motions if not motion.turn and math.isclose(motion.at, at, rel_tol=1e-9))

    def stable_at(self, at: float) -> tuple[FoundMotion, ...]:
        """Stable motions at a frequency in Hz or speed in rad/s that was asked for: those that can be met."""
        return tuple(motion for motion in self.motions_at(at) if motion.is_stable)

    def turns(
        self, kind: Literal["fold", "doubling", "symmetry", "second frequency"] | None = None
    ) -> tuple[FoundMotion, ...]:
        """Motions at which branches turn, or those of one kind, as folds and onsets of a second frequency."""
        return tuple(motion for motion in self.motions if motion.on_edge and kind in (None, motion.turn))

    @property
    def peaks(self) -> tuple[FoundMotion, ...]:
        """Motions between places asked for at which an output swings further than at those beside it."""
        return tuple(motion for motion in self.motions if motion.turn == "peak")

    def peak_to_peak(self, motion: FoundMotion, output: str | None = None) -> float:
        """Highest less lowest value of an output in a motion, in SI units."""
        place = self.output(output)
        return float(motion.highest[place] - motion.lowest[place])

    def amplitude_of_order(self, motion: FoundMotion, order: float, output: str | None = None) -> float:
        """Amplitude in SI units of an order, over frequency of a multiple of it, in a motion; 0 where it has none."""
        harmonic = order * motion.periods / self.order
        number = round(harmonic)
        if not math.isclose(harmonic, number, abs_tol=1e-6) or number >= len(motion.amplitudes):
            return 0.0
        return float(np.abs(motion.amplitudes[number, self.output(output)]))

    @property
    def jumps(self) -> tuple[tuple[str, float], ...]:
        """Jumps of slow sweeps: "run-up" or "run-down", and the frequency in Hz or speed in rad/s where it jumps.

        A stable motion ends at a fold: at the highest place of a branch a run-up leaves it, at the lowest a run-down.
        """
        jumps = []
        for before, fold, after in zip(self.motions, self.motions[1:], self.motions[2:], strict=False):
            if (
                fold.turn == "fold"
                and before.branch == fold.branch == after.branch
                and (before.is_stable or after.is_stable)
            ):
                jumps.append(("run-up" if fold.at >= max(before.at, after.at) else "run-down", fold.at))
        return tuple(jumps)

    def shown(self, at: float) -> float:
        """Frequency in Hz, or speed in rpm, of a place."""
        return at * RPM if self.over == "speed" else at

    @property
    def unit(self) -> str:
        """Unit in which places are shown."""
        return "rpm" if self.over == "speed" else "Hz"

    def table(self, conventions: Conventions = SI) -> Table:
        """Table of all motions with extremes, stability and largest multiplier of every output."""
        title = f"{self.title}: periodic motions"
        return result_table(title, self.rows, PlacedMotion, conventions=conventions, notes=self.sentences)

    @property
    def rows(self) -> Annotated[tuple[PlacedMotion, ...], Out(json="motions")]:
        """Rows of all motions, one for each output."""
        return tuple(self._rows())

    def _rows(self) -> Iterator[PlacedMotion]:
        for motion in self.motions:
            periods = f"repeats after {motion.periods} periods" if motion.periods > 1 else ""
            worst = _shown(complex(motion.multipliers[0])) if len(motion.multipliers) else ""
            for place, channel in enumerate(self.outputs):
                low, high = float(motion.lowest[place]), float(motion.highest[place])
                what = motion.turn or periods
                at, unit = self.shown(motion.at), channel.unit
                yield PlacedMotion(
                    at, self.unit, motion.branch + 1, what, channel.name, low, high, high - low, unit, motion.stability,
                    worst, motion.harmonics,
                )  # fmt: skip

    @property
    def shown_jumps(self) -> Annotated[tuple[Jump, ...], Out(json="jumps")]:
        """Jumps of slow sweeps with their places in Hz or rpm."""
        return tuple(Jump(way, self.shown(at), self.unit) for way, at in self.jumps)

    @property
    def sentences(self) -> Annotated[tuple[str, ...], Out(json="notes")]:
        """Notes with how each branch was found and where sweeps jump."""
        ways = [f"branch {number + 1}: {way}" for number, way in enumerate(self.ways)]
        return (*ways, *self.jump_sentences, *self.notes)

    @property
    def jump_sentences(self) -> tuple[str, ...]:
        """Sentences on where slow sweeps jump."""
        return tuple(f"a {way} jumps at {self.shown(at):.8g} {self.unit}" for way, at in self.jumps)


def _shown(value: complex) -> str:
    if abs(value.imag) < 1e-9:
        return f"{value.real:.6g}"
    return f"{value.real:.6g} {'+' if value.imag > 0 else '-'} {abs(value.imag):.6g}j"


@dataclass(frozen=True, eq=False)
class Jump:
    """Place at which a slow sweep jumps, in Hz or rpm: a run-up or a run-down."""

    sweep: str
    at: float
    unit: str


# Notes of a periodic response: what was left out, where branches stop and motions change, and what may be missing.

FEW_HARMONICS = "with {count} harmonic{s}, further ones would move the twist of a law by up to {share:.1g} of its swing"
MORE = "there may be more: branches that none of these starts leads to are not found"
CLOSER = 4.669201609
"""Factor by which doublings of a cascade follow each other ever closer (M. J. Feigenbaum, 1978)."""
NOTHING = 1e-7
"""Distance of a multiplier from 1 that is rounding."""
MANY = 3
"""Doublings one after the other from which on a cascade is expected."""


def periodic_notes(
    response: PeriodicResponse,
    branches: Sequence[FoundBranch],
    beyond: Sequence[tuple[int, float, str]],
    missed: Sequence[float],
    unsure: Sequence[tuple[str, float]],
) -> Iterator[str]:
    """Yield the notes of a response.

    ``beyond`` are motions beyond tables by branch and place, with the reason, ``missed`` places at which a branch
    passes without a motion found, and ``unsure`` places by the reason for which stability is not determined.
    """
    off = [motion for motion in response.motions if motion.left_out > 1e-5]
    if off:
        worst = max(off, key=lambda motion: motion.left_out)
        s = "" if worst.harmonics == 1 else "s"
        yield FEW_HARMONICS.format(count=worst.harmonics, s=s, share=worst.left_out)
    doubled = {branch.problem.subharmonics for branch in branches}
    for turn in response.turns("doubling"):
        follow = "" if 2 * turn.periods in doubled else f"; subharmonics={2 * turn.periods} follows it"
        yield f"at {_at(response, turn.at)} the motion of branch {turn.branch + 1} doubles its period{follow}"
    for turn in response.turns("symmetry"):
        text = "loses its symmetry, and two lopsided ones begin, mirror images of each other: one at most is followed"
        yield f"at {_at(response, turn.at)} the motion of branch {turn.branch + 1} {text}"
    for turn in response.turns("second frequency"):
        text = "passes into motions with a second frequency, which no period repeats; simulate shows them"
        yield f"at {_at(response, turn.at)} the motion of branch {turn.branch + 1} {text}"
    yield from _cascades(response, branches)
    for number, each in enumerate(branches):
        for motion, why in each.branch.stops:
            owner, swing = each.problem.largest_twist(motion)
            place = f"at {_at(response, motion.parameter)}, where {owner} swings by {swing:.4g} rad"
            yield f"branch {number + 1} stops {place}: {why}; simulate shows what follows"
        for fork in each.unfollowed:
            begins = f"the branch that begins at {_at(response, fork.motion.parameter)}"
            yield f"{begins} is not followed to its end: those found before are long"
    for number, group in groupby(beyond, key=lambda each: each[0]):
        places = list(group)
        span = _span(response, sorted(at for _, at, _ in places))
        yield f"{span} motions of branch {number + 1} are left out: {places[0][2]}"
    if missed:
        yield f"{_span(response, sorted(missed))} a branch passes, but with the harmonics it needs none was found there"
    for why, same in groupby(sorted(unsure), key=lambda each: each[0]):
        yield f"{_span(response, [at for _, at in same])} stability is not determined: {why}"
    yield from _held(response)
    yield from _unstable(response, branches)
    yield MORE


def _at(response: PeriodicResponse, at: float) -> str:
    return f"{response.shown(at):.8g} {response.unit}"


def _span(response: PeriodicResponse, places: Sequence[float]) -> str:
    if len(places) == 1:
        return f"at {response.shown(places[0]):.6g} {response.unit}"
    low, high = response.shown(places[0]), response.shown(places[-1])
    return f"at {len(places)} places from {low:.6g} to {high:.6g} {response.unit}"


def _cascades(response: PeriodicResponse, branches: Sequence[FoundBranch]) -> Iterator[str]:
    """Yield a note for each row of doublings that goes on, with the place at which it would have become chaos."""
    for branch in branches:
        doublings = [each.motion.parameter for each in branch.forks if each.kind == "doubling"]
        if not doublings:
            continue
        last, chain = branch, []
        while last.begins is not None and last.begins.kind == "doubling":
            chain.append(last.begins.motion.parameter)
            last = next(each for each in branches if last.begins in each.forks)
        if len(chain) + 1 < MANY:
            continue
        nearest = min(doublings, key=lambda at: abs(at - chain[0]))
        row = np.array([*reversed(chain), nearest])[-MANY:]
        steps = np.diff(row)
        if steps[0] * steps[1] <= 0 or abs(steps[1]) >= abs(steps[0]):
            continue
        # what is left of the row is a geometric series of steps
        chaos = row[-1] + steps[1] / (CLOSER - 1)
        shown = ", ".join(f"{response.shown(at):.6g}" for at in row)
        text = f"doublings follow each other ever closer, at {shown} {response.unit}: a cascade without an end"
        yield f"{text}, beyond about {response.shown(chaos):.5g} {response.unit} chaos; simulate shows it"


def _held(response: PeriodicResponse) -> Iterator[str]:
    """Yield a note where friction sticks all along: its slider may stand elsewhere, and nothing brings it back."""
    held = {
        one.at for one in response.motions if one.is_stable and np.abs(one.multipliers).max(initial=0.0) > 1 - NOTHING
    }
    if held:
        text = "friction sticks all along, with any mean torque that it holds: the mean may differ by what was before"
        yield f"{_span(response, sorted(held))} {text}"


def _unstable(response: PeriodicResponse, branches: Sequence[FoundBranch]) -> Iterator[str]:
    places = sorted({motion.at for motion in response.motions if not motion.turn})
    lonely = [at for at in places if response.motions_at(at) and not response.stable_at(at)]
    sure = [at for at in lonely if all(motion.is_stable is False for motion in response.motions_at(at))]
    if not sure:
        return
    text = "none of the motions found is stable: what is met doubles, has a second frequency, or is chaotic"
    for law in branches[0].problem.plant.laws if branches else ():
        curve = law.law.curve
        if isinstance(curve, CubicCurve) and curve.cubic < 0:
            # k g + k_3 g^3 = 0
            end = float(np.sqrt(curve.stiffness / -curve.cubic))
            text += f", or runs away: beyond {end:.4g} rad {law.owner} pushes on outward"
    yield f"{_span(response, sure)} {text}; simulate shows it"
