"""Scenario peak, a quantity of a study, the peak of a sensor over time in a scenario of the model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import OneOf, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import named_output
from torsionnet.motion.scenario_courses import scenario_of
from torsionnet.signals.recording import Recording
from torsionnet.study.quantities.quantity import QuantityForm, StudyQuantity, register_quantity
from torsionnet.study.quantities.transfer_quantity import usage_faults
from torsionnet.study.quantities.transient_peak import READ, READ_WORDS
from torsionnet.study.quantities.variant_block import VariantBlock


@register_quantity
@dataclass(frozen=True, kw_only=True)
class ScenarioPeak(StudyQuantity):
    """Peak in SI of a sensor in a scenario of the model, simulated for every variant.

    Peaks are those of the samples, see the entry ``rate`` of the scenario.

    Examples
    --------
    >>> import numpy as np
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("mass", node="a", inertia=2), tn.Spring("k", nodes=("a", "ground"), stiffness="k")]
    >>> step = {"type": "torques", "duration": "0.1 s", "rate": 1e4, "torque": {"a": "10 N*m"}}
    >>> rig = tn.Drivetrain("one mass", elements, parameters={"k": 8e4}, scenarios={"step": step})
    >>> peak = ScenarioPeak(scenario="step", output="torque(k)")
    >>> peak.evaluate(VariantBlock(rig, {"k": np.array([8e4, 1e5])}, {}, None)).round(2).tolist()
    [[20.0], [20.0]]
    """

    kind: ClassVar[str] = "scenario_peak"
    singly: ClassVar[bool] = True

    scenario: str = entry(Text("name of the scenario in the model"))
    output: str = entry(Text("sensor, node, torque(element), stress(shaft), ..."))
    value: str = entry(OneOf("what of the motion", tuple(READ)), "size")
    rate: float | None = entry(
        Value("samples a second, instead of what the scenario says", "frequency", exclusive=True), None
    )

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        found = [
            *usage_faults(lambda: named_output(model, self.output), "output"),
            *usage_faults(lambda: scenario_of(model, self.scenario), "scenario"),
        ]
        yield from found or usage_faults(lambda: self._motion(model))

    @property
    def words(self) -> str:
        return f"{READ_WORDS[self.value]} of {self.output} in the scenario {self.scenario}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        return QuantityForm(named_output(model, self.output).unit)

    def evaluate(self, block: VariantBlock) -> FloatArray:
        return block.one_by_one(lambda model: READ[self.value](self._motion(model).signals[-1].values))

    def _motion(self, model: Drivetrain) -> Recording:
        return model.simulate(self.output, sampling_rate=self.rate, scenario=self.scenario)
