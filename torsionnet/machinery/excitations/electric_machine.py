"""Air-gap torques of motors and generators by speed, line frequency, slip and short circuit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from torsionnet.base.entries.composite import Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Count, entry, not_none
from torsionnet.base.errors import LEAVE_OUT, EntryPath, Fault, Remedy
from torsionnet.machinery.excitations.harmonic_torque import (
    FREQUENCY,
    PHASE,
    SpeedRows,
    SpeedTable,
    TableByOrder,
    not_covered,
    over_speed,
)
from torsionnet.machinery.excitations.order_excitation import (
    ComplexArray,
    FloatArray,
    OrderExcitation,
    OrderTorques,
    register_excitation,
)
from torsionnet.model.element_base.element_entries import NodeName

_LINE_FREQUENCY = Value("frequency of the line or inverter", "frequency", exclusive=True, below=1e6)


@dataclass(frozen=True, kw_only=True)
class AirGapTorque(Declared):
    """Peak value (N m, share of the torque at that speed, or both) and phase (rad) of one air-gap torque pulsation."""

    kind: ClassVar[str] = "pulsation"
    article: ClassVar[str] = "a pulsation"
    form: ClassVar[str] = "{amplitude: 40 N*m, phase: 0 deg} or {share: 2 %}"

    amplitude: float = entry(Value("peak value, the same at all speeds (cogging)", "torque"), 0)
    share: float = entry(Value("peak value over the torque of the machine at that speed (ripple)", "1", below=10), 0)
    phase: float = entry(PHASE, 0)

    def contradictions(self) -> list[Fault]:
        if self.amplitude or self.share:
            return []
        return [Fault(f"a pulsation has an amplitude, a share or both: {self.form}", on_key=True, kind="missing-entry")]


_PULSATION = Nested("peak value and phase", lambda: AirGapTorque, "air_gap_torque", shown="{share: 2 %}")


@dataclass(frozen=True, kw_only=True)
class LineTorques(Declared):
    """Pulsations at multiples of a line or inverter frequency, which do not follow the speed."""

    kind: ClassVar[str] = "line"
    article: ClassVar[str] = "a line"
    form: ClassVar[str] = "{frequency: 50 Hz, multiples: {6: {share: 2 %}, 12: {share: 1 %}}}"

    frequency: float = entry(_LINE_FREQUENCY)
    multiples: Mapping[float, AirGapTorque] = entry(
        TableByOrder("multiple of the frequency -> peak value and phase", _PULSATION)
    )


@dataclass(frozen=True, kw_only=True)
class SlipTorque(Declared):
    """The pulsation of a starting synchronous motor, at twice the slip frequency."""

    kind: ClassVar[str] = "slip"
    article: ClassVar[str] = "a slip"
    form: ClassVar[str] = "{frequency: 50 Hz, amplitude: [[0 rpm, 60 kN*m], [1500 rpm, 40 kN*m]]}"

    frequency: float = entry(_LINE_FREQUENCY)
    amplitude: SpeedRows = entry(SpeedTable("rows [speed, peak value]", Value("peak value of a torque", "torque")))
    phase: float = entry(PHASE, 0)


@dataclass(frozen=True, kw_only=True)
class ShortCircuit(Declared):
    """Torque of a short circuit at once and twice the line frequency, with the amplitude it has at its beginning."""

    kind: ClassVar[str] = "short_circuit"
    article: ClassVar[str] = "a short circuit"
    form: ClassVar[str] = "{frequency: 50 Hz, phases: 2, once: 90 kN*m, twice: 45 kN*m}"

    frequency: float = entry(_LINE_FREQUENCY)
    phases: int = entry(Count("how many phases are short: 1, 2 or 3", 1, 3))
    once: float = entry(Value("peak value at the line frequency", "torque", exclusive=True))
    twice: float = entry(Value("peak value at twice the line frequency; none with three phases", "torque"), 0)
    phase: float = entry(PHASE, 0)

    def contradictions(self) -> list[Fault]:
        if self.phases == 3 and self.twice:
            return [
                Fault(
                    "three phases short give a torque at the line frequency only; leave out twice",
                    ("twice",),
                    remedy=Remedy(LEAVE_OUT),
                    kind="needless-entry",
                )
            ]
        return []


class _Pulsation(NamedTuple):
    """Order, fixed frequency in Hz and complex amplitude in N m over speed of an air-gap torque pulsation."""

    order: float
    fixed: float
    amplitude: ComplexArray | complex


@register_excitation
@dataclass(frozen=True, kw_only=True)
class ElectricMachine(OrderExcitation):
    """The air-gap torque of a motor or generator, on its rotor and oppositely on its stator.

    ``orders`` count mechanical revolutions of the rotor, ``electrical_orders`` electrical periods, of which one
    revolution has as many as there are pole pairs. While a synchronous motor starts, its saliency makes a torque at
    twice the slip frequency, 2 (1 - n/n_sync) f_line, n_sync = f_line/pole_pairs. A short circuit dies away: its lines
    are those of its beginning, and bound what it does.

    Examples
    --------
    >>> motor = ElectricMachine(node="rotor", pole_pairs=4, rated_torque="1 kN*m",
    ...     electrical_orders={6: {"share": "2 %"}}, line={"frequency": "50 Hz", "multiples": {6: {"amplitude": 5}}})
    >>> ripple = motor.torques(np.array([100.0]))
    >>> ripple.orders.tolist(), ripple.fixed.tolist(), ripple.amplitudes.real[0, :, 0].tolist()
    ([24.0, 0.0], [0.0, 300.0], [20.0, 5.0])
    """

    kind: ClassVar[str] = "electric_machine"

    node: str = entry(NodeName("the node of the rotor; orders count its revolutions", allow_ground=False))
    stator: str | None = entry(NodeName("the node of the stator, if it gives way", allow_ground=False), None)
    pole_pairs: int | None = entry(Count("electrical periods of a revolution", 1, 10_000), None)
    rated_torque: float | None = entry(Value("torque of which shares are taken", "torque", exclusive=True), None)
    torque: SpeedRows | None = entry(
        SpeedTable("rows [speed, share of the rated torque] that the machine has there", Value("a share", "1")), None
    )
    orders: Mapping[float, AirGapTorque] = entry(
        TableByOrder("order of the rotor -> peak value and phase", _PULSATION, fewest=0), None
    )
    electrical_orders: Mapping[float, AirGapTorque] = entry(
        TableByOrder("order of the electrical period -> the same", _PULSATION, fewest=0), None
    )
    line: LineTorques | None = entry(
        Nested("multiples of the line frequency", lambda: LineTorques, "line_torques"), None
    )
    frequencies: Mapping[float, AirGapTorque] = entry(
        TableByOrder(
            "frequency -> the same; interharmonics |m f1 + n f2| and others", _PULSATION, FREQUENCY, "frequency"
        ),
        None,
    )
    slip: SlipTorque | None = entry(Nested("a synchronous motor that starts", lambda: SlipTorque, "slip_torque"), None)
    short_circuit: ShortCircuit | None = entry(Nested("a short circuit", lambda: ShortCircuit, "short_circuit"), None)

    def contradictions(self) -> list[Fault]:
        kinds = ("orders", "electrical_orders", "line", "frequencies", "slip", "short_circuit")
        if not any(getattr(self, name) for name in kinds):
            return [
                Fault(
                    f"an electric machine needs {', '.join(kinds[:-1])} or {kinds[-1]}",
                    on_key=True,
                    kind="missing-entry",
                )
            ]
        return [*self._missing()]

    def _missing(self) -> Iterator[Fault]:
        if self.pole_pairs is None:
            for name in ("electrical_orders", "slip"):
                if getattr(self, name):
                    yield Fault(
                        f"{name} needs the pole pairs of the machine: pole_pairs: 2",
                        (name,),
                        on_key=True,
                        kind="missing-entry",
                    )
        if self.rated_torque is None:
            for path, table in self._tables():
                for key, pulsation in table.items():
                    if pulsation.share:
                        text = "a share needs the torque it is of: rated_torque: 12 kN*m"
                        yield Fault(text, (*path, f"{key:g}", "share"), kind="missing-entry")
            if self.torque:
                yield Fault(
                    "shares of the rated torque need rated_torque: 12 kN*m",
                    ("torque",),
                    on_key=True,
                    kind="missing-entry",
                )
        if self.stator == self.node:
            yield Fault("rotor and stator are on one node; give two different nodes", ("stator",), kind="same-node")

    def _tables(self) -> Iterator[tuple[EntryPath, Mapping[float, AirGapTorque]]]:
        """Path and content of every table of pulsations that the machine gives."""
        yield from (((name,), getattr(self, name)) for name in ("orders", "electrical_orders", "frequencies"))
        if self.line:
            yield ("line", "multiples"), self.line.multiples

    @property
    def shaft(self) -> str:
        return str(self.node)

    @property
    def node_entries(self) -> tuple[tuple[EntryPath, str], ...]:
        return ((("node",), self.node),)

    @property
    def reaction_entry(self) -> tuple[EntryPath, str] | None:
        return (("stator",), self.stator) if self.stator else None

    def remarks(self, speeds: FloatArray | None) -> list[Fault]:
        slip = self.slip.amplitude if self.slip else None
        return not_covered({("torque",): self.torque, ("slip", "amplitude"): slip}, speeds)

    def torques(self, speeds: FloatArray) -> OrderTorques:
        lines = [*self._pulsations(speeds), *self._of_slip(speeds), *self._of_short_circuit()]
        amplitudes = np.stack([np.broadcast_to(line.amplitude, speeds.shape) for line in lines], axis=1)
        return OrderTorques(
            np.array([line.order for line in lines]),
            self.nodes,
            amplitudes[:, :, None],
            fixed=np.array([line.fixed for line in lines]),
        )

    def _pulsations(self, speeds: FloatArray) -> Iterator[_Pulsation]:
        rated = (self.rated_torque or 0.0) * np.ones(len(speeds))
        # Ripple is a share of the torque that the machine has at that speed, cogging an amplitude of its own.
        torque = rated * over_speed(self.torque, speeds, "torque") if self.torque else rated
        per_revolution = {"orders": 1, "electrical_orders": self.pole_pairs}
        for (name, *_), table in self._tables():
            for key, pulsation in table.items():
                size = (pulsation.amplitude + pulsation.share * torque) * np.exp(1j * pulsation.phase)
                # One revolution has as many electrical periods as there are pole pairs.
                if name in per_revolution:
                    yield _Pulsation(key * not_none(per_revolution[name]), 0.0, size)
                else:
                    yield _Pulsation(0.0, key * (not_none(self.line).frequency if name == "line" else 1), size)

    def _of_slip(self, speeds: FloatArray) -> Iterator[_Pulsation]:
        if self.slip:
            # Twice the slip frequency: 2 f_line - 2 p Omega/2pi, an order of -2 p with a fixed part.
            size = over_speed(self.slip.amplitude, speeds, "slip torque") * np.exp(1j * self.slip.phase)
            yield _Pulsation(-2.0 * not_none(self.pole_pairs), 2 * self.slip.frequency, size)

    def _of_short_circuit(self) -> Iterator[_Pulsation]:
        if self.short_circuit:
            given = self.short_circuit
            # One phase for both lines, an angle at the line frequency: at twice the frequency it counts twice.
            for multiple, size in ((1, given.once), (2, given.twice)):
                if size:
                    yield _Pulsation(0.0, multiple * given.frequency, size * np.exp(1j * multiple * given.phase))
