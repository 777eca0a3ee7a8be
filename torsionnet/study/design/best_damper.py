"""Best damper, an answer of a study, with which the largest vibration in the worst configuration is smallest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.scalars import Band
from torsionnet.base.entries.spec import Text, entry
from torsionnet.base.errors import Fault, UsageError
from torsionnet.linear.dynamic_stiffness.transfer_request import named_output, resolve_inputs
from torsionnet.study.answers.answer import AskedStudy, StudyAnswer, VariantValues, register_answer
from torsionnet.study.answers.answer_inputs import PARAMETER
from torsionnet.study.design.conditions_damper import DamperOverConditions, damper_over_conditions
from torsionnet.study.design.design_entries import DESIGN, DesignBounds, chosen_parameters


@register_answer
@dataclass(frozen=True, kw_only=True)
class BestDamper(StudyAnswer):
    """Damping and stiffness of dampers with which the largest vibration in the worst configuration is smallest.

    With ``input`` of one transfer function over a band, without it of all orders of what excites the model over its
    speeds. Peaks are made equally high with exact derivatives, so the answer is the exact minimax.
    """

    kind: ClassVar[str] = "best_damper"
    of_variants: ClassVar[bool] = False
    naming: ClassVar[Mapping[str, str]] = {"design": PARAMETER}

    design: Mapping[str, DesignBounds | None] = entry(DESIGN, None)
    output: str = entry(Text("sensor, node, torque(element): what is to be small"))
    input: str | None = entry(Text("input or node that is driven; default: the model's excitations act"), None)
    band: tuple[float, float] | None = entry(Band("frequencies, with an input; default: those of the modes"), None)
    excitations: tuple[str, ...] = entry(Listed("only these act; default: all", Text("excitation")), None)

    def contradictions(self) -> list[Fault]:
        if self.input is None and self.band is not None:
            return [Fault("a band of frequencies needs an input; without it excitations act over speeds", ("band",))]
        if self.input is not None and self.excitations:
            return [Fault("with an input no excitations act", ("excitations",))]
        return []

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        if self.input is None and study.model.definition.speeds is None:
            yield Fault(
                "excitations act over speeds, and the model has none; give input: for one response", on_key=True
            )
        found, faults = chosen_parameters(study, self.design)
        yield from (fault.under("design") for fault in faults)
        if not found and not faults:
            yield Fault("nothing varies; say which values are chosen, as design: {c_dmp: [low, high]}", on_key=True)
        for one in found:
            if one.lower < 0:
                path = ("design", one.name) if self.design else ()
                yield Fault(f"a damper has no value below 0, got {one.lower:g}", path, on_key=not self.design)
        yield from self._channel_faults(study)

    def _channel_faults(self, study: AskedStudy) -> Iterator[Fault]:
        for name in ("output", "input"):
            try:
                if name == "output":
                    named_output(study.model, self.output)
                elif self.input is not None:
                    resolve_inputs(study.model, self.input, None)
            except UsageError as error:
                yield Fault(str(error), (name,))

    def conclude(self, study: AskedStudy, result: VariantValues) -> DamperOverConditions:
        del result
        parameters, _ = chosen_parameters(study, self.design)
        evaluator, asked = study.evaluator(), self.to_data()
        return damper_over_conditions(
            study.model,
            self.output,
            {one.name: (one.lower, one.upper) for one in parameters},
            study.configurations,
            input=self.input,
            band=self.band,
            excitations=self.excitations or None,
            kept=lambda what, search: evaluator.once(f"best damper {asked} {what}", {}, search),
        )
