"""Entries of a reciprocating engine, and the angles, orders and ratings that follow from them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from torsionnet.base.entries.composite import Listed, Named
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, Json, Schema, entry, not_none
from torsionnet.base.errors import EntryPath, Fault, UsageError, got
from torsionnet.machinery.excitations.gas_torque import GAS, Crank, GasPressure
from torsionnet.machinery.excitations.order_excitation import (
    MECHANICAL_EFFICIENCIES,
    ORDER,
    FloatArray,
    Rating,
    ReactingExcitation,
)
from torsionnet.machinery.excitations.table_by_pressure import LOAD, EngineLoad
from torsionnet.model.element_base.element_entries import NodeName

# Entries that name cylinders by number.

CYLINDER = Count("number of a cylinder", 1, 99)
EACH = "each"


def number_fault(name: str) -> str | None:
    """Message if a text is no cylinder number from 1 to 99, else None."""
    return None if name.isdecimal() and 0 < int(name) <= 99 else f'cylinders have numbers from 1 to 99, not "{name}"'


class CylindersEntry(Listed[int]):
    """Entry for a list of cylinders, or for ``each``: every cylinder in turn, as a condition of its own."""

    def read(self, raw: object) -> tuple[Any, list[Fault]]:
        if raw == EACH:
            return EACH, []
        if isinstance(raw, str):
            return (), [Fault(f"expected {self.form}, {got(raw)}", kind="wrong-form")]
        return super().read(raw)

    def plain(self, value: Any) -> Json:
        return value if value == EACH else super().plain(value)

    def schema(self) -> Schema:
        return {"description": self.description, "anyOf": [{"const": EACH}, super().schema()]}


GAS_FACTOR = Value("gas torque of a cylinder over that of a sound one", "1", below=10)
MISFIRE_SHARE = Value("share of the injection that a cylinder has lost", "1")


def by_cylinder(description: str, of: Value, form: str) -> Named[float]:
    """Entry for a table of values by cylinder number."""
    return Named(description, of, refused=number_fault, form=form)


# Crank angles at which the cylinders of an engine fire.

FIRING_ANGLE_TOL = math.radians(0.5)
"""Angle in rad by which firing angles may differ from crank and banks, as makers state them to a degree or less."""


def even_phases(order: Sequence[int], cycle: float) -> dict[int, float]:
    """Firing angle in rad by cylinder of an engine that fires evenly over a cycle in rad, the first cylinder at 0.

    >>> [round(math.degrees(angle)) for angle in even_phases([1, 5, 3, 6, 2, 4], 4 * math.pi).values()]
    [0, 120, 240, 360, 480, 600]
    """
    # alpha_i = i cycle/z in the firing order.
    return {number: place * cycle / len(order) for place, number in enumerate(order)}


def banked_phases(
    order: Sequence[int], cycle: float, throws: Mapping[int, str], places: Mapping[int, float]
) -> dict[int, float] | None:
    """Firing angle in rad by cylinder of several banks that share crank pins; None if the order does not fix them.

    All fire evenly if the pins allow that, as in a cross-plane V8. Else those of the bank at angle 0 do, and a cylinder
    in another bank fires when its pin has turned to that bank, in this revolution or the next, as the order says. None
    where the order cannot be had with these banks, or with either revolution.

    Parameters
    ----------
    order : sequence of int
        All cylinders.
    cycle : float
        rad.
    throws : mapping
        Cylinder -> name of its throw.
    places : mapping
        Cylinder -> angle of its bank in the direction of rotation, rad.

    Examples
    --------
    >>> order, throws = [1, 4, 2, 3], {1: "a", 2: "b", 3: "a", 4: "b"}
    >>> places = {1: 0, 2: 0, 3: math.pi / 2, 4: math.pi / 2}
    >>> {number: round(math.degrees(at)) for number, at in banked_phases(order, 4 * math.pi, throws, places).items()}
    {1: 0, 4: 90, 2: 360, 3: 450}
    """
    # Even firing is taken if cylinders on one throw then fire as far apart as their banks stand.
    evenly = even_phases(order, cycle)
    if firing_against_banks(evenly, throws, places) is None:
        return evenly
    leading = even_phases([number for number in order if not places[number]], cycle)
    on_throw = {throws[number]: angle for number, angle in leading.items()}
    turns = [2 * math.pi * number for number in range(round(cycle / (2 * math.pi)))]
    choices = []
    for number in order:
        if number in leading:
            choices.append([leading[number]])
        elif throws[number] not in on_throw:
            return None
        else:
            # The pin reaches the other bank later by the bank angle, at this top dead centre or one revolution on.
            at = on_throw[throws[number]] + places[number]
            choices.append([(at + turn) % cycle for turn in turns])
    return _in_order(order, choices, cycle)


def shares_pins(throws: Mapping[int, str], places: Mapping[int, float]) -> bool:
    """Whether the nodes of the cylinders are crank pins that banks share.

    Cylinders of different banks share a throw, cylinders of one bank do not.
    """
    places_on: dict[str, list[float]] = {}
    for number, throw in throws.items():
        places_on.setdefault(throw, []).append(places.get(number, 0.0))
    several = [angles for angles in places_on.values() if len(angles) > 1]
    return bool(several) and all(len(set(angles)) == len(angles) for angles in several)


def _in_order(order: Sequence[int], choices: Sequence[Sequence[float]], cycle: float) -> dict[int, float] | None:
    """Firing angle in rad by cylinder, one of its choices each, with which the cylinders fire in this order.

    None if no or several choices do.
    """
    sequences: list[list[float]] = [[angle] for angle in choices[0]]
    for further in choices[1:]:
        sequences = [
            [*before, angle]
            # Each cylinder fires after the one before, counted from the first one within one cycle.
            for before, angle in itertools.product(sequences, further)
            if (before[-1] - before[0]) % cycle < (angle - before[0]) % cycle - FIRING_ANGLE_TOL / 10
        ]
    if len(sequences) != 1:
        return None
    return {number: (angle - sequences[0][0]) % cycle for number, angle in zip(order, sequences[0], strict=True)}


def firing_against_banks(
    phases: Mapping[int, float], throws: Mapping[int, str], places: Mapping[int, float]
) -> tuple[int, int, float, float] | None:
    """Numbers and angles of the first two cylinders on one throw whose firing angles do not fit their banks, or None.

    The tuple is (cylinder, cylinder, angle between them in rad, angle by their banks in rad).

    Firing comes once in a cycle and top dead centre once in a revolution, so whole revolutions do not count.
    """
    if not shares_pins(throws, places):
        return None
    for cylinder, other in itertools.combinations(phases, 2):
        if throws[cylinder] == throws[other]:
            apart, due = phases[other] - phases[cylinder], places[other] - places[cylinder]
            # One throw: both are at top dead centre apart by the bank angle, but for whole revolutions.
            if abs(math.remainder(apart - due, 2 * math.pi)) > FIRING_ANGLE_TOL:
                return cylinder, other, apart, due
    return None


MEAN = np.zeros(1)
"""Orders of the mean torque alone: a mean value is the harmonic of order 0."""
DEFAULT_HIGHEST_ORDERS = {4: 12.0, 2: 15.0}
"""Highest order of an engine without an entry ``orders``, by number of strokes in its cycle."""


@dataclass(frozen=True, kw_only=True)
class EngineEntries(ReactingExcitation):
    """Base class of engines: cylinders on a crankshaft, their firing, gas and reciprocating masses."""

    speed_of: str = entry(NodeName("a node of the crankshaft; orders count its revolutions", allow_ground=False))
    cycle: int = entry(Count("strokes of a cycle: 2 or 4", 2, 4))
    cylinders: Mapping[str, str] = entry(
        Named(
            "number of each cylinder -> the node its throw is on",
            NodeName("", allow_ground=False),
            form="{1: c1, 2: c2}",
            fewest=1,
            refused=number_fault,
        )
    )
    firing_order: tuple[int, ...] = entry(
        Listed("the cylinders as they fire, evenly but for banks", CYLINDER, form="a list of cylinders"),
        (),
    )
    firing_angles: Mapping[str, float] = entry(
        by_cylinder(
            "instead: cylinder -> crank angle after the first at which it fires",
            Value("angle at which a cylinder fires", "angle", lower=None),
            "{1: 0 deg, 2: 90 deg}",
        ),
        None,
    )
    phase: float | None = entry(
        Value(
            "beside other engines: crank angle by which it fires later than the first engine of the model; without it "
            "the angle between two crankshafts is not known, and the worst counts",
            "angle",
            lower=None,
        ),
        None,
    )
    banks: Mapping[str, tuple[int, ...]] = entry(
        Named(
            "of a V engine: name of each bank -> its cylinders, in the direction of rotation",
            Listed("its cylinders", CYLINDER, form="a list of cylinders"),
            form="{A: [1, 2, 3], B: [4, 5, 6]}",
        ),
        None,
    )
    bank_angle: float | None = entry(
        Value("from a bank to the next, in the direction of rotation", "angle", exclusive=True), None
    )
    bore: float = entry(Value("diameter of a cylinder", "length", exclusive=True))
    stroke: float = entry(Value("twice the crank radius", "length", exclusive=True))
    rod_length: float = entry(Value("connecting rod between its centres", "length", exclusive=True))
    piston_rod: float = entry(Value("diameter of the rod below a double-acting piston", "length"), 0)
    reciprocating_mass: float = entry(Value("piston, pin and the rod's share, of one cylinder", "mass"), 0)
    gas: GasPressure | None = entry(GAS, None)
    load: EngineLoad | None = entry(LOAD, None)
    misfire: tuple[int, ...] | str = entry(
        CylindersEntry(
            "cylinders without injection, which follow the motored trace; each: one after the other, the worst counts",
            CYLINDER,
            form="a list of cylinders, or each",
        ),
        (),
    )
    misfire_share: Mapping[str, float] = entry(
        by_cylinder(
            "cylinders that misfire in part: share of the way from the fired to the motored gas torque",
            MISFIRE_SHARE,
            "{4: 30 %}",
        ),
        None,
    )
    gas_off: tuple[int, ...] = entry(
        Listed(
            "cylinders without any gas torque, as with the running gear removed", CYLINDER, form="a list of cylinders"
        ),
        (),
    )
    factors: Mapping[str, float] = entry(
        by_cylinder("gas torque of cylinders that differ, over that of the others", GAS_FACTOR, "{3: 0.8}"), None
    )
    spread: float = entry(Value("gas torques differ by as much up or down, in the worst combination", "1", below=1), 0)
    orders: tuple[float, ...] = entry(
        Listed(
            "the orders that act; default: 0.5 to 12 of a four-stroke, 1 to 15 of a two-stroke engine",
            ORDER,
            form="a list of orders",
        ),
        (),
    )

    @property
    def revolutions(self) -> int:
        """Number of crank revolutions in a cycle of the engine: 1 for two strokes, 2 for four."""
        return int(self.cycle) // 2

    @cached_property
    def numbers(self) -> Mapping[int, str]:
        """Node of each cylinder, by cylinder number."""
        return {int(number): node for number, node in self.cylinders.items()}

    @property
    def shaft(self) -> str:
        return str(self.speed_of)

    @property
    def crankshaft(self) -> frozenset[str]:
        return frozenset({self.shaft, *self.numbers.values()})

    @property
    def is_phased(self) -> bool:
        return self.phase is not None

    @property
    def has_lost_cylinder(self) -> bool:
        """Whether a cylinder works without injection or without gas torque: what is called misfire of an engine."""
        return bool(self.misfire) or bool(self.gas_off)

    @property
    def is_unloaded_evenly(self) -> bool:
        """Whether all cylinders of a compressor are unloaded: that is a load of its own, and no cylinder is out."""
        return self.absorbs and self.misfire != EACH and {*self.numbers} == {*self.misfire, *self.gas_off}

    @property
    def has_lost_torque(self) -> bool:
        """Whether a cylinder works without injection or gas torque, or has lost a share of its injection."""
        return self.has_lost_cylinder or any((self.misfire_share or {}).values())

    def all_working(self) -> Self:
        """Copy of the engine in which every cylinder has its injection and gas torque."""
        return self.unchecked(misfire=(), gas_off=(), misfire_share=None) if self.has_lost_torque else self

    def mean_torque_shares(self, speeds: FloatArray) -> dict[int, FloatArray]:
        """Mean gas torque of each cylinder over that of the same cylinder working, (n_speeds,), by cylinder number.

        Working cylinders keep their pressures (1). Without gas torque a cylinder gives nothing (0); without injection
        the mean of the motored trace over that of the fired one counts, and nothing where tables by order say no mean.
        Where each cylinder misfires in turn, all have the mean over the cases: their sum is that of any one case.

        Parameters
        ----------
        speeds : (n_speeds,) array
            rad/s, of the crankshaft, above 0.

        Examples
        --------
        >>> engine = EngineEntries(speed_of="c1", cycle=2, cylinders={1: "c1", 2: "c2"}, firing_order=[1, 2],
        ...     bore="100 mm", stroke="120 mm", rod_length="240 mm", gas_off=[2])
        >>> {number: share.tolist() for number, share in engine.mean_torque_shares(np.array([100.0])).items()}
        {1: [1.0], 2: [0.0]}
        """
        whole, out = np.ones(len(speeds)), {*self.gas_off}
        silent = {*self.numbers} if self.misfire == EACH else {*self.misfire}
        shares = {int(number): share for number, share in (self.misfire_share or {}).items()}
        without = self._motored_share(speeds) if silent or shares else whole
        part = without
        if self.misfire == EACH:
            # One cylinder is out at a time: on average each has lost 1/z of what it lacks without injection.
            without = 1 - (1 - without) / len(self.numbers)
        mean_shares = {number: whole + shares.get(number, 0.0) * (part - whole) for number in self.numbers}
        return mean_shares | dict.fromkeys(silent, without) | dict.fromkeys(out, 0 * whole)

    def _motored_share(self, speeds: FloatArray) -> FloatArray:
        """Mean gas torque of a cylinder without injection over that with it, (n_speeds,), 0 where neither is known."""
        gas, nothing = self.gas, np.zeros(len(speeds))
        if gas is None:
            return nothing
        try:
            fired = gas.fired_harmonics(self.crank, MEAN, self.indicated_pressures(speeds), speeds)[:, 0].real
        except UsageError:  # a load beyond the traces, of which the torques by order say it
            return nothing
        # Order 0 of a trace is twice its mean, with injection and without: the ratio is that of the means.
        motored = gas.motored_harmonics_at(self.crank, MEAN)[0].real
        return np.asarray(np.divide(motored, fired, out=nothing, where=np.broadcast_to(fired != 0, nothing.shape)))

    def at_load(self, share: float) -> Self:
        """Copy of the engine at a share of its rated mean indicated pressure.

        Tables by pressure are read there at all speeds. Of a single trace or table each cylinder goes the same share
        of the way from the motored to the fired gas torque, from nothing where there is no motored one.

        Examples
        --------
        >>> engine = EngineEntries(speed_of="c1", cycle=2, cylinders={1: "c1", 2: "c2"}, firing_order=[1, 2],
        ...     bore="100 mm", stroke="120 mm", rod_length="240 mm", load={"mean_indicated_pressure": "20 bar"},
        ...     gas={"harmonics": {"20 bar": {1: {"amplitude": "3 bar", "phase": 0}}}})
        >>> engine.at_load(0.15).indicated_pressures(np.array([100.0])).tolist()
        [300000.0]
        """
        if self.gas is None:
            return self
        if self.load is not None:
            pressure = share * self.load.rated_pressure(self.swept_volume, self.revolutions)
            return self.unchecked(load=self.load.unchecked(
                mean_indicated_pressure=pressure, power=None, mechanical_efficiency=None, exponent=0.0, over_speed=()
            ))  # fmt: skip
        if self.gas.is_by_pressure:  # a single table holds at all loads
            return self
        silent = {*(() if self.misfire == EACH else self.misfire), *self.gas_off}
        known = self.misfire_share or {}
        lost = {str(n): 1 - share * (1 - known.get(str(n), 0.0)) for n in self.numbers if n not in silent}
        return self.unchecked(misfire_share=lost)

    @cached_property
    def absorbs(self) -> bool:
        """Whether the pressure traces take work out of the shaft, as those of a compressor do.

        Gas given by order counts as an engine.
        """
        gas = self.gas
        if gas is None:
            return False
        traces = [gas.fired, *(gas.traces or {}).values()]
        means = [
            trace.mean_indicated_pressure(self.crank.ratio, self.revolutions, gas.zero) for trace in traces if trace
        ]
        return bool(means) and max(means) < 0

    @property
    def node_entries(self) -> tuple[tuple[EntryPath, str], ...]:
        return tuple((("cylinders", number), node) for number, node in self.cylinders.items())

    @cached_property
    def cylinder_bank_angles(self) -> dict[int, float]:
        """Bank angle in rad of each cylinder, by cylinder number; empty without banks."""
        banks = (self.banks or {}).values()
        return {number: place * not_none(self.bank_angle) for place, bank in enumerate(banks) for number in bank}

    @cached_property
    def acting_phases(self) -> dict[int, float]:
        """Crank angle in rad at which each cylinder fires, by number, counted from the first engine of the model."""
        return {number: angle + (self.phase or 0.0) for number, angle in self.firing_phases.items()}

    @cached_property
    def firing_phases(self) -> dict[int, float]:
        """Crank angle in rad at which each cylinder fires, by number, counted from the first cylinder."""
        if self.firing_angles:
            return {int(number): float(angle) for number, angle in self.firing_angles.items()}
        cycle = self.cycle * math.pi
        if self.banks:
            return banked_phases(self.firing_order, cycle, self.numbers, self.cylinder_bank_angles) or {}
        return even_phases(self.firing_order, cycle)

    @cached_property
    def acting_orders(self) -> FloatArray:
        """Orders of the engine's torque per crank revolution, rising, shape (n_orders,).

        As given, or the usual ones with the orders of tables of harmonics.
        """
        if self.orders:
            return np.array(sorted(self.orders))
        # A cycle of c strokes takes c/2 revolutions: the lowest order is 2/c, of which all others are multiples.
        step = 2 / self.cycle
        own = [order for _, order in self.gas.own_orders] if self.gas else []
        return np.array(sorted({*np.arange(step, DEFAULT_HIGHEST_ORDERS[self.cycle] + step / 2, step).tolist(), *own}))

    @cached_property
    def crank(self) -> Crank:
        return Crank(self.bore, self.stroke, self.rod_length, self.revolutions, self.piston_rod)

    @property
    def rating(self) -> Rating | None:
        """Rated torque of the engine in N m by the power of the load, else by the mean indicated pressure.

        None without.
        """
        load, gas = self.load, self.gas
        if load is not None and load.over_speed:
            return None
        if load is not None and load.power is not None:
            speed, power = not_none(load.rated), load.power
            return Rating(power / speed, ("load", "power"), speed, ("load", "rated"), power, load.exponent)
        if load is not None:
            pressure = not_none(load.mean_indicated_pressure)
            return self._indicated(pressure, ("load", "mean_indicated_pressure"), load, "load")
        if gas is not None and gas.fired and not gas.crank_end:
            pressure = gas.fired.mean_indicated_pressure(self.crank.ratio, self.revolutions, gas.zero)
            return self._indicated(pressure, ("gas", "fired"), gas, "gas")
        return None

    def _indicated(self, pressure: float, path: EntryPath, at: Any, key: str) -> Rating:
        """Rated torque of the engine in N m by the mean gas torque on its pistons.

        ``at`` is the entry with the rated speed.
        """
        # T = p_mi V_h z/(2 pi revolutions), the work of all cylinders in a cycle over its angle.
        torque = pressure * self.swept_volume / (2 * math.pi * self.revolutions)
        speed_path: EntryPath = (key, "rated") if at.rated else ()
        shares = MECHANICAL_EFFICIENCIES if torque > 0 else (1.0, 1 / MECHANICAL_EFFICIENCIES[0])
        return Rating(torque, path, at.rated, speed_path, exponent=at.exponent, shares=shares)

    def indicated_pressures(self, speeds: FloatArray) -> FloatArray | None:
        """Mean indicated pressure in Pa at speeds in rad/s, shape (n_speeds,).

        None for a single trace, which does not depend on it.
        """
        if self.load is None:
            return None
        return np.asarray(self.load.at(speeds, self.swept_volume, self.revolutions))

    @property
    def swept_volume(self) -> float:
        """Swept volume of all cylinders of the engine in m^3."""
        return self.crank.swept_volume * len(self.numbers)
