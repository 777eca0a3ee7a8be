"""Sizes of an engine that no other has, and what was probably meant: millimetres for metres, MPa for bar."""

from __future__ import annotations

import math
from collections.abc import Iterator

from torsionnet.core.entries.spec import not_none
from torsionnet.core.errors import Fault
from torsionnet.model.excitations.engine_entries import EngineEntries
from torsionnet.model.excitations.gas_torque import GasPressure

LARGEST = {"bore": 3.0, "stroke": 10.0, "rod_length": 20.0}
"""Lengths in m that no engine exceeds, but a number in mm without its unit does."""
USUAL = {"bore": (0.03, 1.2), "stroke": (0.03, 4.0), "rod_length": (0.05, 6.0)}
"""Lengths in m that are met."""
MASS_PER_VOLUME = (30.0, 3e5)
"""kg/m^3, reciprocating mass of a cylinder over its swept volume: from light pistons to plungers with crossheads."""
CRANKCASE = (2e4, 1e6)
HIGHEST_PEAK = 4e7
"""Pa, of an engine that gives power."""
COMPRESSED = (0.15, 1.1)
"""Highest pressure without injection over that with it, of one engine."""


def impossible_lengths(engine: EngineEntries) -> Iterator[Fault]:
    """Lengths that no engine has."""
    for name, most in LARGEST.items():
        size = getattr(engine, name)
        if size > most:
            text = f"{size:g} m is no {name.replace('_', ' ')} of an engine"
            yield Fault(text + _meant_length(name, size), (name,))


def _meant_length(name: str, size: float) -> str:
    low, high = USUAL[name]
    if low <= size / 1e3 <= high:
        return f"; a bare number is m, write {size:g} mm"
    return f'; did you mean "{size * 100:g} mm"?' if low <= size / 10 <= high else ""


def unusual_sizes_of(engine: EngineEntries) -> Iterator[Fault]:
    """Warnings about masses and pressures of a size that is not met."""
    yield from _mass(engine)
    gas = engine.gas
    if gas is None:
        return
    yield from _crankcase(gas)
    rating = engine.rating
    if gas.fired and rating is not None and rating.torque > 0:
        yield from _peaks(gas)


def _mass(engine: EngineEntries) -> Iterator[Fault]:
    mass, low, high = engine.reciprocating_mass, *MASS_PER_VOLUME
    volume = engine.crank.swept_volume
    if not mass or low <= mass / volume <= high:
        return
    text = (
        f"a reciprocating mass of {mass:g} kg in a cylinder of {engine.bore * 1e3:g} mm by {engine.stroke * 1e3:g} mm"
    )
    text += f": usual are {_rounded(low * volume)} to {_rounded(high * volume)} kg"
    meant = {mass / 1e3: f"{mass:g} g", mass * 1e3: f"{mass:g} t"}
    found = next((words for one, words in meant.items() if low <= one / volume <= high), "")
    yield Fault(f'{text}; did you mean "{found}"?' if found else text, ("reciprocating_mass",), "warning")


def _rounded(size: float) -> str:
    """Two digits: what is usual is no exact number."""
    return f"{float(f'{size:.2g}'):g}"


def _crankcase(gas: GasPressure) -> Iterator[Fault]:
    low, high = CRANKCASE
    pressure = float(gas.crankcase)
    if gas.reference != "absolute" or not pressure or low <= pressure <= high:
        return
    text = f"a pressure below the pistons of {pressure / 1e5:g} bar: usual are {low / 1e5:g} to {high / 1e5:g} bar"
    if low <= pressure / 100 <= high:
        text += f'; did you mean "{pressure / 1e5:g} kPa"?'
    elif low <= pressure * 1e5 <= high:
        text += f"; a bare number is Pa, write {pressure:g} bar"
    yield Fault(text, ("crankcase",), "warning").under("gas")


def _peaks(gas: GasPressure) -> Iterator[Fault]:
    """Pressures of a fired and a motored trace, alone and against each other."""
    trace = not_none(gas.fired)
    fired = max(trace.values)
    if fired > HIGHEST_PEAK:
        text = f"{trace.origin}a highest pressure of {fired / 1e5:.4g} bar: usual are up to {HIGHEST_PEAK / 1e5:g} bar"
        yield Fault(text + _meant_unit(fired, 1e5, HIGHEST_PEAK), ("gas", "fired"), "warning", position=trace.place)
    if not gas.motored:
        return
    motored, (low, high) = max(gas.motored.values), COMPRESSED
    if not low * fired <= motored <= high * fired:
        text = f"{gas.motored.origin}compression without injection goes to {motored / 1e5:.4g} bar"
        text += f", with injection the pressure goes to {fired / 1e5:.4g} bar"
        meant = _meant_unit(motored, low * fired, high * fired)
        yield Fault(text + meant, ("gas", "motored"), "warning", position=gas.motored.place)


def _meant_unit(pressure: float, low: float, high: float) -> str:
    """Which unit would bring it between two pressures, the nearest power of ten first."""
    units = {10.0: "bar for MPa", 0.1: "MPa for bar", 100.0: "kPa for bar", 0.01: "bar for kPa"}
    fitting = [words for factor, words in units.items() if low <= pressure / factor <= high]
    return f"; is the unit right, {fitting[0]}?" if fitting and math.isfinite(pressure) else "; is the unit right?"
