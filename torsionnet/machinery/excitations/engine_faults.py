"""Faults and remarks on entries of an engine that contradict each other or are unlikely."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from torsionnet.base.entries.composite import one_exactly
from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import EntryPath, Fault, UsageError, comma_list, question
from torsionnet.machinery.excitations.engine_entries import EACH, EngineEntries, firing_against_banks
from torsionnet.machinery.excitations.gas_torque import GasPressure
from torsionnet.machinery.excitations.order_excitation import FloatArray
from torsionnet.machinery.excitations.pressure_trace import PressureTrace
from torsionnet.machinery.excitations.table_by_pressure import far_beyond

# Faults of impossible or unusual engine sizes, with the unit that was probably meant.

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
            yield Fault(text + hint, (name,), meant=meant, kind="implausible-size")


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
    # A usual mass in g or t, of which the unit was left out.
    meant = {mass / 1e3: f"{mass:g} g", mass * 1e3: f"{mass:g} t"}
    likely = next((words for size, words in meant.items() if low <= size / volume <= high), "")
    yield Fault(text + question(likely), ("reciprocating_mass",), "warning", meant=likely, kind="implausible-size")


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
    yield Fault(text, ("crankcase",), "warning", meant=meant, kind="implausible-size").under("gas")


def _peaks(gas: GasPressure) -> Iterator[Fault]:
    """Warnings of unusual peak pressures of the fired and motored traces, and of their ratio."""
    trace = not_none(gas.fired)
    fired = max(trace.values)
    if fired > HIGHEST_PEAK:
        text = f"{trace.origin}a highest pressure of {fired / 1e5:.4g} bar: usual are up to {HIGHEST_PEAK / 1e5:g} bar"
        yield Fault(
            text + _meant_unit(fired, 1e5, HIGHEST_PEAK),
            ("gas", "fired"),
            "warning",
            position=trace.place,
            kind="implausible-size",
        )
    if not gas.motored:
        return
    motored, (low, high) = max(gas.motored.values), MOTORED_PEAK_SHARES
    if not low * fired <= motored <= high * fired:
        text = f"{gas.motored.origin}compression without injection goes to {motored / 1e5:.4g} bar"
        text += f", with injection the pressure goes to {fired / 1e5:.4g} bar"
        meant = _meant_unit(motored, low * fired, high * fired)
        yield Fault(text + meant, ("gas", "motored"), "warning", position=gas.motored.place, kind="implausible-size")


def _meant_unit(pressure: float, low: float, high: float) -> str:
    """Hint at the unit in which a pressure would lie between two limits in Pa, the nearest power of ten first."""
    units = {10.0: "bar for MPa", 0.1: "MPa for bar", 100.0: "kPa for bar", 0.01: "bar for kPa"}
    fitting = [words for factor, words in units.items() if low <= pressure / factor <= high]
    return f"; is the unit right, {fitting[0]}?" if fitting and math.isfinite(pressure) else "; is the unit right?"


MEAN_PRESSURE_RTOL = 0.1
"""Relative amount by which a trace's mean indicated pressure may differ from its heading, as sheets round it."""
LATEST_PEAK = math.radians(60)
"""Largest usual angle in rad between firing top dead centre and the peak pressure of a four-stroke cylinder."""
WIDEST_PEAK = 70.0
"""Largest usual width in degrees of crank of the peak above half its pressure in a four-stroke engine.

It is 65 where air is compressed to an eighth and 36 to a twenty-second; twice that for a list of half a cycle that is
taken for the whole."""
STROKES = {2: "two", 4: "four"}


def engine_faults(engine: EngineEntries) -> Iterator[Fault]:
    """Faults of engine entries that contradict each other."""
    if engine.cycle not in STROKES:
        yield Fault("a cycle has 2 or 4 strokes", ("cycle",), kind="out-of-range")
        return
    yield from _mechanism(engine)
    firing = [*_banks(engine), *_firing(engine)]
    yield from firing or _angles(engine)
    yield from _cylinders(engine)
    yield from _gas(engine)
    yield from _traces(engine)


def _mechanism(engine: EngineEntries) -> Iterator[Fault]:
    huge = list(impossible_lengths(engine))
    if huge:
        yield from huge
        return
    radius, per_cycle = engine.stroke / 2, engine.cycle / 2
    if engine.rod_length <= radius:
        text = f"a rod of {engine.rod_length:g} m is shorter than the crank radius {radius:g} m"
        yield Fault(text, ("rod_length",), kind="contradicting-values")
    if engine.piston_rod >= engine.bore:
        yield Fault(
            f"a piston rod of {engine.piston_rod:g} m fills the bore {engine.bore:g} m",
            ("piston_rod",),
            kind="contradicting-values",
        )
    own = engine.gas.own_orders if engine.gas else ()
    for path, orders in {
        ("orders",): list(engine.orders),
        ("gas", "harmonics"): [order for key, order in own if key == "harmonics"],
        ("gas", "motored_harmonics"): [order for key, order in own if key == "motored_harmonics"],
    }.items():
        odd = [f"{order:g}" for order in orders if abs(order * per_cycle - round(order * per_cycle)) > 1e-9]
        if odd:
            text = f"orders of a {STROKES[engine.cycle]}-stroke engine are multiples of {1 / per_cycle:g}"
            yield Fault(f"{text}, not {', '.join(odd)}", path, kind="contradicting-values")


def _banks(engine: EngineEntries) -> Iterator[Fault]:
    if not engine.banks:
        if engine.bank_angle:
            yield Fault(
                "a bank angle needs banks: {A: [1, 2, 3], B: [4, 5, 6]}",
                ("bank_angle",),
                on_key=True,
                kind="missing-entry",
            )
        return
    if not engine.bank_angle:
        yield Fault(
            "banks need the angle from one to the next: bank_angle: 60 deg",
            ("banks",),
            on_key=True,
            kind="missing-entry",
        )
    yield from _incomplete(engine, "banks", [number for bank in engine.banks.values() for number in bank])


def _firing(engine: EngineEntries) -> Iterator[Fault]:
    wrong = one_exactly(engine, "firing_order", "firing_angles")
    if wrong:
        yield from wrong
        return
    key = "firing_order" if engine.firing_order else "firing_angles"
    yield from _incomplete(engine, key, list(engine.firing_order) or [int(number) for number in engine.firing_angles])


def _incomplete(engine: EngineEntries, key: str, given: list[int]) -> Iterator[Fault]:
    """Faults of a list that does not hold every cylinder exactly once."""
    verb = ("miss", "have", "have") if key in ("firing_angles", "banks") else ("misses", "has", "has")
    mistakes = {
        f"{verb[0]} cylinder": [number for number in engine.numbers if number not in given],
        f"{verb[1]} twice cylinder": sorted({number for number in given if given.count(number) > 1}),
        f"{verb[2]} a cylinder that the engine lacks:": [number for number in given if number not in engine.numbers],
    }
    for text, wrong in mistakes.items():
        if wrong:
            yield Fault(
                f"{key} {text} {comma_list(wrong)}; there are {comma_list(engine.numbers)}",
                (key,),
                on_key=True,
                kind="unknown-name",
            )


def _angles(engine: EngineEntries) -> Iterator[Fault]:
    """Faults of firing angles that do not fit crank pins which banks share."""
    if not engine.banks:
        return
    phases, key = engine.firing_phases, "firing_angles" if engine.firing_angles else "firing_order"
    if not phases:
        text = "the firing order is impossible with banks that share crank pins, or possible in two ways"
        hint = "do the banks stand in the direction of rotation? Else give firing_angles"
        yield Fault(f"{text}; {hint}", (key,), on_key=True, kind="contradicting-values")
        return
    unlike = firing_against_banks(phases, engine.numbers, engine.cylinder_bank_angles)
    if unlike:
        cylinder, other, apart, due = unlike
        turn = f" or {math.degrees(due) + 360:g}" if engine.cycle == 4 else ""
        text = (
            f"cylinders {cylinder} and {other} are on one throw, {math.degrees(due):g} deg apart by their banks: they "
            f"fire {math.degrees(due):g}{turn} deg apart, not {math.degrees(apart):g}; on split pins leave out banks"
        )
        yield Fault(text, (key,), on_key=True, kind="contradicting-values")


def _cylinders(engine: EngineEntries) -> Iterator[Fault]:
    lists = {"misfire": () if engine.misfire == EACH else engine.misfire, "gas_off": engine.gas_off}
    for key, numbers in lists.items():
        for index, number in enumerate(numbers):
            if number not in engine.numbers:
                yield Fault(
                    f"there is no cylinder {number}; there are {comma_list(engine.numbers)}",
                    (key, index),
                    kind="unknown-name",
                )
    for key in ("factors", "misfire_share"):
        for number in getattr(engine, key) or {}:
            if int(number) not in engine.numbers:
                text = f"there is no cylinder {number}; there are {comma_list(engine.numbers)}"
                yield Fault(text, (key, number), on_key=True, kind="unknown-name")
    yield from _misfire_shares(engine)


def _misfire_shares(engine: EngineEntries) -> Iterator[Fault]:
    """Faults of shares of misfire above the whole, and of cylinders that have no injection to lose."""
    silent = {*(() if engine.misfire == EACH else engine.misfire), *engine.gas_off}
    for number, share in (engine.misfire_share or {}).items():
        if share > 1:
            text = f"a cylinder loses at most 100 % of its injection, not {100 * share:g} %"
            yield Fault(text, ("misfire_share", number), kind="out-of-range")
        if int(number) in silent:
            text = f"cylinder {number} has no injection already, by misfire or gas_off; name it once"
            yield Fault(text, ("misfire_share", number), on_key=True, kind="contradicting-entries")


def _gas(engine: EngineEntries) -> Iterator[Fault]:
    gas = engine.gas
    for key in ("misfire", "misfire_share"):
        if getattr(engine, key) and (gas is None or not gas.has_motored):
            text = "a cylinder without injection follows the motored trace; give gas: {motored: compression.csv}"
            yield Fault(text, (key,), on_key=True, kind="missing-entry")
    for key in ("factors", "spread", "load"):
        if getattr(engine, key) and gas is None:
            yield Fault(
                f"{key} is about gas torque; give gas: {{fired: p100.csv}}", (key,), on_key=True, kind="missing-entry"
            )
    if gas is None:
        return
    if gas.is_by_pressure and engine.load is None and len(gas.traces or not_none(gas.harmonics)) > 1:
        text = "which mean indicated pressure acts? give load: {mean_indicated_pressure: 27 bar}"
        yield Fault(f"gas is given by mean indicated pressure: {text}", ("gas",), on_key=True, kind="missing-entry")
    if engine.load is not None and not gas.is_by_pressure:
        text = "a load chooses between traces by mean indicated pressure; a single trace follows rated and exponent"
        yield Fault(text, ("load",), on_key=True, kind="needless-entry")
    if gas.crank_end and gas.harmonics:
        yield Fault(
            "the pressure below the piston goes with fired: or traces:",
            ("gas", "crank_end"),
            on_key=True,
            kind="needless-entry",
        )
    if gas.crank_end and gas.motored_harmonics:
        text = "the pressure below the piston goes with motored:, as a table by order may have it already"
        yield Fault(text, ("gas", "motored_harmonics"), on_key=True, kind="needless-entry")


def _traces(engine: EngineEntries) -> Iterator[Fault]:
    """Faults of trace files that cover another cycle than that of the engine."""
    for path, trace in engine.gas.all_traces if engine.gas else ():
        if trace.revolutions not in (None, engine.revolutions):
            text = f"{trace.file} covers {360 * trace.revolutions} deg"
            text += f"; the cycle of a {STROKES[engine.cycle]}-stroke engine has {360 * engine.revolutions} deg"
            yield Fault(text, ("gas", *path), position=trace.place, kind="unfit-curve")


def engine_remarks(engine: EngineEntries, speeds: FloatArray | None) -> Iterator[Fault]:
    """Remarks on traces that contradict their entries, unusual sizes, and loads that no trace covers."""
    yield from unusual_sizes_of(engine)
    gas = engine.gas
    if gas is None:
        return
    for path, trace in gas.all_traces:
        if trace.note:
            yield Fault(trace.note, ("gas", *path), severity="note")
        yield from _stretched(engine, path, trace)
    fired = {"fired": gas.fired} if gas.fired else {}
    for trace in (*fired.values(), *(gas.traces or {}).values()):
        angles, _ = trace.tangential(engine.crank.ratio, engine.revolutions, gas.zero, 0.0)
        late = math.remainder(float(angles[int(np.argmax(trace.values))]), engine.cycle * math.pi)
        if engine.cycle == 4 and abs(late) > LATEST_PEAK:
            text = f"{trace.origin}the pressure is highest {math.degrees(late):.4g} deg after firing top dead centre"
            yield Fault(
                f"{text}; check zero:, the angle of the traces at firing top dead centre",
                ("gas",),
                severity="warning",
                kind="implausible-size",
            )
    for pressure, trace in (gas.traces or {}).items():
        mean = trace.mean_indicated_pressure(engine.crank.ratio, engine.revolutions, gas.zero)
        if abs(mean - pressure) > MEAN_PRESSURE_RTOL * max(pressure, 1e5):
            text = f"{trace.origin}its mean indicated pressure is {mean / 1e5:.4g} bar"
            yield Fault(
                f"{text}, but it is given under {pressure / 1e5:.4g} bar; correct one of them",
                ("gas", "traces"),
                severity="warning",
                kind="contradicting-values",
            )
    if speeds is not None:
        try:
            pressures = engine.indicated_pressures(speeds)
            gas.fired_harmonics(engine.crank, engine.acting_orders[:1], pressures, speeds)
        except UsageError as error:
            yield error.fault.under("load")
        else:
            yield from _held(gas, pressures)


def _held(gas: GasPressure, pressures: FloatArray | None) -> Iterator[Fault]:
    """Note that the gas at an end of the tables is held for pressures that lie beyond it by less than rounding."""
    known = sorted(pressure for pressure in (gas.traces or gas.harmonics or {}) if pressure is not None)
    if pressures is None or not known:
        return
    asked = pressures[far_beyond(known, pressures)]
    if len(asked):
        furthest, end = (asked.max(), known[-1]) if asked.max() > known[-1] else (asked.min(), known[0])
        text = f"the load asks for a mean indicated pressure of {furthest / 1e5:.4g} bar, gas is known to "
        text += f"{end / 1e5:.4g} bar; that holds, as {100 * abs(furthest / end - 1):.2g} % beyond is rounding"
        yield Fault(text, ("load",), "note")


def _stretched(engine: EngineEntries, path: EntryPath, trace: PressureTrace) -> Iterator[Fault]:
    """Warnings of pressure lists that cover one revolution instead of the two of a four-stroke cycle."""
    pressures = np.array(trace.values)
    wide = 360 * engine.revolutions * float(np.mean(pressures >= pressures.max() / 2))
    if engine.cycle == 4 and trace.revolutions is None and wide > WIDEST_PEAK:
        text = f"the pressure is above half of its largest for {wide:.3g} deg, too long for a cylinder"
        meant = (
            "a list covers the whole cycle, 720 deg; does this one cover 360 deg? Add the gas exchange, or give a file"
        )
        yield Fault(f"{text}: {meant} with crank angles", ("gas", *path), severity="warning", kind="implausible-size")
