"""Goals of a design, targets, objectives and limits of quantities, and the optimum found for them with its checks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from torsionnet.base.entries.composite import Listed, Named, Nested, PairOf
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Json, Schema, Text, entry
from torsionnet.base.errors import Fault, UsageError, did_you_mean
from torsionnet.base.expressions import Number
from torsionnet.base.table import Column, Table
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.machinery.design.damper_optimum import DesignParameter
from torsionnet.model.checks.values import parameter_units
from torsionnet.model.model import Model
from torsionnet.model.parameters import Parameter
from torsionnet.study.answers.answer import AskedStudy, DrawnConclusion
from torsionnet.study.quantities.quantity import QuantityLimit, QuantityValue
from torsionnet.study.space.variations.variation import NominalReader, ParameterValue, nominals

# Goals of a design, which are targets, objectives and limits of quantities, and its entries of a study file.

Found = Mapping[str, FloatArray]
"""Mapping of each quantity to its values (n, n_points) in SI for n designs."""


def with_unit(value: float, unit: str) -> str:
    """Text of a number with its unit, to six digits.

    >>> with_unit(0.00855201, "rad"), with_unit(0.25, "")
    ('0.00855201 rad', '0.25')
    """
    return f"{value:.6g} {unit}".rstrip()


@dataclass(frozen=True)
class DesignTarget:
    """Target value in SI of a quantity, with ``weight``, for deviations relative to the value, unless it is 0."""

    quantity: str
    value: float
    weight: float = 1.0

    @property
    def scale(self) -> float:
        return self.weight / (abs(self.value) or 1.0)


@dataclass(frozen=True)
class DesignObjective:
    """Objective of a design, the worst of these quantities at the worst of their points, minimised or maximised."""

    quantities: tuple[str, ...]
    sense: str = "minimise"

    @property
    def sign(self) -> float:
        return -1.0 if self.sense == "maximise" else 1.0

    @property
    def name(self) -> str:
        return self.quantities[0] if len(self.quantities) == 1 else f"worst of {', '.join(self.quantities)}"

    def columns(self, values: Found) -> FloatArray:
        """Values (n, n_columns) of n designs that are to be small, the quantities' times the sign of the objective."""
        return self.sign * np.concatenate([values[name] for name in self.quantities], axis=1)

    def shown(self, size: float) -> float:
        """Value in SI of the objective's quantity from a value of :meth:`columns`, which has the objective's sign."""
        return self.sign * size


@dataclass(frozen=True, eq=False)
class DesignGoals:
    """Targets or objectives of a design, and the limits of its quantities.

    Attributes
    ----------
    targets : tuple of DesignTarget
    objectives : tuple of DesignObjective
    limits : mapping
        Quantity -> limit, SI.
    units : mapping
        Quantity -> unit in SI, for words and tables; others are shown without a unit.

    Examples
    --------
    >>> goals = DesignGoals(targets=(DesignTarget("f", 8.0),), limits={"x": QuantityLimit(below=2.0)})
    >>> values = {"f": np.array([[8.0], [10.0]]), "x": np.array([[1.0], [3.0]])}
    >>> goals.deviations(values).ravel().tolist(), goals.excess(values).ravel().tolist()
    ([0.0, 0.25], [-0.5, 0.5])
    """

    targets: tuple[DesignTarget, ...] = ()
    objectives: tuple[DesignObjective, ...] = ()
    limits: Mapping[str, QuantityLimit] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.targets and not self.objectives and not self.limits:
            raise UsageError("say what is sought: targets, or what to minimise or maximise", kind="missing-entry")
        if self.targets and self.objectives:
            raise UsageError(
                "either targets or something to minimise or maximise; make the targets limits, or these",
                kind="contradicting-entries",
            )
        for target in self.targets:
            if not (np.isfinite(target.value) and target.weight > 0):
                raise UsageError(
                    f"the target of {target.quantity} is a number with a weight above 0", kind="out-of-range"
                )

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of the quantities of all targets, objectives and limits, each once."""
        named = [target.quantity for target in self.targets]
        named += [name for objective in self.objectives for name in objective.quantities]
        return tuple(dict.fromkeys([*named, *self.limits]))

    def unit_of(self, objective: DesignObjective) -> str:
        """SI unit of an objective; empty where its quantities have different ones."""
        units = {self.units.get(name, "") for name in objective.quantities}
        return units.pop() if len(units) == 1 else ""

    def require_merit(self) -> None:
        """Refuse goals that are limits alone, of which no design is the best."""
        if not self.targets and not self.objectives:
            raise UsageError(
                "limits alone choose no design; say what to minimise or maximise, or targets", kind="missing-entry"
            )

    def check(self, known: Mapping[str, object]) -> None:
        """Refuse goals of a design with quantities that are not among those known."""
        for name in self.quantities:
            if name not in known:
                there = ", ".join(known)
                raise UsageError(
                    f'no quantity is named "{name}"{did_you_mean(name, known)}; there are {there}', kind="unknown-name"
                )

    def deviations(self, values: Found) -> FloatArray:
        """Relative, weighted deviations from targets (n, n_targets) of n designs, those of a curve at every point."""
        parts = [target.scale * (values[target.quantity] - target.value) for target in self.targets]
        return np.concatenate(parts, axis=1)

    def excess(self, values: Found) -> FloatArray:
        """Excess (n, n_points of limited quantities) over limits, relative to them; below 0 where they are kept."""
        parts = [sign * (values[name] - bound) / (abs(bound) or 1.0) for name, sign, bound in self.bounds()]
        count = len(next(iter(values.values())))
        return np.concatenate(parts, axis=1) if parts else np.zeros((count, 0))

    def excess_slopes(self, moved: Found) -> FloatArray:
        """Derivatives (n_excess, n_p) of :meth:`excess` from those (n_points, n_p) of the quantities."""
        parts = [sign * moved[name] / (abs(bound) or 1.0) for name, sign, bound in self.bounds()]
        width = next(iter(moved.values())).shape[1]
        return np.concatenate(parts) if parts else np.zeros((0, width))

    def bounds(self) -> Iterator[tuple[str, float, float]]:
        """Yield the quantity, sign (1 of an upper, -1 of a lower limit) and value in SI of every limit."""
        for name, limit in self.limits.items():
            if limit.below is not None:
                yield name, 1.0, limit.below
            if limit.above is not None:
                yield name, -1.0, limit.above

    def merit(self, values: Found) -> FloatArray:
        """Merit (n,) of n designs, to be minimised, the sum of squared deviations, or the worst of the objective."""
        if self.targets:
            size = np.sum(self.deviations(values) ** 2, axis=1)
        else:
            size = self.objectives[0].columns(values).max(axis=1)
        # A design without one of the quantities is worse than any other.
        return np.where(np.isnan(size), np.inf, size)

    def violation(self, values: Found) -> FloatArray:
        """Sum (n,) of the relative excess over limits of n designs.

        Infinite where a quantity could not be calculated.
        """
        over = np.maximum(self.excess(values), 0.0).sum(axis=1)
        return np.where(np.isnan(over), np.inf, over)


# Entries of a study file for design parameters, bounds and targets.

DEFAULT_BOUND_FACTOR = 10.0
"""Factor between a parameter and either default bound, a decade, for parameters without bounds of their own."""


@dataclass(frozen=True, kw_only=True)
class DesignBounds(Declared):
    """Bounds between which the value of a designed parameter is chosen."""

    kind: ClassVar[str] = "design bounds"
    article: ClassVar[str] = "the bounds of a designed parameter"
    form: ClassVar[str] = "[lowest, highest]"

    bounds: tuple[Number, Number] | None = entry(
        PairOf(
            "lowest and highest value; default: the bounds in the model, else a tenth and ten times",
            ParameterValue("bound"),
        ),
        None,
    )


class DesignedNames(Named[DesignBounds | None]):
    """Entry for design parameters, a table of names and bounds, or a list of names."""

    def read(self, raw: object) -> tuple[Mapping[str, DesignBounds | None], list[Fault]]:
        return super().read(dict.fromkeys(map(str, raw)) if isinstance(raw, list) and raw else raw)

    def schema(self) -> Schema:
        names: Schema = {"type": "array", "items": {"type": "string"}, "minItems": 1}
        return {"description": self.description, "anyOf": [super().schema(), names]}


class OneOrSeveral(Listed[str]):
    """Entry of a study file for one name or a list of names."""

    def read(self, raw: object) -> tuple[tuple[Any, ...], list[Fault]]:
        return super().read([raw] if isinstance(raw, str) else raw)

    def schema(self) -> Schema:
        return {"description": self.description, "anyOf": [self.of.schema(), super().schema()]}


@dataclass(frozen=True, kw_only=True)
class TargetEntry(Declared):
    """Target value that a quantity should have in a design, with its weight."""

    kind: ClassVar[str] = "target"
    article: ClassVar[str] = "a target"
    form: ClassVar[str] = "a value, or {value: ..., weight: ...}"

    value: float = entry(QuantityValue("what the quantity should be"))
    weight: float = entry(Value("how much its relative deviation counts", "1", exclusive=True), 1.0)


DESIGN = DesignedNames(
    "the parameters that are chosen, with their bounds; default, but for a robust optimum: all that vary, within what "
    "the study has them vary",
    Nested("bounds of a parameter", lambda: DesignBounds, "design_bounds", shorthand="bounds", optional=True),
    form="parameters and their bounds, k_1: [10 kN*m/rad, 20 kN*m/rad]",
    fewest=1,
)
TARGETS = Named(
    "values that quantities should have, by quantity",
    Nested("a target", lambda: TargetEntry, "design_target", shorthand="value"),
    form="targets, f_1: 8 Hz",
)
NAMES = Text("a quantity of the study")


def design_parameters(
    model: Model, design: Mapping[str, DesignBounds | None]
) -> tuple[list[DesignParameter], list[Fault]]:
    """Design parameters of a model with bounds in SI, and all faults of their entries."""
    parameters, faults = [], []
    known = [name for name in design if name in model.parameters]
    for name, nominal in nominals(model, known).items():
        reader = NominalReader(nominal)
        ends = _ends(design[name], reader, model.parameter_definitions[name])
        # A parameter without a value of its own starts in the middle of its bounds.
        start = reader.value(None, "start") if nominal.value is not None else sum(ends) / 2
        faults += [fault.under(name) for fault in reader.faults]
        if not reader.faults:
            parameters.append(DesignParameter(name, parameter_units(model.definition)[name], start, *ends, start))
    return parameters, faults


def chosen_parameters(
    study: AskedStudy, design: Mapping[str, DesignBounds | None] | None
) -> tuple[list[DesignParameter], list[Fault]]:
    """Design parameters of a study with bounds in SI, by default all that vary, and all faults of their entries."""
    if design:
        return design_parameters(study.model, design)
    units, nominal = parameter_units(study.model.definition), study.space.nominal
    box = study.space.box().items()
    return [DesignParameter(name, units[name], nominal[name], *ends, nominal[name]) for name, ends in box], []


def _ends(bounds: DesignBounds | None, reader: NominalReader, parameter: Parameter) -> tuple[float, float]:
    if bounds is None or bounds.bounds is None:
        # Without bounds in the study those of the model hold, else a factor either way from the value.
        nominal = reader.nominal.value
        if parameter.bounds is not None:
            low, high = parameter.bounds
        elif nominal is None or not nominal > 0:
            return reader.fault(f"{reader.nominal.name} is not above 0: give its bounds", kind="missing-entry"), float(
                "nan"
            )
        else:
            low, high = nominal / DEFAULT_BOUND_FACTOR, nominal * DEFAULT_BOUND_FACTOR
    else:
        low, high = (reader.value(bound, "bounds", place) for place, bound in enumerate(bounds.bounds))
    if not low < high and not reader.faults:
        reader.fault(f"bounds are a lower and a higher value, got {low:g} and {high:g}", kind="unordered-rows")
    return low, high


# Optimum of a design, its parameter values, its quantities, and checks of it.

TARGET_MET = 1e-8
"""Largest relative deviation from a target that counts as met, as less would call rounding a miss."""
SAME_QUANTITY = 1e-8
"""Largest relative difference of a quantity calculated in a batch and by a single model that counts as rounding."""


@dataclass(frozen=True, eq=False, repr=False)
class DesignOptimum(DrawnConclusion):
    """Best design found by an optimisation, with its quantities before and after.

    Attributes
    ----------
    parameters : tuple of DesignParameter
        Parameters with given value, bounds and best value, SI.
    goals : DesignGoals
    before, after : mapping
        Quantity -> values (n_points,) as given and with the values found.
    single : mapping
        Quantity -> values recomputed by a single model with the values found; empty where none was given.
    violation : float
        Sum of relative excess over limits; 0 where all are kept.
    alternatives : tuple of mapping
        Other designs that are as good.
    free_directions : int
        Number of independent changes of parameters that leave every target met.
    history : (n, 2) array
        Designs calculated so far, and the best merit by then.
    converged : bool
        Whether several searches found this design, or no design beside it is better.
    title : str
    """

    drawing: ClassVar[str] = "torsionnet.plot.study.designs:design_optimum"

    parameters: tuple[DesignParameter, ...]
    goals: DesignGoals
    before: Mapping[str, FloatArray]
    after: Mapping[str, FloatArray]
    single: Mapping[str, FloatArray]
    violation: float
    alternatives: tuple[Mapping[str, float], ...]
    free_directions: int
    history: FloatArray
    converged: bool
    title: str = ""

    @property
    def values(self) -> dict[str, float]:
        """Value in SI of each design parameter, by its name, for :meth:`torsionnet.Drivetrain.configured`."""
        return {parameter.name: parameter.value for parameter in self.parameters}

    @property
    def active_bounds(self) -> dict[str, str]:
        """Parameters that are at a bound, by name, with ``lower`` or ``upper`` as value."""
        return {parameter.name: parameter.bound for parameter in self.parameters if parameter.bound}

    @property
    def merit(self) -> float:
        """Sum of squared relative deviations from targets, or the value in SI of the objective's quantity."""
        size = float(self.goals.merit(_rows(self.after))[0])
        return size if self.goals.targets else self.goals.objectives[0].shown(size)

    @property
    def disagreement(self) -> float:
        """Largest relative difference between quantities calculated in a batch and by a single model."""
        apart = [
            float(np.max(np.abs(self.after[name] - alone) / max(float(np.abs(alone).max()), 1e-300)))
            for name, alone in self.single.items()
        ]
        return max(apart, default=0.0)

    @property
    def sentences(self) -> tuple[str, ...]:
        """Result of the optimisation in sentences, on targets, objective, limits, bounds, uniqueness, verification."""
        return tuple(sentence for _, sentence in self.conclusions)

    @property
    def conclusions(self) -> tuple[tuple[str, str], ...]:
        """Sentences on the result of the optimisation, each with what it is about, as ``limits``."""
        said = {
            "targets": self._targets_said(), "objective": self._objective_said(), "limits": self._limits_said(),
            "bounds": self._bounds_said(), "uniqueness": self._uniqueness_said(),
            "verification": self._verification_said(),
        }  # fmt: skip
        return tuple((about, sentence) for about, sentences in said.items() for sentence in sentences)

    def _targets_said(self) -> list[str]:
        said = []
        for target in self.goals.targets:
            value, unit = self.after[target.quantity], self.goals.units.get(target.quantity, "")
            wanted = with_unit(target.value, unit)
            worst = float(value[np.argmax(np.abs(value - target.value))])
            if abs(worst - target.value) <= TARGET_MET * (abs(target.value) or 1.0):
                said.append(f"{target.quantity} has its target, {wanted}")
            else:
                text = f"its target {wanted} is not reached within the bounds"
                said.append(f"{target.quantity} comes to {with_unit(worst, unit)}: {text}")
        points = sum(self.after[target.quantity].size for target in self.goals.targets)
        if points > len(self.parameters):
            said.append(f"{points} targets and {len(self.parameters)} parameters: least squares of relative deviations")
        return said

    def _objective_said(self) -> list[str]:
        if not self.goals.objectives:
            return []
        objective = self.goals.objectives[0]
        first = objective.shown(float(objective.columns(_rows(self.before)).max()))
        reached = with_unit(self.merit, self.goals.unit_of(objective))
        return [f"{objective.name} goes from {first:.6g} to {reached} ({objective.sense}d)"]

    def _limits_said(self) -> list[str]:
        if not self.goals.limits:
            return []
        if self.violation > 0:
            over = [name for name, limit in self.goals.limits.items() if limit.exceeded(self.after[name]).any()]
            return [f"no design within the bounds was found that keeps all limits; this one exceeds {', '.join(over)}"]
        hold = [
            name
            for name, limit in self.goals.limits.items()
            for bound in (limit.below, limit.above)
            if bound is not None and np.abs(self.after[name] - bound).min() <= 1e-6 * (abs(bound) or 1.0)
        ]
        return [f"limits are kept; the optimum lies at the limit of {', '.join(hold)}" if hold else "limits are kept"]

    def _bounds_said(self) -> list[str]:
        return [f"{name} is at its {bound} bound" for name, bound in self.active_bounds.items()]

    def _uniqueness_said(self) -> list[str]:
        said = []
        if self.free_directions:
            many = "one combination" if self.free_directions == 1 else f"{self.free_directions} combinations"
            said.append(f"not unique: {many} of the parameters may change without a change of the targeted quantities")
        elif self.alternatives:
            others = "; ".join(
                ", ".join(f"{name} = {value:.6g}" for name, value in design.items()) for design in self.alternatives
            )
            said.append(f"not unique: equally good are {others}; this one is nearest to the values as given")
        if not self.converged:
            said.append("the search did not settle: designs beside this one go on being better")
        return said

    def _verification_said(self) -> list[str]:
        if not self.single:
            return []
        apart = self.disagreement
        if apart <= SAME_QUANTITY:
            return ["recomputed by a model with these values: the same"]
        return [f"recomputed by a model with these values: different by {apart:.2g} of themselves"]

    def table(self) -> Table:
        """Table of the design parameters, then of the quantities, as given and at the optimum."""
        rows: list[tuple[object, ...]] = [
            (p.name, p.unit, p.start, p.value, p.lower, p.upper, None) for p in self.parameters
        ]
        wanted = {target.quantity: target.value for target in self.goals.targets}
        for name, after in self.after.items():
            limit = self.goals.limits.get(name)
            low, high = (None, None) if limit is None else (limit.above, limit.below)
            top = int(np.argmax(after))
            unit = self.goals.units.get(name, "")
            rows.append((name, unit, float(self.before[name].max()), float(after[top]), low, high, wanted.get(name)))
        names = ("", "unit", "as given", "optimum", "lower", "upper", "target")
        return Table.of(self.title, "optimum", tuple(map(Column, names)), tuple(rows), self.sentences)

    def to_data(self) -> dict[str, Json]:
        """Optimum as JSON data in SI and full precision."""
        return {
            "values": self.values,
            "active_bounds": self.active_bounds,
            "merit": self.merit,
            "before": {name: before.tolist() for name, before in self.before.items()},
            "after": {name: after.tolist() for name, after in self.after.items()},
            "violation": self.violation,
            "alternatives": [dict(design) for design in self.alternatives],
            "free_directions": self.free_directions,
            "disagreement": self.disagreement,
            "evaluations": int(self.history[-1, 0]),
            "converged": self.converged,
            "sentences": list(self.sentences),
        }


def _rows(values: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    return {name: row[None, :] for name, row in values.items()}
