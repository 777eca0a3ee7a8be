"""Tooth 0 of a wheel: the first after its gap, or the first after an index pulse; others do not fit the pulses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from torsionnet.base.errors import UsageError, comma_list
from torsionnet.signals.bandlimited import NEIGHBOURS
from torsionnet.signals.pulses import MOST_BEYOND_BAND, MissingPulses, Pulses, check_pulses, rotation_beyond_band
from torsionnet.signals.rotation.wheel import ToothPlaces, matched_pulses, runs_in_words

if TYPE_CHECKING:
    from torsionnet.signals.bandlimited import Rotation
    from torsionnet.signals.recording import FloatArray
    from torsionnet.signals.rotation.pulse_channel import PulseChannel
    from torsionnet.signals.rotation.wheel import Wheel

RETURNING_SHARE = 0.8
"""Least share of the turns in which pulses are missing at a tooth that has none, less than 1 as disturbances may put
pulses there."""
FEWEST_TURNS = 3
"""Fewest turns in which pulses that are missing return, so that lost pulses do not pass for a gap."""
LARGEST_INDEX_SPREAD = 0.5
"""Largest distance in pitches of an index pulse from its mean place, as one further away belongs to another tooth."""

EDGE_TOLERANCE = 0.25
"""Pitches by which an index pulse may come behind a tooth and still belong to it: an index that is meant to fall on an
edge does so by jitter now before, now behind it, and tooth 0 would be another one from record to record."""


def tooth_after_gap(pulses: Pulses, wheel: Wheel, name: str) -> tuple[int | None, str]:
    """Tooth of the first pulse, counted from the first after the gap of a wheel, and the gap in words.

    None where neither the wheel has a gap nor the pulses show one.

    Raises
    ------
    UsageError
        The gap is not there, there are several, or one where the wheel has none.
    """
    if pulses.period and wheel.teeth % pulses.period:
        raise UsageError(
            f"{name}: pulses are missing every {pulses.period} pulses, a wheel with a gap, of {pulses.period} teeth "
            f"with the missing ones; give this number instead of {wheel.teeth}",
            kind="unfit-wheel",
        )
    returning = _returning_gaps(pulses, wheel.teeth)
    fitting = [after for after, missing in returning if missing == wheel.missing_teeth]
    gaps = runs_in_words(returning, wheel.teeth) if returning else ""
    shown = comma_list([f"of {missing} after pulse {after}" for after, missing in returning], 4) or "none"
    if not wheel.missing_teeth:
        if returning:
            after, missing = returning[0]
            give = f"missing_teeth: {missing}" if len(returning) == 1 else f"pattern: {gaps}"
            raise UsageError(
                f"{name}: {missing} pulses are missing in every turn of {wheel.teeth}, first after pulse {after}: give "
                f"{give} if the wheel has a gap there, or another number of teeth",
                kind="unfit-wheel",
            )
        return None, ""
    turns = int(pulses.numbers[-1]) // wheel.teeth
    if len(fitting) > 1:
        places = " and ".join(f"after pulse {after} of the record" for after in fitting)
        raise UsageError(
            f"{name}: there are {len(fitting)} gaps of {wheel.missing_teeth} teeth in every turn, {places}: which "
            f"is the gap cannot be told; if it has them all, give pattern: {gaps} in place of missing_teeth",
            kind="ambiguous-tooth",
        )
    if not fitting:
        few = f" in the {turns} turns of the record, of which {FEWEST_TURNS} are needed" if turns < FEWEST_TURNS else ""
        raise UsageError(
            f"{name}: no gap of {wheel.missing_teeth} missing teeth returns every {wheel.teeth} pulses{few}; gaps "
            f"that return there: {shown}. Give the numbers of the wheel: teeth counts the missing ones, too",
            kind="unfit-wheel",
        )
    first = int(fitting[0]) + wheel.missing_teeth + 1
    text = f"gap of {wheel.missing_teeth} teeth found in {turns} turns, first after pulse {fitting[0]} of the record"
    return -first % wheel.teeth, text


def _returning_gaps(pulses: Pulses, teeth: int) -> list[tuple[int, int]]:
    """Numbers of the pulses of the first turn after which pulses are missing in nearly every turn, and how many."""
    # A gap comes at the same tooth in each turn, lost pulses come anywhere.
    phases = pulses.numbers[pulses.missing.after] % teeth
    pairs, often = np.unique(np.column_stack([phases, pulses.missing.counts]), axis=0, return_counts=True)
    turns = pulses.numbers[-1] / teeth
    returning = pairs[often >= max(FEWEST_TURNS, RETURNING_SHARE * (turns - 1))]
    return [(phase, missing) for phase, missing in returning.tolist()]


def pulses_by_gap(times: FloatArray, wheel: Wheel) -> Pulses | None:
    """Pulses numbered by the gap that a wheel states, where vibration makes intervals as uneven as lost pulses do.

    Those at the ends beyond a gap that too few pulses surround to fill it are left out. None where a pulse is lost or
    too many, or the gap is another one.
    """
    stamps, teeth = check_pulses(times), np.arange(wheel.teeth - wheel.missing_teeth)
    try:
        numbers, _ = matched_pulses(stamps, ToothPlaces(wheel.teeth, teeth, np.zeros(len(teeth))))
    except UsageError:
        return None
    # A gap is filled from the pulses on both sides of it: near the ends there are too few.
    after = np.flatnonzero(np.diff(numbers) > 1) + 1
    begin = int(after[0]) if after[0] < NEIGHBOURS else 0
    end = int(after[-1]) if after[-1] > len(stamps) - NEIGHBOURS else len(stamps)
    stamps, numbers = stamps[begin:end], numbers[begin:end] - numbers[begin]
    if rotation_beyond_band(stamps, numbers, wheel.teeth) >= MOST_BEYOND_BAND:
        return None
    after, none = np.flatnonzero(np.diff(numbers) > 1), np.empty(0, np.intp)
    missing = MissingPulses(after, np.diff(numbers)[after] - 1)
    return Pulses(stamps, numbers, none, missing, np.empty(0), wheel.teeth)


def tooth_after_index(rotation: Rotation, times: FloatArray, index: PulseChannel, teeth: int, name: str) -> int:
    """Tooth of the first pulse, counted from the first at or after an index pulse, or less than a quarter pitch before.

    Raises
    ------
    UsageError
        The index comes less than twice, or not after whole turns.
    """
    inside = index.times[(index.times >= times[0]) & (index.times <= times[-1])]
    if len(inside) < 2:
        raise UsageError(
            f"{name}: the index {index.name} has {len(inside)} pulses from {times[0]:.6g} to {times[-1]:.6g} s, and "
            "2 are needed to compare them with the teeth; take a longer record",
            kind="lost-pulses",
        )
    places = rotation.at(inside)
    # Mean on the circle, as places around tooth 0 lie at both ends of a turn.
    turning = np.exp(2j * np.pi * places / teeth)
    mean = float(np.angle(turning.mean()) * teeth / (2 * np.pi))
    away = np.abs(np.angle(turning * np.exp(-2j * np.pi * mean / teeth))) * teeth / (2 * np.pi)
    if away.max() > LARGEST_INDEX_SPREAD:
        each = np.diff(places)
        raise UsageError(
            f"{name}: from pulse to pulse of the index {index.name} there are {each.min():.2f} to {each.max():.2f} "
            f"pulses, not whole turns of {teeth}: the number of teeth is wrong, the index belongs to another shaft, or "
            "has lost or double pulses",
            kind="unfit-wheel",
        )
    # Tooth 0 is pulse ceil(place) after the first one, so that the first one is tooth -ceil(place).
    return int(-np.ceil(mean - EDGE_TOLERANCE)) % teeth
