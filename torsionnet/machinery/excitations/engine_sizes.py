"""Faults of impossible or unusual engine sizes, with the unit that was probably meant."""

from __future__ import annotations

import math
from collections.abc import Iterator

from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import Fault, question
from torsionnet.machinery.excitations.engine_entries import EngineEntries
from torsionnet.machinery.excitations.gas_torque import GasPressure

LARGEST_LENGTHS = {"bore": 3.0, "stroke": 10.0, "rod_length": 20.0}
"""Bore, stroke and rod length in m that no engine exceeds, as does a number in mm without its unit."""
USUAL_LENGTHS = {"bore": (0.03, 1.2), "stroke": (0.03, 4.0), "rod_length": (0.05, 6.0)}
"""Smallest and largest bore, stroke and rod length in m of existing engines."""
MASS_PER_VOLUME = (30.0, 3e5)
"""Usual range in kg/m^3 of reciprocating mass over swept volume, from light pistons to plungers with crossheads."""
CRANKCASE_PRESSURES = (2e4, 1e6)
"""Usual range in Pa of the pressure below the pistons, beyond which the unit is probably another."""
HIGHEST_PEAK = 4e7
"""Highest usual peak pressure in Pa in a cylinder of an engine that gives power."""
MOTORED_PEAK_SHARES = (0.15, 1.1)
"""Usual range of a cylinder's peak pressure without injection over the peak with injection."""


def impossible_lengths(engine: EngineEntries) -> Iterator[Fault]:
    """Faults of bore, stroke and rod length that no engine has."""
    for name, most in LARGEST_LENGTHS.items():
        size = getattr(engine, name)
        if size > most:
            text = f"a {name.replace('_', ' ')} of {size:g} m is too large for an engine"
            low, high = USUAL_LENGTHS[name]
            meant = f"{size * 100:g} mm" if low <= size / 10 <= high else ""
            hint = f"; a bare number is m, write {size:g} mm" if low <= size / 1e3 <= high else question(meant)
            yield Fault(text + hint, (name,), meant=meant)


def unusual_sizes_of(engine: EngineEntries) -> Iterator[Fault]:
    """Warnings of masses and pressures of an engine that have unusual sizes."""
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
    yield Fault(text + question(found), ("reciprocating_mass",), "warning", meant=found)


def _rounded(size: float) -> str:
    """Text of a size rounded to two digits, as messages state usual ranges."""
    return f"{float(f'{size:.2g}'):g}"


def _crankcase(gas: GasPressure) -> Iterator[Fault]:
    low, high = CRANKCASE_PRESSURES
    pressure = float(gas.crankcase)
    if gas.reference != "absolute" or not pressure or low <= pressure <= high:
        return
    text = f"a pressure below the pistons of {pressure / 1e5:g} bar: usual are {low / 1e5:g} to {high / 1e5:g} bar"
    meant = f"{pressure / 1e5:g} kPa" if low <= pressure / 100 <= high else ""
    text += question(meant)
    if not meant and low <= pressure * 1e5 <= high:
        text += f"; a bare number is Pa, write {pressure:g} bar"
    yield Fault(text, ("crankcase",), "warning", meant=meant).under("gas")


def _peaks(gas: GasPressure) -> Iterator[Fault]:
    """Warnings of unusual peak pressures of the fired and motored traces, and of their ratio."""
    trace = not_none(gas.fired)
    fired = max(trace.values)
    if fired > HIGHEST_PEAK:
        text = f"{trace.origin}a highest pressure of {fired / 1e5:.4g} bar: usual are up to {HIGHEST_PEAK / 1e5:g} bar"
        yield Fault(text + _meant_unit(fired, 1e5, HIGHEST_PEAK), ("gas", "fired"), "warning", position=trace.place)
    if not gas.motored:
        return
    motored, (low, high) = max(gas.motored.values), MOTORED_PEAK_SHARES
    if not low * fired <= motored <= high * fired:
        text = f"{gas.motored.origin}compression without injection goes to {motored / 1e5:.4g} bar"
        text += f", with injection the pressure goes to {fired / 1e5:.4g} bar"
        meant = _meant_unit(motored, low * fired, high * fired)
        yield Fault(text + meant, ("gas", "motored"), "warning", position=gas.motored.place)


def _meant_unit(pressure: float, low: float, high: float) -> str:
    """Hint at the unit in which a pressure would lie between two limits in Pa, the nearest power of ten first."""
    units = {10.0: "bar for MPa", 0.1: "MPa for bar", 100.0: "kPa for bar", 0.01: "bar for kPa"}
    fitting = [words for factor, words in units.items() if low <= pressure / factor <= high]
    return f"; is the unit right, {fitting[0]}?" if fitting and math.isfinite(pressure) else "; is the unit right?"
