"""Excitation by engines, compressors and pumps with pistons: gas and inertia torques of every cylinder."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from torsionnet.base.errors import Fault, UsageError
from torsionnet.base.phrases import phrase
from torsionnet.base.registers import Groups
from torsionnet.base.result_rows import Out
from torsionnet.base.units import RPM
from torsionnet.machinery.excitations.engine_entries import EACH, EngineEntries
from torsionnet.machinery.excitations.engine_faults import engine_faults, engine_remarks
from torsionnet.machinery.excitations.order_excitation import (
    ComplexArray,
    FloatArray,
    OrderExcitation,
    OrderTorques,
    TorqueShares,
    register_excitation,
)
from torsionnet.machinery.excitations.pressure_trace import inertia_harmonics


@register_excitation
@dataclass(frozen=True, kw_only=True)
class ReciprocatingEngine(EngineEntries):
    """Pistons on a crankshaft: gas torque from traces or harmonics, inertia torque exact from the slider crank.

    With x(phi) the way of a piston from top dead centre over the crank radius r, the gas torque of a cylinder is
    (p - p_crankcase) A r x' and the inertia torque -m r^2 Omega^2 x' x''. Cylinder i acts with T(phi - alpha_i),
    alpha_i the angle at which it fires; phi is 0 at firing top dead centre of the first. With ``reaction``, the node of
    the block, that takes -T of every cylinder. With ``phase``, the crank angle behind the first engine of the model,
    all firing angles are larger by that.

    Examples
    --------
    >>> engine = ReciprocatingEngine(speed_of="c1", cycle=4, cylinders={1: "c1", 2: "c2"}, firing_order=[1, 2],
    ...     bore="100 mm", stroke="120 mm", rod_length="240 mm", reciprocating_mass="1 kg")
    >>> torques = engine.torques(np.array([100.0]))
    >>> torques.nodes, float(abs(torques.amplitudes[0, torques.orders == 2, 0]).round(3).item())
    (('c1', 'c2'), 18.005)
    """

    kind: ClassVar[str] = "reciprocating_engine"

    def contradictions(self) -> list[Fault]:
        return [*engine_faults(self), *super().contradictions()]

    def remarks(self, speeds: FloatArray | None) -> list[Fault]:
        return list(engine_remarks(self, speeds))

    def phase_vectors(self, order: float) -> dict[str, tuple[str, complex]]:
        silent = {*self._without_injection, *self.gas_off}
        sizes = {
            number: 0.0 if number in silent else self._factor(number) * (1 - self._lost_share(number))
            for number in self.numbers
        }
        # Cylinder i repeats the first one later by alpha_i: order h turns by -h alpha_i.
        phase_factors = {number: np.exp(-1j * order * angle) for number, angle in self.acting_phases.items()}
        return {
            str(number): (node, complex(sizes[number] * phase_factors[number])) for number, node in self.numbers.items()
        }

    def torques(self, speeds: FloatArray) -> OrderTorques:
        orders, nodes = self.acting_orders, self.nodes
        # -m r^2 Omega^2 x' x'' by order; Omega^2 follows below.
        inertia = self.reciprocating_mass * self.crank.radius**2 * inertia_harmonics(self.crank.ratio, orders)
        moving = speeds[:, None] ** 2 * inertia
        # T(phi - alpha_i): order h of cylinder i turns by -h alpha_i.
        phase_factors = {number: np.exp(-1j * orders * angle) for number, angle in self.acting_phases.items()}
        fired, motored = self.fired_harmonics(speeds), self._motored(speeds)
        gas = {number: self._gas_of(number, fired, motored) * phase_factors[number] for number in self.numbers}
        torques = np.zeros((len(speeds), len(orders), len(nodes)), dtype=complex)
        for number, node in self.numbers.items():
            torques[:, :, nodes.index(node)] += moving * phase_factors[number] + gas[number]
        sound = [number for number in self.numbers if number not in self.gas_off]
        # Deviations from the nominal sum: motored instead of fired torque, or a share of the gas torque.
        misfires = {number: motored * phase_factors[number] - gas[number] for number in sound}
        scatter = {number: self.spread * gas[number] for number in sound if number not in self._without_injection}
        return OrderTorques(
            orders,
            nodes,
            torques,
            alternatives=self._shares_by_cylinder("misfire of cylinder {number}", misfires)
            if self.misfire == EACH
            else None,
            scatter=self._shares_by_cylinder("cylinder {number}", scatter) if self.spread else None,
        )

    def _shares_by_cylinder(self, what: str, torques: Mapping[int, ComplexArray]) -> TorqueShares:
        """Torque shares of the engine by cylinder, to be added to the sum of all cylinders."""
        return TorqueShares(
            tuple(phrase(what, number=number) for number in torques),
            tuple(self.numbers[number] for number in torques),
            np.array(list(torques.values())).reshape(len(torques), -1, len(self.acting_orders)),
            tuple(map(str, torques)),
        )

    @property
    def _without_injection(self) -> tuple[int, ...]:
        return () if isinstance(self.misfire, str) else self.misfire

    def _gas_of(self, number: int, fired: ComplexArray, motored: ComplexArray) -> ComplexArray:
        """Gas torque of a cylinder in N m by speed and order, before the shift to its firing angle."""
        if number in self.gas_off:
            return np.zeros_like(fired)
        if number in self._without_injection:
            return motored
        # Partial misfire: straight between fired (0) and motored (1), order by order with phases.
        lost = self._lost_share(number)
        return np.asarray(fired * (self._factor(number) * (1 - lost)) + motored * lost)

    def _factor(self, number: int) -> float:
        """Dimensionless factor on the gas torque of a cylinder against the other cylinders."""
        return float((self.factors or {}).get(str(number), 1.0))

    def _lost_share(self, number: int) -> float:
        """Share of the way from fired to motored gas torque that a cylinder has gone by misfire."""
        return float((self.misfire_share or {}).get(str(number), 0.0))

    def fired_harmonics(self, speeds: FloatArray) -> ComplexArray:
        """Gas torque of a firing cylinder in N m, shape (n_speeds, n_orders), before the shift to its firing angle."""
        shape = (len(speeds), len(self.acting_orders))
        if self.gas is None:
            return np.zeros(shape, dtype=complex)
        try:
            torque = self.gas.fired_harmonics(self.crank, self.acting_orders, self.indicated_pressures(speeds), speeds)
        except UsageError as error:
            raise UsageError(f"engine on {self.shaft}: {error}", kind=error.kind) from None
        return np.asarray(self.gas.factor(speeds)[:, None] * np.broadcast_to(torque, shape))

    def _motored(self, speeds: FloatArray) -> ComplexArray:
        if self.gas is None:
            return np.zeros((len(speeds), len(self.acting_orders)), dtype=complex)
        return np.asarray(
            self.gas.factor(speeds)[:, None] * self.gas.motored_harmonics_at(self.crank, self.acting_orders)
        )


# Engines with a known angle between their crankshafts, and engines that run alone.


def crankshafts(excitations: Mapping[str, OrderExcitation]) -> list[list[str]]:
    """Names of the engines that share a crankshaft, grouped by crankshaft, in the order of the model.

    Engines that name the same node count their firing angles from the same angle, as the stages of a compressor.
    """
    together: Groups[tuple[str, str]] = Groups()
    for name, excitation in excitations.items():
        if excitation.crankshaft:
            # Engines with a node in common are on one crankshaft, also through a third engine.
            together.join(("engine", name), *(("node", node) for node in sorted(excitation.crankshaft)))
    groups = [{name for kind, name in group if kind == "engine"} for group in together.groups()]
    shafts = [[name for name in excitations if name in group] for group in groups]
    order = list(excitations)
    return sorted(shafts, key=lambda group: order.index(group[0]))


def unlocked_engines(acting: Mapping[str, OrderExcitation], declared: Mapping[str, OrderExcitation]) -> dict[str, str]:
    """First engine of the group whose angles to each other are known, by name of each acting engine.

    Empty if all angles are known.

    An engine with a phase is fixed to the first engine of the model, and to others with a phase.
    """
    shafts = crankshafts(declared)
    phased = [shaft for shaft in shafts if any(declared[name].is_phased for name in shaft)]
    # The first engine gives phase 0; all that state a phase to it are locked, others by their own crankshaft only.
    fixed = {name for shaft in [*shafts[:1], *phased] for name in shaft}
    classes = [fixed, *(set(shaft) for shaft in shafts if not fixed & set(shaft))]
    firsts = {}
    for name, excitation in acting.items():
        if excitation.crankshaft:
            alike = next(names for names in classes if name in names)
            firsts[name] = next(other for other in acting if other in alike)
    return firsts if len(set(firsts.values())) > 1 else {}


def running_engines_text(excitations: Mapping[str, OrderExcitation]) -> str:
    """Sentence that names the running engines of a model with several; empty with at most one engine."""
    engines = _engines(excitations)
    if len(engines) < 2:
        return ""
    running = [_named(shaft) for shaft in engines if any(excitations[name].enabled for name in shaft)]
    if len(running) == 1:
        return f"{running[0]} runs alone in this condition"
    return f"{' and '.join(running) or 'no engine'} run{'s' * (not running)} in this condition"


def conditions_running_alone(conditions: Iterable[tuple[str, Mapping[str, OrderExcitation]]]) -> dict[str, list[str]]:
    """Names of the conditions in which an engine runs alone, by engine; empty for a model with one engine."""
    known = [(name, excitations, _engines(excitations)) for name, excitations in conditions]
    return {
        _named(engine): [
            name or "the model as written"
            for name, excitations, engines in known
            if [shaft for shaft in engines if any(excitations[member].enabled for member in shaft)] == [engine]
        ]
        for engine in (known[0][2] if known and len(known[0][2]) > 1 else ())
    }


def _engines(excitations: Mapping[str, OrderExcitation]) -> list[list[str]]:
    """Names of the engines, without compressors and pumps, grouped by crankshaft."""
    return [shaft for shaft in crankshafts(excitations) if not all(excitations[name].absorbs for name in shaft)]


def _named(shaft: list[str]) -> str:
    return " with ".join(shaft)


# Excitation of one cylinder by order, gas and reciprocating mass apart, and mean indicated pressure over speed.

MPA_PER_PA, BAR_PER_PA, KILO = 1e-6, 1e-5, 1e-3
"""Factors from Pa to N/mm^2 and to bar, and from SI units to kN m and kW."""


@dataclass(frozen=True)
class CylinderHarmonic:
    """Harmonic of a cylinder's torque, one order, as torque (N m) and divided by piston area and crank radius (Pa).

    Attributes
    ----------
    order : float
        Vibrations per revolution of the crankshaft.
    gas, inertia : float
        Peak values of the parts of the gas and of the reciprocating mass, Pa.
    resulting : float
        Peak value of both together, with their phases, Pa.
    torque : float
        Peak value in N m, the resulting pressure times piston area and crank radius.
    phase : float
        Of the cosine, from firing top dead centre on, rad.
    """

    order: Annotated[float, Out("order", digits=2)]
    gas: Annotated[float, Out("gas", "N/mm^2", digits=4, factor=MPA_PER_PA)]
    inertia: Annotated[float, Out("mass", "N/mm^2", digits=4, factor=MPA_PER_PA)]
    resulting: Annotated[float, Out("resulting", "N/mm^2", digits=4, factor=MPA_PER_PA)]
    torque: Annotated[float, Out("torque", "kN*m", digits=4, factor=KILO)]
    phase: Annotated[float, Out("phase", "deg", digits=4)]


@dataclass(frozen=True)
class IndicatedPressure:
    """Mean indicated pressure (Pa) of an engine at one speed (rad/s), with indicated torque (N m) of all its cylinders.

    ``speed`` in rad/s of the crankshaft, ``pressure`` in Pa, ``torque`` in N m, ``power`` in W; negative for a machine
    that takes work.
    """

    speed: Annotated[float, Out("speed", "rpm", digits=5, factor=RPM)]
    pressure: Annotated[float, Out("mean indicated pressure", "bar", digits=4, factor=BAR_PER_PA)]
    torque: Annotated[float, Out("indicated torque", "kN*m", digits=4, factor=KILO)]

    @property
    def power(self) -> Annotated[float, Out("indicated power", "kW", digits=4, factor=KILO, after="torque")]:
        """Indicated power of all cylinders in W."""
        return self.torque * self.speed


# Harmonics of the torque of one cylinder with gas and mass apart, firing intervals, and mean indicated pressures.


def cylinder_harmonics(engine: ReciprocatingEngine, speed: float) -> tuple[CylinderHarmonic, ...]:
    """Harmonics of the torque of one sound cylinder at a speed in rad/s, by order, gas and mass apart.

    With the piston's way x over the crank radius r the mass m makes the torque ``-m r^2 Omega^2 x' x''``, over piston
    area and radius a tangential pressure ``-m r Omega^2 x' x''/A`` (W. Ker Wilson, Practical Solution of Torsional
    Vibration Problems, volume 2, Amplitude Calculations). Gas harmonics are those of the pressure with injection.

    Parameters
    ----------
    engine : ReciprocatingEngine
    speed : float
        rad/s, of the crankshaft.

    Examples
    --------
    >>> engine = ReciprocatingEngine(speed_of="c1", cycle=4, cylinders={1: "c1", 2: "c2"}, firing_order=[1, 2],
    ...     bore="100 mm", stroke="120 mm", rod_length="240 mm", reciprocating_mass="1 kg", orders=[1, 2])
    >>> [(row.order, round(row.inertia), round(row.torque, 3)) for row in cylinder_harmonics(engine, 100.0)]
    [(1.0, 4852, 2.286), (2.0, 38207, 18.005)]
    """
    crank, orders = engine.crank, engine.acting_orders
    inertia = engine.reciprocating_mass * (crank.radius * speed) ** 2 * inertia_harmonics(crank.ratio, orders)
    gas = engine.fired_harmonics(np.array([speed]))[0]
    # Gas and mass are out of phase: complex values add, their magnitudes do not.
    both = gas + inertia
    scale = 1 / crank.factor
    return tuple(
        CylinderHarmonic(*map(float, row))
        for row in zip(
            orders, abs(gas) * scale, abs(inertia) * scale, abs(both) * scale, abs(both), np.angle(both), strict=True
        )
    )


def lost_harmonics(engine: ReciprocatingEngine, speed: float) -> FloatArray:
    """Torque amplitude in N m that a cylinder lacks where it is out, at a speed in rad/s, by order, shape (n_orders,).

    The gas torque with injection less that without; where the engine has cylinders without any gas torque only
    (``gas_off``), the whole gas torque. Alone at one cylinder this torque adds all orders to an even engine, the low
    ones too.

    Examples
    --------
    >>> import torsionnet as tn
    >>> engine = tn.load("two_stroke_ship").configured("misfire_2").definition.excitations["engine"]
    >>> (lost_harmonics(engine, 105 * np.pi / 30)[:3] / 1e3).round(1).tolist()
    [396.9, 279.1, 190.3]
    """
    crank, orders, at = engine.crank, engine.acting_orders, np.array([speed])
    fired = engine.fired_harmonics(at)[0]
    if engine.gas is None or not engine.misfire:
        return np.asarray(np.abs(fired))
    motored = engine.gas.factor(at)[0] * engine.gas.motored_harmonics_at(crank, orders)
    return np.asarray(np.abs(fired - motored))


def indicated_pressures(engine: ReciprocatingEngine, speeds: FloatArray) -> tuple[IndicatedPressure, ...]:
    """Mean indicated pressures, torques and powers of an engine with all cylinders firing, at speeds in rad/s.

    Empty where neither the load nor a pressure over the crank angle gives them.

    Parameters
    ----------
    engine : ReciprocatingEngine
    speeds : (n_speeds,) array
        rad/s, of the crankshaft.

    Examples
    --------
    >>> engine = ReciprocatingEngine(speed_of="c1", cycle=4, cylinders={1: "c1"}, firing_order=[1], bore="100 mm",
    ...     stroke="120 mm", rod_length="240 mm",
    ...     gas={"harmonics": {"20 bar": {1: {"amplitude": "2 bar", "phase": 0}}}},
    ...     load={"mean_indicated_pressure": "20 bar"})
    >>> (pressure,) = indicated_pressures(engine, np.array([100.0]))  # 20 bar of 0.94248 l in two revolutions
    >>> round(pressure.pressure), round(pressure.torque, 3)
    (2000000, 150.0)
    """
    pressures = engine.indicated_pressures(speeds)
    if pressures is None:
        own = _of_traces(engine)
        if own is None or engine.gas is None:
            return ()
        pressures = own * engine.gas.factor(speeds)
    # T = p_mi V_h z/(2 pi revolutions): work of a cycle of all cylinders over its angle.
    swept = engine.crank.swept_volume * len(engine.numbers) / (2 * math.pi * engine.revolutions)
    return tuple(
        IndicatedPressure(float(speed), float(pressure), float(pressure * swept))
        for speed, pressure in zip(speeds, pressures, strict=True)
    )


def _of_traces(engine: ReciprocatingEngine) -> float | None:
    """Mean indicated pressure in Pa of the trace with injection, both ends of a double-acting cylinder together."""
    gas = engine.gas
    if gas is None:
        return None
    if gas.is_by_pressure:
        # Of several pressures the load alone says which holds.
        only = [pressure for pressure in (gas.traces or gas.harmonics or {}) if pressure is not None]
        return only[0] if len(only) == 1 else None
    if gas.fired is None:
        return None
    ratio, revolutions = engine.crank.ratio, engine.revolutions
    mean = gas.fired.mean_indicated_pressure(ratio, revolutions, gas.zero)
    if gas.crank_end:
        # Below the piston the same movement is the other way, on the area without the rod.
        mean -= engine.crank.lower_share * gas.crank_end.mean_indicated_pressure(ratio, revolutions, gas.zero)
    return mean


def firing_intervals(engine: ReciprocatingEngine) -> Mapping[int, float]:
    """Crank angle in rad from the firing of each cylinder to the next one, by cylinder number in firing order.

    Examples
    --------
    >>> engine = ReciprocatingEngine(speed_of="c1", cycle=4, cylinders={1: "c1", 2: "c2"}, bore="100 mm",
    ...     stroke="120 mm", rod_length="240 mm", firing_angles={1: "0 deg", 2: "180 deg"})
    >>> {number: round(math.degrees(angle)) for number, angle in firing_intervals(engine).items()}
    {1: 180, 2: 540}
    """
    cycle = engine.cycle * math.pi
    phases = {number: angle % cycle for number, angle in engine.firing_phases.items()}
    order = sorted(phases, key=lambda number: phases[number])
    # The last to fire is followed by the first of the next cycle; a single cylinder by itself after a whole one.
    following = [*order[1:], order[0]]
    return {
        number: (phases[after] - phases[number]) % cycle if number != after else cycle
        for number, after in zip(order, following, strict=True)
    }
