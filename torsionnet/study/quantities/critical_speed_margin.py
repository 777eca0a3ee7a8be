"""Critical speed margin, a quantity of a study, the distance of natural frequencies from excitation frequencies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault, SolveError, UsageError, unknown_name
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.machinery.criticals.critical_speed_search import excited_frequencies, excited_lines, order_margins
from torsionnet.machinery.excitations.order_excitation import ORDER
from torsionnet.machinery.excitations.speed_range import SpeedBand
from torsionnet.machinery.orders.order_response import NOT_MET
from torsionnet.machinery.orders.order_solution import with_motions_held
from torsionnet.machinery.verdicts.limit_verdict import LimitVerdict
from torsionnet.study.quantities.quantity import QuantityForm, StudyQuantity, VariantBlock, register_quantity
from torsionnet.study.quantities.transfer_quantity import SpeedQuantity, speed_words, usage_faults


@register_quantity
@dataclass(frozen=True, kw_only=True)
class CriticalSpeedMargin(StudyQuantity):
    """Smallest distance of a natural frequency from the excitation frequencies of orders, relative to the nearer one.

    Natural frequencies with damping, ``|lambda|/2pi``, and without count, as in ``critical_speeds``;
    0 where one of them lies within the range that an order passes through.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness="k")]
    >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": [50, 60]}, parameters={"k": 15000},
    ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}})
    >>> block = VariantBlock(fan, {"k": np.array([15000.0, 7500.0])}, {}, None)
    >>> CriticalSpeedMargin().evaluate(block).round(6).tolist()  # natural frequencies of 150 and 106 rad/s
    [[0.25], [0.0]]
    """

    kind: ClassVar[str] = "critical_speed_margin"

    orders: tuple[float, ...] = entry(Listed("orders that count; default: all that act", ORDER), None)
    excitations: tuple[str, ...] = entry(Listed("excitations that count; default: all", Text("an excitation")), None)
    speeds: tuple[float, float] | None = entry(SpeedBand("range of speeds; default: that of the model"), None)

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        faults = list(usage_faults(lambda: self._asked(model)))
        yield from faults or usage_faults(lambda: self._ranges(model), *(("orders",) if self.orders else ()))

    @property
    def words(self) -> str:
        orders = f"orders {', '.join(f'{order:g}' for order in self.orders)}" if self.orders else "all orders"
        acting = f" of {', '.join(self.excitations)}" if self.excitations else ""
        over = "" if self.speeds is None else f" {speed_words(self.speeds)}"
        return f"relative distance of the nearest natural frequency from the frequencies of {orders}{acting}{over}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        return QuantityForm()

    def evaluate(self, block: VariantBlock) -> FloatArray:
        shared = self._shared(block)
        if shared or block.is_over_frequency:
            modes = block.read_modes
        if not shared:
            return block.one_by_one(self._of)
        ranges = self._ranges(block.model)
        # |s|/2 pi of what vibrates, beside the frequencies without damping.
        vibrations = np.where(modes.eigenvalues.imag > 0, np.abs(modes.eigenvalues) / (2 * np.pi), np.nan)
        resting = modes.undamped_natural_frequencies
        natural = np.hstack([vibrations, np.where(resting > 0, resting, np.nan)])
        margins = np.array([_distances(natural, low, high) for low, high in ranges])
        # What a variant lacks is NaN, which fmin passes over.
        smallest = np.fmin.reduce(np.fmin.reduce(margins, axis=2), axis=0)
        return np.asarray(smallest[:, None])

    def _of(self, model: Drivetrain) -> float:
        margins = [margin.margin for margin in order_margins(model, **self._question) if self._counts(margin.order)]
        return min((margin for margin in margins if margin >= 0), default=float("nan"))

    @property
    def _question(self) -> dict[str, Any]:
        return {"speeds": self.speeds, "excitations": self.excitations or None}

    def _asked(self, model: Drivetrain) -> tuple[dict[str, Any], tuple[float, float]]:
        lines, _, speed_range = excited_lines(model, self.speeds, None, self.excitations or None)
        return dict(lines), speed_range

    def _ranges(self, model: Drivetrain) -> Sequence[tuple[float, float]]:
        """Lowest and highest excitation frequency in Hz of every order."""
        lines, speed_range = self._asked(model)
        every = [line for group in lines.values() for line in group]
        ranges = [excited_frequencies(line, speed_range) for line in every if self._counts(line.order)]
        if not ranges:
            orders = ", ".join(f"{order:g}" for order in self.orders)
            raise UsageError(f"no order {orders} acts; there are {', '.join(map(str, every))}", kind="unknown-order")
        return ranges

    def _counts(self, order: float) -> bool:
        return not self.orders or any(abs(order - asked) <= 1e-9 * asked for asked in self.orders)

    def _shared(self, block: VariantBlock) -> bool:
        """Whether the same modes hold at all speeds and under all excitations."""
        if block.batch is None or block.model.definition.follows_speed:
            return False
        lines, _ = self._asked(block.model)
        acting = {name: block.model.definition.excitations[name] for name in lines}
        return with_motions_held(block.model, acting) is block.model


def _distances(natural: FloatArray, low: float, high: float) -> FloatArray:
    """Relative distances of natural frequencies from a range of excitation frequencies, all in Hz; 0 inside it."""
    below = 1 - natural / low if low else np.zeros_like(natural)
    return np.where(natural < low, below, np.where(natural > high, natural / high - 1, natural * 0.0))


# Utilisation, a quantity of a study, the largest value over the value allowed of the limits of the model.


@register_quantity
@dataclass(frozen=True, kw_only=True)
class Utilisation(SpeedQuantity):
    """Largest value over value allowed of a limit of the model, at any of its speeds, of several criteria the largest.

    Above 1 the limit does not hold at some speed. NaN where a limit cannot be judged.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia="J"),
    ...     tn.Shaft("shaft", nodes=("a", "b"), outer_diameter="20 mm", length=1)]
    >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["600 rpm"]}, parameters={"J": 1},
    ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}},
    ...     limits={"shaft": {"rule": "curve", "output": "stress(shaft)", "value": "40 MPa", "source": "maker"}})
    >>> block = VariantBlock(fan, {"J": np.array([1.0, 2.0])}, {}, None)
    >>> used = Utilisation(limit="shaft").evaluate(block)[:, 0]
    >>> bool(used[0] == fan.check_limits().of("shaft").utilisation[0])
    True
    """

    kind: ClassVar[str] = "utilisation"
    singly: ClassVar[bool] = True

    limit: str | None = entry(Text("a limit of the model; default: all of them"), None)
    criterion: str | None = entry(Text("symbol of one of its criteria; default: all of them"), None)

    def contradictions(self) -> list[Fault]:
        if self.criterion and not self.limit:
            return [
                Fault(
                    "a criterion is one of a limit; say which limit", ("criterion",), on_key=True, kind="missing-entry"
                )
            ]
        return []

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        known = model.definition.limits
        if self.limit and known and self.limit not in known:
            yield unknown_name("limit", self.limit, known, ("limit",), rest=f"there are {', '.join(known)}")
            return
        speeds = self.at(model)
        ends = speeds[:: max(1, len(speeds) - 1)]  # what is refused is refused there, where tables end
        yield from list(self.empty_range_faults(model)) or usage_faults(
            lambda: self._verdicts(model, ends, refine=False)
        )

    @property
    def words(self) -> str:
        limit = f"the limit {self.limit}" if self.limit else "all limits"
        criterion = f", criterion {self.criterion}," if self.criterion else ""
        return f"largest value over value allowed of {limit}{criterion} {self.range_words}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        return QuantityForm()

    def evaluate(self, block: VariantBlock) -> FloatArray:
        return block.one_by_one(self._of)

    def _of(self, model: Drivetrain) -> float:
        verdicts = self._verdicts(model, self.at(model), refine=self.is_range(model))
        if any(NOT_MET in verdict.remarks for verdict in verdicts):
            raise SolveError(NOT_MET, kind="no-period")
        utilisations = [verdict.utilisation[verdict.worst] for verdict in verdicts if verdict.worst is not None]
        # A check that could not be made has no worst place and does not pass: its utilisation is not known.
        judged = all(verdict.worst is not None or verdict.verdict == "pass" for verdict in verdicts)
        return float(np.max(utilisations)) if utilisations and judged else float("nan")

    def _verdicts(self, model: Drivetrain, speeds: FloatArray, *, refine: bool) -> Sequence[LimitVerdict]:
        check = model.check_limits(
            self.limit,
            speeds=speeds if len(speeds) else None,
            excitation=self.excitations or None,
            refine=refine,
        )
        return [check.of(self.limit, self.criterion)] if self.limit and self.criterion else check.verdicts
