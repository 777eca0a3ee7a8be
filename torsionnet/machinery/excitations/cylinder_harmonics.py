"""Harmonics of the torque of one cylinder with gas and mass apart, firing intervals, and mean indicated pressures."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from torsionnet.machinery.excitations.order_excitation import FloatArray
from torsionnet.machinery.excitations.reciprocating_engine import ReciprocatingEngine
from torsionnet.machinery.excitations.slider_crank import inertia_harmonics
from torsionnet.machinery.phasors.engine_harmonics import CylinderHarmonic, IndicatedPressure


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
    >>> [(one.order, round(one.inertia), round(one.torque, 3)) for one in cylinder_harmonics(engine, 100.0)]
    [(1.0, 4852, 2.286), (2.0, 38207, 18.005)]
    """
    crank, orders = engine.crank, engine.acting_orders
    inertia = engine.reciprocating_mass * (crank.radius * speed) ** 2 * inertia_harmonics(crank.ratio, orders)
    gas = engine.fired_harmonics(np.array([speed]))[0]
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
    >>> (one,) = indicated_pressures(engine, np.array([100.0]))  # 20 bar of 0.94248 l in two revolutions
    >>> round(one.pressure), round(one.torque, 3)
    (2000000, 150.0)
    """
    pressures = engine.indicated_pressures(speeds)
    if pressures is None:
        own = _of_traces(engine)
        if own is None or engine.gas is None:
            return ()
        pressures = own * engine.gas.factor(speeds)
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
        only = [pressure for pressure in (gas.traces or gas.harmonics or {}) if pressure is not None]
        return only[0] if len(only) == 1 else None
    if gas.fired is None:
        return None
    ratio, revolutions = engine.crank.ratio, engine.revolutions
    mean = gas.fired.mean_indicated_pressure(ratio, revolutions, gas.zero)
    if gas.crank_end:
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
    following = [*order[1:], order[0]]
    return {
        number: (phases[after] - phases[number]) % cycle if number != after else cycle
        for number, after in zip(order, following, strict=True)
    }
