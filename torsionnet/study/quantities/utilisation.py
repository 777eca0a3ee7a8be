"""Utilisation, a quantity of a study, the largest value over the value allowed of the limits of the model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault, unknown_name
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.quantities.quantity import QuantityForm, StudyQuantity, register_quantity
from torsionnet.study.quantities.speed_quantity import SpeedQuantity
from torsionnet.study.quantities.transfer_quantity import usage_faults
from torsionnet.study.quantities.variant_block import VariantBlock


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
            return [Fault("a criterion is one of a limit; say which limit", ("criterion",), on_key=True)]
        return []

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        known = model.definition.limits
        if self.limit and known and self.limit not in known:
            yield unknown_name("limit", self.limit, known, ("limit",), rest=f"there are {', '.join(known)}")
            return
        speeds = self.at(model)
        ends = speeds[:: max(1, len(speeds) - 1)]  # what is refused is refused there, where tables end
        yield from list(self.empty_range_faults(model)) or usage_faults(lambda: self._over(model, ends, refine=False))

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
        return self._over(model, self.at(model), refine=self.is_range(model))

    def _over(self, model: Drivetrain, speeds: FloatArray, *, refine: bool) -> float:
        check = model.check_limits(
            self.limit,
            speeds=speeds if len(speeds) else None,
            excitations=self.excitations or None,
            refine=refine,
        )
        verdicts = [check.of(self.limit, self.criterion)] if self.limit and self.criterion else check.verdicts
        found = [one.utilisation[one.worst] for one in verdicts if one.worst is not None]
        judged = all(one.worst is not None or one.verdict == "pass" for one in verdicts)
        return float(np.max(found)) if found and judged else float("nan")
