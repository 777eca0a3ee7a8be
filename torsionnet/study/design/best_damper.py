"""Best damper, an answer of a study, with which the largest vibration in the worst configuration is smallest."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.scalars import Band
from torsionnet.base.entries.spec import Json, Text, entry
from torsionnet.base.errors import Fault, UsageError
from torsionnet.base.table import Column, Table
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.table_range import range_notes
from torsionnet.linear.dynamic_stiffness.transfer_request import named_output, resolve_inputs
from torsionnet.linear.frequency_response import Channel, FloatArray
from torsionnet.linear.modes.natural_modes import modes
from torsionnet.linear.responses.grid import vibration_range
from torsionnet.linear.sensitivity.unknowns import unknowns
from torsionnet.machinery.design.damper_design import Bounds, highest_peaks, levels_of, sought_box, sought_units
from torsionnet.machinery.design.damper_optimum import EQUAL_PEAK_DIFFERENCE, DesignParameter, LevelPeak
from torsionnet.machinery.design.level_minimax import Levels, OrderLevels, WorstLevels, smallest_maximum
from torsionnet.model.channels import Sensor
from torsionnet.study.answers.answer import (
    PARAMETER,
    AskedStudy,
    DrawnConclusion,
    StudyAnswer,
    VariantValues,
    register_answer,
)
from torsionnet.study.design.design_goals import DESIGN, DesignBounds, chosen_parameters

# Damper over several operating conditions, with which the largest level in the worst condition is smallest.


@dataclass(frozen=True, eq=False)
class DamperInCondition:
    """Largest levels in one operating condition with the damper as given, with the one for all, with its own best."""

    condition: str
    before: LevelPeak
    after: LevelPeak
    alone: LevelPeak
    alone_values: dict[str, float]


@dataclass(frozen=True, eq=False, repr=False)
class DamperOverConditions(DrawnConclusion):
    """Damper with which the largest level in the worst of several operating conditions is smallest.

    Attributes
    ----------
    channel : Channel
        Output whose level is minimised.
    of : str
        Name and unit of the axis of the levels.
    parameters : tuple of DesignParameter
    conditions : tuple of DamperInCondition
    title : str
    notes : tuple of str
        On tables over frequency that end before the levels do.
    """

    drawing: ClassVar[str] = "torsionnet.plot.study.designs:damper_over_conditions"

    channel: Channel
    of: tuple[str, str]
    parameters: tuple[DesignParameter, ...]
    conditions: tuple[DamperInCondition, ...]
    title: str = ""
    notes: tuple[str, ...] = ()

    @property
    def values(self) -> dict[str, float]:
        """Value in SI of each damper parameter, by its name."""
        return {parameter.name: parameter.value for parameter in self.parameters}

    @property
    def worst_before(self) -> DamperInCondition:
        return max(self.conditions, key=lambda condition: condition.before.level)

    @property
    def worst(self) -> DamperInCondition:
        """Operating condition with the largest level when this damper is fitted."""
        return max(self.conditions, key=lambda condition: condition.after.level)

    @property
    def holding(self) -> tuple[str, ...]:
        """Names of the operating conditions whose level is within a thousandth of the largest."""
        top = self.worst.after.level * (1 - EQUAL_PEAK_DIFFERENCE)
        return tuple(condition.condition for condition in self.conditions if condition.after.level >= top)

    @property
    def sentences(self) -> tuple[str, ...]:
        """Result of the damper search in sentences, on levels before and after, bounds reached, cost of one for all."""
        before, after = self.worst_before, self.worst
        bounds = [f"{sought.name} is at its {sought.bound} bound" for sought in self.parameters if sought.bound]
        if not after.condition:  # a model without configurations
            levels = f"{before.before.level:.5g} to {after.after.level:.5g} {self.channel.unit}"
            return f"the largest {self.channel.name} goes from {levels}", *bounds, *self.notes
        said = [
            f"the largest {self.channel.name} of all conditions goes from {before.before.level:.5g} "
            f"({before.condition}) to {after.after.level:.5g} {self.channel.unit} ({' and '.join(self.holding)})"
        ]
        said += bounds
        dear = max(self.conditions, key=lambda condition: condition.after.level / condition.alone.level)
        more = 100 * (dear.after.level / dear.alone.level - 1)
        said.append(f"one damper for all costs at most {more:.3g} % against one for {dear.condition} alone")
        return (*said, *self.notes)

    def table(self) -> Table:
        """Table of the largest levels without and with the best damper, a row for each operating condition."""
        columns = (
            Column("condition"),
            Column("as given", self.channel.unit),
            Column("optimum for all", self.channel.unit),
            Column(f"at {self.of[0]}", self.of[1]),
            Column("optimum alone", self.channel.unit),
            *(Column(f"{parameter.name} alone", parameter.unit) for parameter in self.parameters),
        )
        rows = tuple(
            (
                condition.condition,
                condition.before.level,
                condition.after.level,
                condition.after.point,
                condition.alone.level,
                *condition.alone_values.values(),
            )
            for condition in self.conditions
        )
        best = [f"{p.name} = {p.value:.6g} {p.unit} (given: {p.start:.6g})" for p in self.parameters]
        return Table.of(self.title, "best damper for all conditions", columns, rows, (*best, *self.sentences))

    def to_data(self) -> dict[str, Json]:
        """Best damper and its levels in SI as JSON data in full precision."""
        return {
            "values": self.values,
            "holding": list(self.holding),
            "conditions": [
                {
                    "condition": condition.condition,
                    "before": condition.before.level,
                    "after": condition.after.level,
                    "at": condition.after.point,
                    "alone": condition.alone.level,
                    "alone_values": condition.alone_values,
                }
                for condition in self.conditions
            ],
            "sentences": list(self.sentences),
        }


def damper_over_conditions(
    drivetrain: Drivetrain,
    output: str | Sensor,
    parameters: str | Sequence[str] | Bounds,
    conditions: Sequence[str] | None = None,
    *,
    input: str | Sensor | None = None,
    band: tuple[float, float] | None = None,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitation: str | Iterable[str] | None = None,
    kept: Callable[[str, Callable[[], FloatArray]], FloatArray] = lambda _what, search: search(),
) -> DamperOverConditions:
    """Search the damper with which the largest level in the worst of several operating conditions is smallest.

    Parameters
    ----------
    conditions : sequence of str, optional
        Configurations of the drivetrain; by default all.
    kept : callable, optional
        Returns the result of a search for a condition, or "" for all of them, from an earlier run if there is one.
    drivetrain, output, parameters, input, band, speeds, speed_of, excitations
        As for :meth:`torsionnet.Drivetrain.damper_design`.

    Raises
    ------
    UsageError
        No conditions, or what :meth:`torsionnet.Drivetrain.damper_design` refuses.
    """
    labels = tuple(drivetrain.configurations if conditions is None else conditions)
    if not labels:
        raise UsageError(
            f"{drivetrain.name} has no configurations; for one condition ask for its damper design",
            kind="unknown-configuration",
        )
    names = [parameters] if isinstance(parameters, str) else list(parameters)
    if not names:
        raise UsageError("say which parameter is sought, such as the damping of a film", kind="missing-entry")
    rigs = [drivetrain.configured(label) if label else drivetrain for label in labels]
    sought = [unknowns(rig, names) for rig in rigs]
    units = sought_units(sought[0])
    box = sought_box(sought[0], parameters if isinstance(parameters, Mapping) else {}, units)
    start = np.array(sought[0].start)
    chosen = None if excitation is None else [*excitation]
    # One band for all conditions: from the lowest to the highest frequency of the modes of any.
    if input is not None and band is None:
        ranges = [vibration_range(modes(rig)) for rig in rigs]
        band = min(low for low, _ in ranges), max(high for _, high in ranges)
    parts = tuple(
        levels_of(rig, varied, output, input, band, speeds, speed_of, chosen)
        for rig, varied in zip(rigs, sought, strict=True)
    )
    # One damper for all: the largest level over all conditions is made smallest.
    highest = (
        max(float(part.run.speeds[-1]) for part in parts if isinstance(part, OrderLevels)) if band is None else band[1]
    )
    best = kept("", lambda: smallest_maximum(WorstLevels(parts, highest), box, start))
    # The best damper of each condition alone shows what the one for all costs there.
    alone = [
        kept(f"{label} alone", partial(smallest_maximum, levels, box, start))
        for label, levels in zip(labels, parts, strict=True)
    ]
    read = (range_notes(rig.assembly, levels.frequencies) for rig, levels in zip(rigs, parts, strict=True))
    return DamperOverConditions(
        parts[0].channel,
        parts[0].of,
        tuple(
            DesignParameter(name, unit, float(first), float(low), float(high), float(value))
            for name, unit, first, low, high, value in zip(names, units, start, box.lower, box.upper, best, strict=True)
        ),
        tuple(_in_condition(*case, names, start, best) for case in zip(labels, parts, alone, strict=True)),
        drivetrain.name,
        tuple(dict.fromkeys(note for notes in read for note in notes)),
    )


def _in_condition(
    label: str, levels: Levels, alone: FloatArray, names: Sequence[str], start: FloatArray, best: FloatArray
) -> DamperInCondition:
    before, after, own = (highest_peaks(levels, values)[0] for values in (start, best, alone))
    return DamperInCondition(label, before, after, own, dict(zip(names, map(float, alone), strict=True)))


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
            return [
                Fault(
                    "a band of frequencies needs an input; without it excitations act over speeds",
                    ("band",),
                    kind="missing-entry",
                )
            ]
        if self.input is not None and self.excitations:
            return [Fault("with an input no excitations act", ("excitations",), kind="contradicting-entries")]
        return []

    def study_faults(self, study: AskedStudy) -> Iterator[Fault]:
        if self.input is None and study.model.definition.speeds is None:
            yield Fault(
                "excitations act over speeds, and the model has none; give input: for one response",
                on_key=True,
                kind="missing-entry",
            )
        parameters, faults = chosen_parameters(study, self.design)
        yield from (fault.under("design") for fault in faults)
        if not parameters and not faults:
            yield Fault(
                "nothing varies; say which values are chosen, as design: {c_dmp: [low, high]}",
                on_key=True,
                kind="nothing-varies",
            )
        for parameter in parameters:
            if parameter.lower < 0:
                path = ("design", parameter.name) if self.design else ()
                yield Fault(
                    f"a damper has no value below 0, got {parameter.lower:g}",
                    path,
                    on_key=not self.design,
                    kind="out-of-range",
                )
        yield from self._channel_faults(study)

    def _channel_faults(self, study: AskedStudy) -> Iterator[Fault]:
        for name in ("output", "input"):
            try:
                if name == "output":
                    named_output(study.model, self.output)
                elif self.input is not None:
                    resolve_inputs(study.model, self.input, None)
            except UsageError as error:
                yield replace(error.fault, path=(name,))

    def conclude(self, study: AskedStudy, result: VariantValues) -> DamperOverConditions:
        del result
        parameters, _ = chosen_parameters(study, self.design)
        evaluator, asked = study.evaluator(), self.to_data()
        return damper_over_conditions(
            study.model,
            self.output,
            {parameter.name: (parameter.lower, parameter.upper) for parameter in parameters},
            study.configurations,
            input=self.input,
            band=self.band,
            excitation=self.excitations or None,
            kept=lambda what, search: evaluator.once(f"best damper {asked} {what}", {}, search),
        )
