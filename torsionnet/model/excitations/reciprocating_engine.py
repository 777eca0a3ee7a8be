"""Engines, compressors and pumps with pistons: gas and inertia torques of every cylinder."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from torsionnet.core.entries.composite import Listed, Named
from torsionnet.core.entries.scalars import Value
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import Count
from torsionnet.core.errors import Fault, Path
from torsionnet.model.elements.nodes import NodeName
from torsionnet.model.excitations.gas_torque import GAS, piston_area
from torsionnet.model.excitations.order_excitation import (
    ORDER,
    ComplexArray,
    FloatArray,
    OrderExcitation,
    OrderTorques,
    register_excitation,
)
from torsionnet.model.excitations.slider_crank import harmonics, inertia_harmonics, piston_rate

_CYLINDER = Count("number of a cylinder", 1, 99)


def _number_fault(name: str) -> str | None:
    """Why a cylinder cannot be called so."""
    return None if name.isdecimal() and 0 < int(name) <= 99 else f'cylinders have numbers from 1 to 99, not "{name}"'


_ANGLE = Value("angle at which a cylinder fires", "angle", lower=None)
HIGHEST = {4: 12.0, 2: 15.0}
"""Orders unless others are given."""


@register_excitation
@dataclass(frozen=True, kw_only=True)
class ReciprocatingEngine(OrderExcitation):
    """Pistons on a crankshaft: gas torque from pressure traces, inertia torque exact from the slider crank.

    With x(phi) the way of a piston from top dead centre over the crank radius r, the gas torque of a cylinder is
    (p - p_crankcase) A r x' and the inertia torque -m r^2 Omega^2 x' x''. Cylinder i acts with T(phi - alpha_i),
    alpha_i the angle at which it fires; phi is 0 at firing top dead centre of the first.

    Examples
    --------
    >>> engine = ReciprocatingEngine(speed_of="c1", cycle=4, cylinders={1: "c1", 2: "c2"}, firing_order=[1, 2],
    ...     bore="100 mm", stroke="120 mm", rod_length="240 mm", reciprocating_mass="1 kg")
    >>> torques = engine.torques(np.array([100.0]))
    >>> torques.nodes, float(abs(torques.amplitudes[0, torques.orders == 2, 0]).round(3).item())
    (('c1', 'c2'), 18.005)
    """

    kind: ClassVar[str] = "reciprocating_engine"

    speed_of: Any = entry(NodeName("a node of the crankshaft; orders count its revolutions", allow_ground=False))
    cycle: Any = entry(Count("strokes of a cycle: 2 or 4", 2, 4))
    cylinders: Any = entry(
        Named(
            "number of each cylinder -> the node its throw is on",
            NodeName("", allow_ground=False),
            form="{1: c1, 2: c2}",
            fewest=1,
            refused=_number_fault,
        )
    )
    firing_order: Any = entry(
        Listed(
            "the cylinders in the order they fire, evenly over the cycle",
            _CYLINDER,
            form="a list such as [1, 5, 3, 6, 2, 4]",
        ),
        (),
    )
    firing_angles: Any = entry(
        Named(
            "instead: cylinder -> crank angle after the first at which it fires",
            _ANGLE,
            refused=_number_fault,
            form="{1: 0 deg, 2: 90 deg}",
        ),
        None,
    )
    bore: Any = entry(Value("diameter of a cylinder", "length", exclusive=True))
    stroke: Any = entry(Value("twice the crank radius", "length", exclusive=True))
    rod_length: Any = entry(Value("connecting rod between its centres", "length", exclusive=True))
    reciprocating_mass: Any = entry(Value("piston, pin and the rod's share, of one cylinder", "mass"), 0)
    gas: Any = entry(GAS, None)
    misfire: Any = entry(
        Listed("cylinders without injection; they follow the motored trace", _CYLINDER, form="a list of cylinders"), ()
    )
    gas_off: Any = entry(
        Listed(
            "cylinders without any gas torque, as with the running gear removed", _CYLINDER, form="a list of cylinders"
        ),
        (),
    )
    orders: Any = entry(
        Listed(
            "the orders that act; default: 0.5 to 12 of a four-stroke, 1 to 15 of a two-stroke engine",
            ORDER,
            form="a list of orders",
        ),
        (),
    )

    def contradictions(self) -> list[Fault]:
        faults = [*self._wrong_mechanism(), *self._wrong_firing(), *self._wrong_cylinders()]
        if self.misfire and (self.gas is None or not self.gas.motored):
            text = "a cylinder without injection follows the motored trace; give gas: {motored: [...]}"
            faults.append(Fault(text, ("misfire",), on_key=True))
        return faults

    def _wrong_mechanism(self) -> Iterator[Fault]:
        radius, per_cycle = self.stroke / 2, self.cycle / 2
        if self.cycle not in HIGHEST:
            yield Fault("a cycle has 2 or 4 strokes", ("cycle",))
        if self.rod_length <= radius:
            text = f"a rod of {self.rod_length:g} m is shorter than the crank radius {radius:g} m"
            yield Fault(text, ("rod_length",))
        odd = [f"{order:g}" for order in self.orders if abs(order * per_cycle - round(order * per_cycle)) > 1e-9]
        if odd and self.cycle in HIGHEST:
            name = "four" if self.cycle == 4 else "two"
            text = f"orders of a {name}-stroke engine are multiples of {1 / per_cycle:g}, not {', '.join(odd)}"
            yield Fault(text, ("orders",))

    def _wrong_firing(self) -> Iterator[Fault]:
        if bool(self.firing_order) == bool(self.firing_angles):
            yield Fault("an engine needs firing_order or firing_angles, one of the two", on_key=True)
            return
        key = "firing_order" if self.firing_order else "firing_angles"
        given = list(self.firing_order) or [int(number) for number in self.firing_angles]
        found = {
            "misses cylinder": [number for number in self.numbers if number not in given],
            "has twice cylinder": sorted({number for number in given if given.count(number) > 1}),
            "has a cylinder that the engine lacks:": [number for number in given if number not in self.numbers],
        }
        for text, wrong in found.items():
            if wrong:
                yield Fault(f"{key} {text} {_listed(wrong)}; there are {_listed(self.numbers)}", (key,), on_key=True)

    def _wrong_cylinders(self) -> Iterator[Fault]:
        for key in ("misfire", "gas_off"):
            for index, number in enumerate(getattr(self, key)):
                if number not in self.numbers:
                    yield Fault(f"there is no cylinder {number}; there are {_listed(self.numbers)}", (key, index))

    @property
    def numbers(self) -> Mapping[int, str]:
        """Node by number of cylinder."""
        return {int(number): node for number, node in self.cylinders.items()}

    @property
    def shaft(self) -> str:
        return str(self.speed_of)

    @property
    def node_entries(self) -> tuple[tuple[Path, str], ...]:
        return tuple((("cylinders", number), node) for number, node in self.cylinders.items())

    @cached_property
    def firing_phases(self) -> dict[int, float]:
        """Crank angle in rad at which each cylinder fires."""
        if self.firing_angles:
            return {int(number): float(angle) for number, angle in self.firing_angles.items()}
        step = self.cycle * math.pi / len(self.firing_order)
        return {number: place * step for place, number in enumerate(self.firing_order)}

    @cached_property
    def acting_orders(self) -> FloatArray:
        """The orders, rising."""
        step = 2 / self.cycle
        return np.array(sorted(self.orders)) if self.orders else np.arange(step, HIGHEST[self.cycle] + step / 2, step)

    def phase_vectors(self, order: float) -> dict[str, tuple[str, complex]]:
        silent = {*self.misfire, *self.gas_off}
        return {
            str(number): (node, 0j if number in silent else complex(np.exp(-1j * order * self.firing_phases[number])))
            for number, node in self.numbers.items()
        }

    def torques(self, speeds: FloatArray) -> OrderTorques:
        orders, ratio, radius = self.acting_orders, self.stroke / 2 / self.rod_length, self.stroke / 2
        inertia = self.reciprocating_mass * radius**2 * inertia_harmonics(ratio, orders)
        moving = speeds[:, None] ** 2 * inertia
        gas = {kind: self._gas_harmonics(kind) for kind in ("fired", "motored")}
        factor = self.gas.factor(speeds)[:, None] if self.gas else np.ones((len(speeds), 1))
        nodes = self.nodes
        found = np.zeros((len(speeds), len(orders), len(nodes)), dtype=complex)
        for number, node in self.numbers.items():
            one = moving
            if number not in self.gas_off:
                one = moving + factor * gas["motored" if number in self.misfire else "fired"]
            found[:, :, nodes.index(node)] += one * np.exp(-1j * orders * self.firing_phases[number])
        return OrderTorques(orders, nodes, found)

    def _gas_harmonics(self, kind: str) -> ComplexArray:
        if self.gas is None or not getattr(self.gas, kind):
            return np.zeros(len(self.acting_orders), dtype=complex)
        pressure = self.gas.over_crankcase(motored=kind == "motored")
        angle = self.cycle * np.pi * np.arange(len(pressure)) / len(pressure)
        torque = (
            pressure * piston_area(self.bore) * self.stroke / 2 * piston_rate(angle, self.stroke / 2 / self.rod_length)
        )
        return harmonics(torque, self.cycle // 2, self.acting_orders)


def _listed(numbers: Iterable[int]) -> str:
    return ", ".join(map(str, numbers))
