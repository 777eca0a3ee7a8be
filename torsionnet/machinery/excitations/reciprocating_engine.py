"""Excitation by engines, compressors and pumps with pistons: gas and inertia torques of every cylinder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.errors import Fault, UsageError
from torsionnet.machinery.excitations.cylinder_entries import EACH
from torsionnet.machinery.excitations.engine_entries import EngineEntries
from torsionnet.machinery.excitations.engine_faults import engine_faults, engine_remarks
from torsionnet.machinery.excitations.order_excitation import (
    ComplexArray,
    FloatArray,
    OrderTorques,
    TorqueShares,
    register_excitation,
)
from torsionnet.machinery.excitations.slider_crank import inertia_harmonics


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
        phase_factors = {number: np.exp(-1j * order * angle) for number, angle in self.acting_phases.items()}
        return {
            str(number): (node, complex(sizes[number] * phase_factors[number])) for number, node in self.numbers.items()
        }

    def torques(self, speeds: FloatArray) -> OrderTorques:
        orders, nodes = self.acting_orders, self.nodes
        inertia = self.reciprocating_mass * self.crank.radius**2 * inertia_harmonics(self.crank.ratio, orders)
        moving = speeds[:, None] ** 2 * inertia
        phase_factors = {number: np.exp(-1j * orders * angle) for number, angle in self.acting_phases.items()}
        fired, motored = self.fired_harmonics(speeds), self._motored(speeds)
        gas = {number: self._gas_of(number, fired, motored) * phase_factors[number] for number in self.numbers}
        found = np.zeros((len(speeds), len(orders), len(nodes)), dtype=complex)
        for number, node in self.numbers.items():
            found[:, :, nodes.index(node)] += moving * phase_factors[number] + gas[number]
        sound = [number for number in self.numbers if number not in self.gas_off]
        misfires = {number: motored * phase_factors[number] - gas[number] for number in sound}
        scatter = {number: self.spread * gas[number] for number in sound if number not in self._without_injection}
        return OrderTorques(
            orders,
            nodes,
            found,
            alternatives=self._shares("misfire of cylinder", misfires) if self.misfire == EACH else None,
            scatter=self._shares("cylinder", scatter) if self.spread else None,
        )

    def _shares(self, what: str, torques: Mapping[int, ComplexArray]) -> TorqueShares:
        """Torque shares of the engine by cylinder, to be added to the sum of all cylinders."""
        return TorqueShares(
            tuple(f"{what} {number}" for number in torques),
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
            found = self.gas.fired_harmonics(self.crank, self.acting_orders, self.indicated_pressures(speeds))
        except UsageError as error:
            raise UsageError(f"engine on {self.shaft}: {error}") from None
        return np.asarray(self.gas.factor(speeds)[:, None] * np.broadcast_to(found, shape))

    def _motored(self, speeds: FloatArray) -> ComplexArray:
        if self.gas is None:
            return np.zeros((len(speeds), len(self.acting_orders)), dtype=complex)
        return np.asarray(
            self.gas.factor(speeds)[:, None] * self.gas.motored_harmonics_at(self.crank, self.acting_orders)
        )
