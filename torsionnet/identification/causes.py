"""Usual causes of a misfit as additional unknowns of a fit (delay, gain, kind of damping, another value and so on)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Protocol, TypeAlias

import numpy as np

from torsionnet.base.errors import TorsionnetError
from torsionnet.base.expressions import Expression, Number
from torsionnet.identification.fit_problem import FitProblem, lay_out_problem
from torsionnet.identification.fit_search import SEARCH_RANGE_FACTOR, LeastSquaresSolution, relative_misfits
from torsionnet.identification.plan.fit_entries import Unknown
from torsionnet.identification.residuals.equation_block import EquationBlock
from torsionnet.identification.residuals.measurement import Measurement
from torsionnet.identification.residuals.measurement_block import MeasurementBlock
from torsionnet.identification.residuals.stepped_block import SteppedBlock
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.between_samples import NOTED_EFFECT, WAYS, Between
from torsionnet.machinery.excitations.engine_entries import EngineEntries
from torsionnet.machinery.excitations.excitation_numbers import numbers_by_name
from torsionnet.model.elements import Clearance, Damper, Element, Friction, Gear, HystereticSpring, Spring

AnySpring: TypeAlias = Spring | HystereticSpring
Change: TypeAlias = Callable[[AssembledModel], AssembledModel]
FREED_DIMENSIONS = ("inertia", "stiffness", "damping")
"""Dimensions of element fields that are tried as causes of a misfit (inertia, stiffness, damping)."""
FREED_FIELDS = ("ratio", "natural_frequency")
"""Names of element fields that are tried whatever their dimension: ratios of gears, frequencies of tuned dampers."""
REPLACED_FIELDS = {"hysteretic": "damping", "viscous": "loss_factor", "ratio": "teeth"}
"""Field of an element that each kind of cause replaces, the other kind of damping or the teeth behind a ratio."""

FIRST_FRICTION, FIRST_STAGE = 0.02, 0.1
"""Shares of the torque and of the stiffness of a test at which the search for friction or a stage left out begins."""

CHANNEL_CAUSES = ("delay", "gain", "reference_angle", "moving_inertia")
"""Names of the causes of a misfit that are unknowns of a measuring channel."""
BETWEEN = "between"
"""Kind, and name of the unknown, of a cause that is another course of the input between samples."""


@dataclass(frozen=True)
class Cause:
    """Possible cause of a misfit, one additional unknown of the model or of a measuring channel.

    Attributes
    ----------
    kind : {"delay", "gain", "reference_angle", "moving_inertia", "hysteretic", "viscous", "ratio", "value",
        "misfire", "gas_torque", "between", "friction", "stage"}
    unknown : str
        Name of the additional unknown: ``I_2``, ``dmf.loss_factor``, ``delay``, ``engine.misfire_share.4``. A course
        between samples frees none.
    element : str
        Name of the element whose kind of damping, or whose ratio made by teeth, is changed.
    part : str
        Part of a machine that the cause is in: ``cylinder 4 of engine``.
    between : str
        Course of the input between samples, held, straight or band_limited, in place of that supposed.
    also : tuple of str
        Further unknowns that come with it, as the gap beyond which a stage acts with its stiffness.
    begins : tuple of float
        Values in SI from which these are searched, of an element that the model lacks.
    """

    kind: str
    unknown: str
    element: str = ""
    part: str = ""
    between: str = ""
    also: tuple[str, ...] = ()
    begins: tuple[float, ...] = ()

    @property
    def is_of_channel(self) -> bool:
        """Whether the cause is in a measuring channel: a delay, gain or reference angle, a course between samples."""
        return self.unknown in (*CHANNEL_CAUSES, BETWEEN)

    def place(self, problem: FitProblem) -> str:
        """Name of what the cause is in: outputs or inputs of a channel's cause, a value, an element, a cylinder."""
        if not self.is_of_channel:
            return self.unknown if self.is_value else self.part or self.element
        return " and ".join(
            dict.fromkeys(block.driving if self.between else block.measurement.output for block in problem.blocks)
        )

    @property
    def is_value(self) -> bool:
        """Whether the cause is a wrong number in the model, ratios included."""
        return self.kind in ("value", "ratio")


def possible_causes(problem: FitProblem) -> tuple[Cause, ...]:
    """Causes of a misfit that can be tried in a fit, those that are not among its unknowns already."""
    free = {extra for block in problem.blocks for extra in block.extra}
    has_phases = any(block.line_orders is not None and block.has_phase for block in problem.blocks)
    asked = CHANNEL_CAUSES[: 3 if has_phases else 2]
    if any(isinstance(block, EquationBlock) and block.without_mass for block in problem.blocks):
        asked += ("moving_inertia",)
    channel = [Cause(name, name) for name in asked if name not in free]
    rigs = [block.response.drivetrain for block in problem.blocks]
    over_time = any(isinstance(block, EquationBlock) for block in problem.blocks)  # where a loss factor has no torque
    listed = [*_wrong_value_causes(rigs[0]), *_ratios(rigs[0]), *([] if over_time else _dampings(rigs[0]))]
    listed += (
        cause
        for block in problem.blocks
        if isinstance(block, SteppedBlock | EquationBlock)
        for cause in _left_out(block)
    )
    if any(block.line_orders is not None for block in problem.blocks):
        listed += [*_misfires(rigs[0]), *_amplitudes(rigs[0], has_phases=has_phases)]
    courses = [Cause(BETWEEN, BETWEEN, between=way) for way in WAYS if any(_runs_otherwise(way, problem))]
    named = dict.fromkeys(cause for cause in listed if cause.unknown not in problem.unknowns)
    return (*channel, *courses, *named)


def _runs_otherwise(between: Between, problem: FitProblem) -> Iterator[bool]:
    """Whether what drives would act otherwise with that course between samples, by more than 1 %."""
    for block in problem.blocks:
        if block.course is not None:
            top = block.frequencies[-1:]
            shares = replace(block.course, between=between).share(top) / block.course.share(top)
            yield bool(np.abs(shares - 1).max() > NOTED_EFFECT)


def _wrong_value_causes(rig: AssembledModel) -> Iterator[Cause]:
    """Causes of a misfit by a wrong inertia, stiffness, damping or ratio, a parameter or plain number of the model."""
    definition, seen = rig.definition, set()
    for element in definition.active:
        for field, (spec, value) in element.scalars().items():
            known = getattr(spec, "dimension", "") in FREED_DIMENSIONS or field in FREED_FIELDS
            if not known or not isinstance(value, Expression):
                continue
            for name in _leaves(value, definition.parameters) or [f"{element.name}.{field}"]:
                if name not in seen and (name in definition.parameters or isinstance(value, Number)):
                    seen.add(name)
                    yield Cause("value", name)


def _leaves(value: Expression, parameters: Mapping[str, Any]) -> list[str]:
    """Names of the parameters, given as plain numbers, on which an expression depends through others."""
    leaves: list[str] = []
    for name in sorted(value.names & parameters.keys()):
        inner = parameters[name].value
        leaves += [name] if isinstance(inner, Number) else _leaves(inner, parameters)
    return leaves


def _ratios(rig: AssembledModel) -> Iterator[Cause]:
    """Causes of a misfit by a wrong ratio of a gear that the model gives by teeth."""
    for element in rig.definition.active:
        if isinstance(element, Gear) and element.teeth is not None:
            yield Cause("ratio", f"{element.name}.ratio", element.name)


def _misfires(rig: AssembledModel) -> Iterator[Cause]:
    """Causes of a misfit by a cylinder that misfires in part, or gives another gas torque where none is motored."""
    for name, engine in rig.definition.excitations.items():
        if not isinstance(engine, EngineEntries) or not engine.enabled or engine.gas is None:
            continue
        silent = {*engine.gas_off, *(() if isinstance(engine.misfire, str) else engine.misfire)}
        kind, entry = ("misfire", "misfire_share") if engine.gas.has_motored else ("gas_torque", "factors")
        for number in engine.numbers:
            if number not in silent:
                yield Cause(kind, f"{name}.{entry}.{number}", part=f"cylinder {number} of {name}")


def _amplitudes(rig: AssembledModel, *, has_phases: bool) -> Iterator[Cause]:
    """Causes of a misfit by a wrong amplitude or phase of an order of a propeller or another given torque."""
    tables = (".orders.", ".blade_orders.")
    for name, excitation in rig.definition.excitations.items():
        for number in numbers_by_name(name, excitation) if excitation.enabled else ():
            if any(table in number.name for table in tables) and (has_phases or not number.is_phase):
                yield Cause("value", number.name)


def _left_out(block: SteppedBlock | EquationBlock) -> Iterator[Cause]:
    """Causes of a misfit at several amplitudes: values of the laws of motion, friction or a stage beside them."""
    curve = block.curve_of_steps if isinstance(block, SteppedBlock) else block.equation
    rig, name = curve.drivetrain, curve.elements[0]
    definition, ends = rig.definition, tuple(rig.definition.elements[name].ports.values())
    springs = [
        spring.name for spring in definition.active if spring.kind == "spring" and tuple(spring.ports.values()) == ends
    ]
    name = springs[0] if springs else name
    for element in curve.elements:
        for _, _, value, _ in definition.elements[element].expressions():
            yield from (Cause("value", leaf) for leaf in _leaves(value, definition.parameters))
    torque, twist, stiffness = block.typical
    if len(ends) == 2 and f"{name}_friction" not in definition.elements:
        yield Cause("friction", f"{name}_friction.torque", part=name, begins=(FIRST_FRICTION * torque,))
    if len(ends) == 2 and f"{name}_stage" not in definition.elements:
        # Contact beyond a gap beside the spring is one more stage, from half of the gap on.
        begins = FIRST_STAGE * stiffness, 2 * twist
        yield Cause("stage", f"{name}_stage.stiffness", part=name, also=(f"{name}_stage.gap",), begins=begins)


def _dampings(rig: AssembledModel) -> Iterator[Cause]:
    """Causes of a misfit by springs whose damping is hysteretic where the model has it viscous, or the reverse."""
    for element in rig.definition.active:
        if isinstance(element, Spring | HystereticSpring) and element.stiffness is not None:
            if _loss(element, rig):
                yield Cause("viscous", f"{element.name}.damping", element.name)
            elif _damping(element, rig):
                yield Cause("hysteretic", f"{element.name}.loss_factor", element.name)


def _loss(element: AnySpring, rig: AssembledModel) -> float:
    return _number(element.loss_factor, rig) if isinstance(element, HystereticSpring) else 0.0


def _damping(element: AnySpring, rig: AssembledModel) -> float:
    """Viscous damping of a spring and of all dampers in parallel with it, N m s/rad."""
    return sum(
        _number(given, rig) for given in (element.damping, *(damper.damping for damper in _beside(element, rig)))
    )


def _number(given: Any, rig: AssembledModel) -> float:
    """Value of an element field in SI, or 1 for a measure of damping, whose size does not matter here."""
    return float(given.evaluate(rig.exact_values)) if isinstance(given, Expression) else 1.0


def _beside(element: AnySpring, rig: AssembledModel) -> list[Damper]:
    ends = set(element.ports.values())
    return [
        element
        for element in rig.definition.active
        if isinstance(element, Damper) and set(element.ports.values()) == ends
    ]


def with_causes(problem: FitProblem, causes: Sequence[Cause], values: FloatArray, *, instead: bool) -> FitProblem:
    """Fit problem with causes as additional unknowns, which starts at the values given.

    Parameters
    ----------
    problem : FitProblem
    causes : sequence of Cause
    values : (n,) array
        Start values of the unknowns that ``problem`` has already.
    instead : bool
        Whether another kind of damping replaces the present one; otherwise it starts at 0 in addition to it.
    """
    more = [name for cause in causes if not cause.is_of_channel for name in (cause.unknown, *cause.also)]
    gone = {f"{cause.element}.{REPLACED_FIELDS[cause.kind]}" for cause in causes if cause.element and instead}
    flags: dict[str, Any] = {cause.unknown: cause.between or True for cause in causes if cause.is_of_channel}
    unknowns = {
        **{name: unknown for name, unknown in problem.unknowns.items() if name not in gone},
        **{name: Unknown() for name in more},
    }
    # Geometric mean of all frequencies, where the other damping starts as strong, c omega = k eta.
    top = np.exp(np.mean([np.log(block.frequencies).mean() for block in problem.blocks]))
    changes = [_change(cause, float(top), instead) for cause in causes if cause.element]
    changes += [partial(_with_left_out, cause=cause) for cause in causes if cause.begins]

    def changed(rig: AssembledModel) -> AssembledModel:
        for change in changes:
            rig = change(rig)
        return rig

    known = dict(zip(problem.names, values.tolist(), strict=True))
    rigs = {id(block.response.drivetrain): block.response.drivetrain for block in problem.blocks}
    rigs = {key: changed(rig) for key, rig in rigs.items()}
    blocks = [
        block.with_model(rigs[id(block.response.drivetrain)], _flagged(block, flags), tuple(unknowns))
        for block in problem.blocks
    ]
    with_them = lay_out_problem(problem.blocks[0].response.drivetrain, blocks, unknowns, known)
    idle = [name for name in unknowns if not _acts(with_them, name)] if instead and changes else []
    if not idle:
        return with_them
    kept = {name: unknown for name, unknown in unknowns.items() if name not in idle}
    blocks = [block.with_model(block.response.drivetrain, block.measurement, tuple(kept)) for block in blocks]
    return lay_out_problem(problem.blocks[0].response.drivetrain, blocks, kept, known)


def _flagged(block: MeasurementBlock, flags: Mapping[str, Any]) -> Measurement:
    """Measurement with the causes of its channel; only an input with samples has a course between them."""
    lacks = [] if block.course is not None else [BETWEEN]
    lacks += [] if block.measurement.equations else ["moving_inertia"]
    return replace(block.measurement, **{name: flag for name, flag in flags.items() if name not in lacks})


def _acts(problem: FitProblem, name: str) -> bool:
    columns = [index for index, entry in enumerate(problem.names) if entry.partition("[")[0] == name]
    return bool(np.any(problem.jacobian(problem.start)[:, columns]))


def _with_left_out(rig: AssembledModel, cause: Cause) -> AssembledModel:
    """Model with friction, or contact beyond a gap, beside an element of it."""
    ends = tuple(rig.definition.elements[cause.part].ports.values())
    new, _, _ = cause.unknown.rpartition(".")
    added: Element = (
        Friction.from_entries(new, nodes=ends, torque=cause.begins[0])
        if cause.kind == "friction"
        else Clearance.from_entries(new, nodes=ends, stiffness=cause.begins[0], gap=cause.begins[1])
    )
    return rig.with_definition(replace(rig.definition, elements={**rig.definition.elements, new: added}))


def _change(cause: Cause, frequency: float, instead: bool) -> Change:
    """Function that changes a model by a cause, to a spring with other damping or a gear with its ratio as a number.

    The new damping has the same loss at ``frequency`` (Hz), or starts at 0 beside the present one.
    """

    def change(rig: AssembledModel) -> AssembledModel:
        element = rig.definition.elements[cause.element]
        if isinstance(element, Gear):
            plainly = replace(element, ratio=Number(element.ratio_value(dict(rig.exact_values))), teeth=None)
            elements = {**rig.definition.elements, cause.element: plainly}
            return rig.with_definition(replace(rig.definition, elements=elements))
        assert isinstance(element, Spring | HystereticSpring)
        k, omega = _number(element.stiffness, rig), 2 * np.pi * frequency
        plain: dict[str, Any] = {"nodes": element.nodes, "stiffness": element.stiffness}
        elements = dict[str, Element](rig.definition.elements)
        if not instead and cause.kind == "hysteretic":
            elements[cause.element] = HystereticSpring.from_entries(
                cause.element, **plain, loss_factor=0, damping=element.damping
            )
        elif not instead:
            elements[cause.element] = replace(element, damping=Number(0))
        elif cause.kind == "hysteretic":
            loss = _damping(element, rig) * omega / k
            elements[cause.element] = HystereticSpring.from_entries(cause.element, **plain, loss_factor=loss)
            elements |= {damper.name: replace(damper, enabled=False) for damper in _beside(element, rig)}
        else:
            elements[cause.element] = Spring.from_entries(
                cause.element, **plain, damping=_loss(element, rig) * k / omega
            )
        return rig.with_definition(replace(rig.definition, elements=elements))

    return change


# Fits of a model with one more unknown each, and the rule which of these unknowns explain a misfit.

LEAST_MISFIT_REDUCTION = 0.8
"""Share of the sum of squared residuals that a freed cause must remove to count as an explanation of the misfit."""
START_FACTORS, GAIN_SIGNS = (1.0, 0.5, 2.0), (1.0, -1.0)
"""Multiples of a value in the model from which it is searched, as a resonance may lie in between, and start values of a
gain, as a channel may be reversed."""
EQUALLY_GOOD_RATIO = 1.5
"""Ratio of the sums of squared residuals left by two causes up to which both explain a misfit equally well."""
RANGE_END_FACTOR = 1e-3
"""Factor from the end of the search range within which a freed value has grown without bound."""

ROUGH_TOLERANCE = 1e-6
"""Relative change of cost, values and gradient at which the search with a cause freed ends at first: a cause that
explains nothing has a flat optimum, and most of its search would go into digits that nobody reads."""
SMALLEST_START = 1e-6
"""Start value in SI below which a freed value counts as 0 in the model, as of a shaft without damping."""
REFINED_RATIO = 2.0
"""Ratio to the sum of squares up to which a cause may count as an explanation, within which its search goes on to the
end."""


class Solve(Protocol):
    """Function that returns the local optimum of a fit problem found from start values."""

    def __call__(self, problem: FitProblem, start: FloatArray, tolerance: float = ..., /) -> LeastSquaresSolution: ...


@dataclass(frozen=True, eq=False)
class CauseFit:
    """Fit with one cause of a misfit freed, with its problem, the values at its optimum and the sum of squares left."""

    cause: Cause
    problem: FitProblem
    values: FloatArray
    sum_of_squares: float

    @property
    def criterion(self) -> float:
        """Akaike information criterion of the fit, the sum of squared residuals left plus 2 for each unknown."""
        return self.sum_of_squares + 2 * len(self.values)

    @property
    def misfit(self) -> float:
        """RMS of model minus test over RMS of the test, with the cause freed, over all measurements."""
        return overall_misfit(self.problem, self.values)

    @property
    def ended(self) -> bool:
        """Whether the fit drove the freed value without bound, so that the cause explains nothing."""
        mine = [name.partition("[")[0] == self.cause.unknown for name in self.problem.names]
        if not any(mine):
            return False
        begin, value = float(np.mean(self.problem.start[mine])), float(np.mean(self.values[mine]))
        return begin > 0 and abs(value / begin) >= RANGE_END_FACTOR * SEARCH_RANGE_FACTOR


def sum_of_squares(problem: FitProblem, values: FloatArray) -> float:
    """Sum of the squared weighted residuals of a fit problem at ``values`` of its unknowns."""
    return float(np.sum(problem.residuals(values) ** 2))


def overall_misfit(problem: FitProblem, values: FloatArray) -> float:
    """RMS of model minus test over RMS of the test, over all measurements of a fit problem, without unit."""
    return float(np.sqrt(np.mean(relative_misfits(problem, values) ** 2)))


def fit_causes(
    problem: FitProblem, causes: Sequence[Cause], starts: Sequence[FloatArray], solve: Solve, whole: float
) -> list[CauseFit]:
    """Best fit with each cause freed, of those from all start values, sorted with the best cause first.

    Causes that leave most of the sum of squares ``whole`` are not searched to the last digit.
    """
    best: dict[Cause, CauseFit] = {}
    tried = [
        _tried(problem, cause, start, solve, factor)
        for start in starts
        for cause in causes
        for factor in _factors(problem, cause)
    ]
    for cause_fit in sorted(
        (cause_fit for cause_fit in tried if cause_fit is not None), key=lambda cause_fit: cause_fit.criterion
    ):
        best.setdefault(cause_fit.cause, cause_fit)
    # After the rough search the exact one, where the cause may yet explain the misfit.
    most = REFINED_RATIO * (1 - LEAST_MISFIT_REDUCTION) * whole
    refined = [
        _refined(cause_fit, solve) if cause_fit.sum_of_squares <= most else cause_fit for cause_fit in best.values()
    ]
    return sorted(refined, key=lambda cause_fit: cause_fit.criterion)


def starts_of_causes(problem: FitProblem, values: FloatArray) -> list[FloatArray]:
    """Values (n,) from which causes are searched: those of the fit, and its start, as a wrong model leads far off."""
    led = problem.has_equations or np.array_equal(values, problem.start)
    return [values] if led else [values, problem.start]


def under_own_noise(cause_fit: CauseFit, solve: Solve) -> LeastSquaresSolution:
    """Optimum with a cause freed, weighed by the noise that it leaves itself."""
    cause_fit.problem.learn_noise(cause_fit.values)
    return solve(cause_fit.problem, cause_fit.values)


def _refined(cause_fit: CauseFit, solve: Solve) -> CauseFit:
    values = solve(cause_fit.problem, cause_fit.values).x
    return replace(cause_fit, values=values, sum_of_squares=sum_of_squares(cause_fit.problem, values))


def _factors(problem: FitProblem, cause: Cause) -> tuple[float, ...]:
    if cause.kind == "gain" and any(block.form != "magnitude" for block in problem.blocks):
        return GAIN_SIGNS
    far = cause.is_value and not (problem.has_records or problem.has_equations)
    return START_FACTORS if far else START_FACTORS[:1]


def _tried(problem: FitProblem, cause: Cause, start: FloatArray, solve: Solve, factor: float) -> CauseFit | None:
    """Fit with one cause freed, whose value starts ``factor`` times its own, or None if it cannot be calculated."""
    try:
        with_it = with_causes(problem, [cause], start, instead=True)
        begin = with_it.start.copy()
        places = [place for place, name in enumerate(with_it.names) if name.partition("[")[0] == cause.unknown]
        begin[places] *= factor
        begin = with_it.start_with_long_delays(begin)
        # A value that begins at 0, as damping, takes tiny steps at first, which a rough search takes for the end.
        from_zero = any(abs(begin[place]) < SMALLEST_START for place in places)
        values = (solve(with_it, begin) if from_zero else solve(with_it, begin, ROUGH_TOLERANCE)).x
        return CauseFit(cause, with_it, values, sum_of_squares(with_it, values))
    except (TorsionnetError, np.linalg.LinAlgError):
        return None  # what cannot be calculated explains nothing


def explaining_fits(tried: Sequence[CauseFit], whole: float) -> list[CauseFit]:
    """Fits with one cause freed that remove most of a misfit and leave about as little of it as the best of them.

    Parameters
    ----------
    tried : sequence of CauseFit
        The best first.
    whole : float
        Sum of squares with none of the causes freed.
    """
    sound = [
        cause_fit
        for cause_fit in tried
        if not cause_fit.ended and cause_fit.sum_of_squares <= (1 - LEAST_MISFIT_REDUCTION) * whole
    ]
    if not sound:
        return []
    least, rounding = sound[0], np.finfo(float).eps * whole
    noise = _noise(least.problem)

    def as_good(cause_fit: CauseFit) -> bool:
        alike = (
            cause_fit.sum_of_squares <= EQUALLY_GOOD_RATIO * least.sum_of_squares
            and cause_fit.misfit <= np.sqrt(EQUALLY_GOOD_RATIO) * least.misfit
        )
        return cause_fit is least or alike or cause_fit.sum_of_squares <= max(noise, rounding)

    return [cause_fit for cause_fit in sound if as_good(cause_fit)]


def _noise(problem: FitProblem) -> float:
    """Sum of squared weighted residuals to expect from the stated errors of all measurements, 0 if one states none."""
    stated = all(block.noise_is_stated for block in problem.blocks)
    return problem.effective_count if stated else 0.0
