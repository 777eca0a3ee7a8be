"""Entries of a reciprocating engine, and the angles, orders and ratings that follow from them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from torsionnet.base.entries.composite import Listed, Named
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, entry, not_none
from torsionnet.base.errors import EntryPath, UsageError
from torsionnet.machinery.excitations.cylinder_entries import (
    CYLINDER,
    EACH,
    GAS_FACTOR,
    MISFIRE_SHARE,
    CylindersEntry,
    by_cylinder,
    number_fault,
)
from torsionnet.machinery.excitations.engine_load import LOAD, EngineLoad
from torsionnet.machinery.excitations.firing_angles import banked_phases, even_phases
from torsionnet.machinery.excitations.gas_torque import GAS, Crank, GasPressure
from torsionnet.machinery.excitations.order_excitation import ORDER, FloatArray, ReactingExcitation
from torsionnet.machinery.excitations.rating import MECHANICAL_EFFICIENCIES, Rating
from torsionnet.model.element_base.element_entries import NodeName

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
    def has_lost_torque(self) -> bool:
        """Whether a cylinder works without injection or gas torque, or has lost a share of its injection."""
        return self.has_lost_cylinder or any((self.misfire_share or {}).values())

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
            without = 1 - (1 - without) / len(self.numbers)
        found = {number: whole + shares.get(number, 0.0) * (part - whole) for number in self.numbers}
        return found | dict.fromkeys(silent, without) | dict.fromkeys(out, 0 * whole)

    def _motored_share(self, speeds: FloatArray) -> FloatArray:
        """Mean gas torque of a cylinder without injection over that with it, (n_speeds,), 0 where neither is known."""
        gas, nothing = self.gas, np.zeros(len(speeds))
        if gas is None:
            return nothing
        try:
            fired = gas.fired_harmonics(self.crank, MEAN, self.indicated_pressures(speeds))[:, 0].real
        except UsageError:  # a load beyond the traces, of which the torques by order say it
            return nothing
        motored = gas.motored_harmonics_at(self.crank, MEAN)[0].real
        return np.asarray(np.divide(motored, fired, out=nothing, where=np.broadcast_to(fired != 0, nothing.shape)))

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
        torque = pressure * self.crank.swept_volume * len(self.numbers) / (2 * math.pi * self.revolutions)
        speed_path: EntryPath = (key, "rated") if at.rated else ()
        shares = MECHANICAL_EFFICIENCIES if torque > 0 else (1.0, 1 / MECHANICAL_EFFICIENCIES[0])
        return Rating(torque, path, at.rated, speed_path, exponent=at.exponent, shares=shares)

    def indicated_pressures(self, speeds: FloatArray) -> FloatArray | None:
        """Mean indicated pressure in Pa at speeds in rad/s, shape (n_speeds,).

        None for a single trace, which does not depend on it.
        """
        if self.load is None:
            return None
        return np.asarray(self.load.at(speeds, self.crank.swept_volume * len(self.numbers), self.revolutions))
