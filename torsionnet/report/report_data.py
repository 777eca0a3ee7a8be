"""Data of a report, its configurations and the results that all its sections share."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from torsionnet.base.conventions import Conventions
from torsionnet.base.entries.spec import not_none
from torsionnet.base.errors import UsageError
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.table_range import TableReads
from torsionnet.linear.dynamic_stiffness.transfer_request import usable_channels
from torsionnet.linear.frequency_response import FloatArray, FrequencyResponse
from torsionnet.linear.modes.modes import Modes
from torsionnet.linear.responses.grid import Adaptive, vibration_range
from torsionnet.machinery.verdicts.margin_rules import PRESETS
from torsionnet.model.channels import Pair
from torsionnet.model.condition_titles import ConditionTitles
from torsionnet.model.configurations import label, parse_choice
from torsionnet.report.report_request import ReportRequest
from torsionnet.report.report_text import as_words

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.linear.assembly.assembled import AssembledModel
    from torsionnet.machinery.criticals.critical_speeds import CriticalSpeeds
    from torsionnet.machinery.holzer.holzer import CountedVibration
    from torsionnet.machinery.orders.order_line import OrderLine
    from torsionnet.machinery.orders.order_response import OrderResponse
    from torsionnet.machinery.verdicts.condition_peaks import ConditionPeaks, JudgedCritical
    from torsionnet.machinery.verdicts.limit_check import LimitCheck
    from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion
    from torsionnet.symbolic.symbolic_system import SymbolicSystem

MOST_CASES, MOST_JUDGED_CASES = 12, 200
"""Largest number of configurations in a report unless more are named, and of those whose limits are checked."""
MOST_MODES = 10
"""Largest number of modes that a report shows of each configuration."""
LARGE_MODEL = 40
"""Number of coordinates of a model from which on a report calculates only the lowest modes."""
MOST_SYMBOLIC = 12
"""Number of coordinates up to which a report writes equations in symbols, as longer ones could not be read."""
DEFAULT_PAIRS = 3
"""Number of sensors whose transfer functions a report shows unless others are asked for."""
MOST_OUTPUTS = 6
"""Largest number of outputs that a report shows over speed unless others are asked for."""
MOST_MARGINS = 3
"""Largest number of drivetrains with other modes whose separation margins a report shows."""
FEW_CASES = 3
"""Number of configurations up to which a report lists the modes and peaks of each one below the other; of more, a page
folds them away."""


@dataclass(frozen=True)
class Case:
    """Drivetrain in one configuration of a report, with the name of the configuration.

    The name is empty for the model as written. ``common`` are the names of several configurations that share the
    drivetrain; then its title is what they have in common.
    """

    configuration: str
    drivetrain: Drivetrain
    common: tuple[str, ...] = ()

    @cached_property
    def title(self) -> str:
        """Title of the configuration in documents, such as "misfire, full load"; empty for the model as written."""
        titles = ConditionTitles(self.drivetrain.definition.configurations)
        return titles.shared(self.common) if self.common else titles.of(self.configuration)


@dataclass(frozen=True, eq=False)
class SymbolicEquations:
    """Equations of motion in symbols, and the configurations of a report that have them in common."""

    cases: tuple[Case, ...]
    system: SymbolicSystem


@dataclass(frozen=True, eq=False)
class ReportData:
    """Drivetrain, configurations and shared results from which the sections of a report are made.

    Attributes
    ----------
    model : Drivetrain
        As written, with the parameters changed for this report.
    cases : tuple of Case
    request : ReportRequest
    file, digest : str
        Name of the model's file and its SHA-256; of a model that has no file, those of its text.
    inputs : tuple of (str, str)
        Names and SHA-256 of the files that the model names, as traces, catalogues and parts, and of measured orders.
    locked : mapping
        Clamp that keeps the shaft of the speeds from turning, by the name of each configuration left out for that.
    warning_messages : list of WarningMessage
        What the calculation warned of on the way.
    table_reads : TableReads
        Frequencies at which its sections read tables over frequency.
    """

    model: Drivetrain
    cases: tuple[Case, ...]
    request: ReportRequest
    file: str = ""
    digest: str = ""
    inputs: tuple[tuple[str, str], ...] = ()
    locked: Mapping[str, str] = field(default_factory=dict)
    warning_messages: list[warnings.WarningMessage] = field(default_factory=list)
    table_reads: TableReads = field(default_factory=TableReads)

    @property
    def conventions(self) -> Conventions:
        return Conventions(angle=self.request.plan.angle)

    @property
    def n_coordinates(self) -> int:
        """Largest number of coordinates of the drivetrain in any configuration of the report."""
        return max(case.drivetrain.assembly.system.n_coordinates for case in self.cases)

    @property
    def is_large(self) -> bool:
        return self.n_coordinates > LARGE_MODEL

    @cached_property
    def modes(self) -> tuple[Modes, ...]:
        """Modes of every configuration of the report, as far as they are shown."""
        return tuple(self._modes(case, None) for case in self.cases)

    def _modes(self, case: Case, measured: str | None, excitation: str | None = None) -> Modes:
        lowest = MOST_MODES if self.is_large and measured is None else None
        modes = case.drivetrain.modes(measured_input=measured, driven_by=excitation, lowest=lowest)
        return modes.first(MOST_MODES) if len(modes) > MOST_MODES else modes

    def cut_modes(self, pair: Pair) -> tuple[Modes, ...] | None:
        """Poles of a transfer function over a measured input, of every configuration of the report.

        None for other inputs and large models.
        """
        sensors = self.cases[0].drivetrain.sensors
        if pair.input not in sensors or self.is_large:
            return None
        return tuple(self._modes(case, pair.input, pair.excitation or None) for case in self.cases)

    @cached_property
    def symbolic_equations(self) -> tuple[SymbolicEquations, ...]:
        """Equations of motion in symbols, with the configurations of the report that share them.

        Cases with the same equations are put together.
        """
        systems: list[tuple[list[Case], SymbolicSystem]] = []
        for case in self.cases:
            alike = next((cases for cases, _ in systems if _same_structure(case.drivetrain, cases[0].drivetrain)), None)
            if alike is not None:
                alike.append(case)
                continue
            system = case.drivetrain.symbolic()
            alike = next((cases for cases, other in systems if _alike(system, other)), None)
            if alike is None:
                systems.append(([case], system))
            else:
                alike.append(case)
        return tuple(SymbolicEquations(tuple(cases), system) for cases, system in systems)

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """Transfer functions that the report shows: those asked for, else the first sensors over the first input."""
        if self.request.pairs:
            return self.request.pairs
        inputs, sensors = usable_channels(self.cases[0].drivetrain)
        return tuple(Pair(sensor, driven) for driven in inputs[:1] for sensor in sensors[:DEFAULT_PAIRS])

    @cached_property
    def has_excitations(self) -> bool:
        """Whether the model has excitations and a range of speeds."""
        definition = self.model.definition
        return definition.speeds is not None and bool(definition.excitations)

    @cached_property
    def order_outputs(self) -> tuple[str, ...]:
        """Names of the outputs that the report shows over speed: those asked for, else the sensors of torque."""
        sensors = self.model.sensors
        torques = [name for name, sensor in sensors.items() if sensor.quantity == "torque"]
        return self.request.plan.orders or tuple(torques or sensors)[:MOST_OUTPUTS]

    @cached_property
    def order_responses(self) -> tuple[OrderResponse, ...]:
        """Response by order of every configuration of the report, over its speeds."""
        return tuple(case.drivetrain.order_response(list(self.order_outputs), refine=True) for case in self.cases)

    @cached_property
    def judged_cases(self) -> tuple[Case, ...]:
        """Configurations whose limits the report checks.

        All configurations, also those not shown, unless some were asked for.
        """
        if self.request.plan.configurations or not self.left_out:
            return self.cases
        known = {case.configuration: case for case in self.cases}
        plan = self.request.plan
        names = ordered_configurations(self.model, plan.kind, plan.normal)[:MOST_JUDGED_CASES]
        cases = tuple(known.get(name) or Case(name, self.model.configured(name)) for name in names)
        return tuple(case for case in cases if not locking_clamp_of(case)) or cases

    @cached_property
    def turning(self) -> ReportData:
        """Copy of the report's data without configurations in which the shaft of the speeds is locked.

        The same data where all or none of them are.
        """
        if not self.has_excitations:
            return self
        locked = {case.configuration: clamp for case in self.cases if (clamp := locking_clamp_of(case))}
        if not 0 < len(locked) < len(self.cases):
            return self
        return replace(
            self, cases=tuple(case for case in self.cases if case.configuration not in locked), locked=locked
        )

    @cached_property
    def normal_case(self) -> Case:
        """Normal condition at rated load, with which every section begins; of conditions without it the first one."""
        normal = normal_choice(self.model, self.request.plan.normal)
        axes = self.model.definition.configurations
        choices = ((case, parse_choice(case.configuration, axes)) for case in self.judged_cases if case.configuration)
        return next((case for case, choice in choices if choice.items() <= normal.items()), self.judged_cases[0])

    @cached_property
    def titles(self) -> ConditionTitles:
        """Titles of the model's configurations in documents."""
        return ConditionTitles(self.model.definition.configurations)

    @cached_property
    def left_out(self) -> tuple[str, ...]:
        """Names of the model's configurations that the report does not show."""
        others = [set(case.drivetrain.other_configurations) for case in self.cases]
        return tuple(name for name in self.model.configurations if all(name in missing for missing in others))

    @property
    def coverage_note(self) -> tuple[str, ...]:
        """Sentence on how many of the model's configurations a section of the report is about.

        Empty where it is about all.
        """
        if not self.left_out:
            return ()
        return (
            phrase(
                " Of {all} configurations {count} are examined here.",
                all=len(self.model.configurations),
                count=len(self.cases),
            ),
            *self.locked_notes,
        )

    @property
    def locked_notes(self) -> Iterator[str]:
        """Sentences on configurations whose shaft of the speeds is locked, so that it has no orders."""
        speeds = self.model.definition.speeds
        for name, clamp in self.locked.items() if speeds else ():
            shaft, title = as_words(not_none(speeds).of), self.titles.of(name)
            text = " Not in {condition}: {shaft} is locked by {clamp} there and has no orders."
            yield phrase(text, condition=title, shaft=shaft, clamp=as_words(clamp))

    @cached_property
    def limit_conclusion(self) -> LimitConclusion | None:
        """Verdicts on the limits in all configurations that are judged; None where the model has no limits."""
        if not self.has_excitations or not self.model.definition.limits:
            return None
        from torsionnet.machinery.verdicts.limit_conclusion import LimitConclusion

        return LimitConclusion(tuple(case.drivetrain.check_limits() for case in self.judged_cases), self.titles)

    def judged_case(self, check: LimitCheck) -> Case:
        """Configuration of the report that a check of its limits is about."""
        return next(case for case in self.judged_cases if case.drivetrain.configuration == check.configuration)

    @cached_property
    def normal_peaks(self) -> ConditionPeaks | None:
        """Critical speeds and peaks of all orders of note in the normal condition; None for a model without limits."""
        if self.limit_conclusion is None:
            return None
        normal = self.normal_case.drivetrain.configuration
        check = next(judged for judged in self.limit_conclusion.checks if judged.configuration == normal)
        from torsionnet.machinery.verdicts.order_peaks import SMALL_SHARE, order_shares

        shares = zip(check.lines, order_shares(check).tolist(), strict=True)
        return self._peaks(check, [line for line, share in shares if share >= SMALL_SHARE], refine=True)

    @cached_property
    def further_peaks(self) -> tuple[ConditionPeaks, ...]:
        """Critical speeds and peaks of other conditions, of the orders that matter there and differ from the normal."""
        from torsionnet.machinery.verdicts.order_peaks import differing_lines

        if self.normal_peaks is None or self.limit_conclusion is None:
            return ()
        normal = self.normal_peaks.check
        checks = [normal, *(check for check in self.limit_conclusion.checks if check is not normal)]
        wanted = differing_lines(checks)
        return tuple(self._peaks(checks[place], lines, refine=False) for place, lines in wanted.items())

    @property
    def critical_records(self) -> tuple[JudgedCritical, ...]:
        """Critical speeds of the normal condition and of further ones, as far as they matter there."""
        normal = () if self.normal_peaks is None else self.normal_peaks.criticals
        return (*normal, *(record for peaks in self.further_peaks for record in peaks.criticals))

    def _peaks(self, check: LimitCheck, lines: Sequence[str], *, refine: bool) -> ConditionPeaks:
        from torsionnet.machinery.criticals.critical_speed_search import excited_lines
        from torsionnet.machinery.orders.refined_response import is_periodic
        from torsionnet.machinery.verdicts.condition_peaks import condition_peaks

        drivetrain, speeds = self.judged_case(check).drivetrain, self.model.definition.speeds
        if is_periodic(drivetrain, None):
            # Orders that the motion makes itself meet no mode: there only those that excite count.
            excited = excited_lines(drivetrain, None, None, None)[0].values()
            lines = [str(line) for group in excited for line in group]
        criticals = drivetrain.critical_speeds(lines=lines)
        return condition_peaks(drivetrain, check, criticals, speeds.rated if speeds else None, refine=refine)

    @cached_property
    def free_end_response(self) -> OrderResponse:
        """Response by order of the angle at the free end of the engine, in the normal condition."""
        from torsionnet.report.measured_orders import free_end

        drivetrain = self.normal_case.drivetrain
        return drivetrain.order_response(free_end(drivetrain.definition), refine=True)

    @cached_property
    def by_drivetrain(self) -> ReportData:
        """Copy of the report's data in which all configurations that differ in excitations alone are one.

        They have the same modes.
        """
        if len(self.distinct_drivetrains) == len(self.cases):
            return self
        cases = (
            replace(alike[0], common=tuple(case.configuration for case in alike)) for alike in self.distinct_drivetrains
        )
        return replace(self, cases=tuple(cases))

    @cached_property
    def distinct_drivetrains(self) -> tuple[tuple[Case, ...], ...]:
        """Configurations of the report, grouped by equal drivetrains: those of a group differ in excitations alone."""
        return _by_drivetrain(self.cases)

    @cached_property
    def separation_margins(self) -> tuple[tuple[tuple[Case, ...], CriticalSpeeds], ...]:
        """Separation margins of the first drivetrains with other modes, each with its configurations.

        Empty unless the report's ``rules`` name a rule of separation margins and the model has speeds.
        """
        rule = self.request.plan.rules
        if rule is None or rule not in PRESETS or self.model.definition.speeds is None:
            return ()
        from torsionnet.machinery.verdicts.shaft_margins import shaft_margins

        groups = self.distinct_drivetrains[:MOST_MARGINS]
        return tuple((cases, shaft_margins(cases[0].drivetrain, rule)) for cases in groups)

    @cached_property
    def judged_drivetrains(self) -> tuple[tuple[Case, ...], ...]:
        """Configurations whose limits the report checks, grouped by equal drivetrains."""
        return _by_drivetrain(self.judged_cases)

    @cached_property
    def natural_frequencies(self) -> tuple[tuple[CountedVibration, ...], ...]:
        """Natural frequencies in Hz of each of ``judged_drivetrains``, with the mode numbers of the whole document.

        Nodes with an imposed motion are held, as in the response to the excitations.
        """
        from torsionnet.machinery.holzer.holzer import natural_frequencies

        return tuple(natural_frequencies(held_drivetrain(cases[0])) for cases in self.judged_drivetrains)

    @cached_property
    def excited_modes(self) -> tuple[int, ...]:
        """Numbers of the first drivetrain's modes below the highest excitation frequency; at least the lowest one."""
        rows, line = self.natural_frequencies[0], self.highest_line
        modes = tuple(row.mode for row in rows if line and row.lowest <= line[1])
        return modes or tuple(row.mode for row in rows[:1])

    @cached_property
    def highest_line(self) -> tuple[OrderLine, float] | None:
        """Order line with the highest frequency in the range of speeds, and this frequency in Hz.

        None where nothing acts.
        """
        from torsionnet.machinery.criticals.critical_speed_search import excited_frequencies, excited_lines

        lines_with_frequency = []
        for case in self.turning.cases:
            if any(excitation.enabled for excitation in case.drivetrain.definition.excitations.values()):
                lines, _, speeds = excited_lines(case.drivetrain, None, None, None)
                lines_with_frequency += [
                    (line, excited_frequencies(line, speeds)[1]) for group in lines.values() for line in group
                ]
        return max(lines_with_frequency, key=lambda pair: pair[1], default=None)

    @cached_property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency of the report's responses in Hz."""
        return self.request.plan.band or vibration_range(*self.modes)

    @cached_property
    def _known(self) -> dict[Pair, tuple[FrequencyResponse, ...]]:
        return {}

    def responses(self, pair: Pair) -> tuple[FrequencyResponse, ...]:
        """Frequency response of every configuration of the report, at as many frequencies as its peaks need."""
        if pair not in self._known:
            trios = zip(self.cases, self.modes, strict=True)
            self._known[pair] = tuple(self._response(case, pair, modes) for case, modes in trios)
        return self._known[pair]

    def for_pair(self, pair: Pair) -> ReportData:
        """Copy of the data with only the configurations that have the output and input of a transfer function."""
        kept = tuple(case for case in self.cases if self.why_left_out(case, pair) is None)
        if len(kept) in (0, len(self.cases)):
            return self
        names = tuple(case.configuration for case in kept)
        return self._parts.setdefault(names, replace(self, cases=kept))

    @cached_property
    def _parts(self) -> dict[tuple[str, ...], ReportData]:
        return {}

    def why_left_out(self, case: Case, pair: Pair) -> UsageError | None:
        """Error that says why a configuration lacks the transfer function; None where it has."""
        try:
            self.solver(case, pair)(Adaptive(1, 2, 2, 1).frequencies())
        except UsageError as error:
            return error
        return None

    def _response(self, case: Case, pair: Pair, modes: Modes) -> FrequencyResponse:
        """Frequency response of one configuration between an output and an input.

        Of an undamped one on a plain grid, as its peaks have no height.
        """
        grid = Adaptive(*self.band, points=160, per_peak=21) if is_damped(case) else Adaptive(*self.band, 600, 1)
        return self.solver(case, pair)(grid.frequencies(*([modes] if is_damped(case) else [])))

    def solver(self, case: Case, pair: Pair) -> Callable[[FloatArray], FrequencyResponse]:
        """Function that gives the frequency response of a configuration at frequencies in Hz."""

        def solve(frequencies: FloatArray) -> FrequencyResponse:
            return case.drivetrain.frequency_response(
                pair.output, pair.input, frequencies, driven_by=pair.excitation or None
            )

        return solve


def titles_of(cases: Sequence[Case]) -> str:
    """Text with the titles of configurations, separated by semicolons where a title has a comma itself."""
    return ("; " if any(", " in case.title for case in cases) else ", ").join(case.title for case in cases)


def _by_drivetrain(cases: Sequence[Case]) -> tuple[tuple[Case, ...], ...]:
    """Configurations in groups of equal drivetrains."""
    groups: list[list[Case]] = []
    for case in cases:
        alike = next((group for group in groups if _vibrate_alike(case.drivetrain, group[0].drivetrain)), None)
        if alike is None:
            groups.append([case])
        else:
            alike.append(case)
    return tuple(map(tuple, groups))


def held_drivetrain(case: Case) -> AssembledModel:
    """Drivetrain of a configuration in which nodes with an imposed motion are held, as vibrations are counted in it."""
    from torsionnet.machinery.orders.order_solution import with_motions_held

    acting = {
        name: excitation for name, excitation in case.drivetrain.definition.excitations.items() if excitation.enabled
    }
    return with_motions_held(case.drivetrain, acting)


def locking_clamp_of(case: Case) -> str:
    """Name of the clamp that keeps the shaft of the speeds from turning in a configuration; empty where none does."""
    from torsionnet.machinery.orders.operating_groups import cached_locking_clamp

    speeds = case.drivetrain.definition.speeds
    return "" if speeds is None else cached_locking_clamp(case.drivetrain, speeds.of)


def is_damped(case: Case) -> bool:
    """Whether a drivetrain has any damping."""
    system = case.drivetrain.assembly.system
    return bool(system.dynamic) or bool((system.damping > 0).any())


def _alike(system: SymbolicSystem, other: SymbolicSystem) -> bool:
    same = (system.coordinates, system.nodes, system.inputs) == (other.coordinates, other.nodes, other.inputs)
    return same and all(getattr(system, key) == getattr(other, key) for key in ("M", "C", "K", "H", "tables", "T"))


def _same_structure(rig: Drivetrain, other: Drivetrain) -> bool:
    """Whether two configurations differ in values only, none of which makes a term vanish: one formula serves both."""
    if rig.definition.active != other.definition.active or _derived(rig) != _derived(other):
        return False
    pairs = ((rig.assembly.T, other.assembly.T), (rig.assembly.system.rows, other.assembly.system.rows))
    return all(np.array_equal(mine != 0, theirs != 0) for mine, theirs in pairs)


def _vibrate_alike(rig: Drivetrain, other: Drivetrain) -> bool:
    """Whether two configurations have the same laws and ratios, so that they differ in excitations alone."""
    mine, theirs = rig.assembly, other.assembly
    if (mine.nodes, mine.laws, mine.exact_rows) != (theirs.nodes, theirs.laws, theirs.exact_rows):
        return False
    same_point = rig.definition.operating_point == other.definition.operating_point
    return same_point and mine.node_rows.maps == theirs.node_rows.maps


def _derived(rig: Drivetrain) -> dict[str, str]:
    """Text of every parameter that is an expression of other parameters, by name."""
    return {name: str(entry.value) for name, entry in rig.parameter_definitions.items() if entry.value.names}


def document_kind(model: Drivetrain) -> str:
    """Kind of document that a model has unless another is asked for.

    The calculation for approval where speeds, excitations and limits are given, else the report on a rig.
    """
    definition = model.definition
    return "approval" if definition.speeds is not None and definition.excitations and definition.limits else "rig"


def normal_choice(model: Drivetrain, named: str = "") -> dict[str, str]:
    """Alternative on each axis that makes up the normal condition at rated load: the one named, else the first one.

    Examples
    --------
    >>> import torsionnet as tn
    >>> normal_choice(tn.load("marine_medium_speed"), "water=wet")
    {'water': 'wet', 'coupling': 'nominal', 'firing': 'normal'}
    """
    first = {axis: names[0] for axis, names in model.axes.items() if names}
    return first | (parse_choice(named, model.definition.configurations) if named else {})


def ordered_configurations(model: Drivetrain, kind: str | None, normal: str = "") -> tuple[str, ...]:
    """Names of the model's configurations in the order of a report.

    A calculation for approval begins with the normal condition at rated load.
    """
    names = model.configurations
    if kind != "approval" or not names:
        return names
    first = label(normal_choice(model, normal), model.definition.configurations)
    return (first, *(name for name in names if name != first))


def cases_of(model: Drivetrain, names: tuple[str, ...], kind: str | None = None, normal: str = "") -> tuple[Case, ...]:
    """Configurations of a model that a report shows, each with its drivetrain.

    The model in these configurations, else in all it has, else as it is.
    """
    if model.configuration and not names:
        return (Case(model.configuration, model),)
    chosen = names or ordered_configurations(model, kind, normal)[:MOST_CASES]
    if not chosen:
        return (Case("", model),)
    rigs = [model.configured(name) for name in chosen]
    cases = {rig.configuration: Case(rig.configuration, rig) for rig in rigs}
    return tuple(cases.values())


def digest_of(data: bytes) -> str:
    """SHA-256 of data as text in hexadecimal digits."""
    return hashlib.sha256(data).hexdigest()


def require_answers(subject: ReportData) -> None:
    """Refuse transfer functions that no configuration has, before anything of the report is written.

    Raises
    ------
    UsageError
        With all of them.
    """
    refusals_by_pair = {}
    for pair in subject.pairs:
        refusals = [refusal for case in subject.cases if (refusal := subject.why_left_out(case, pair)) is not None]
        if refusals and len(refusals) == len(subject.cases):
            refusals_by_pair[f"{pair}: {refusals[0]}"] = refusals[0].kind
    if refusals_by_pair:
        raise UsageError("\n".join(refusals_by_pair), kind=next(iter(refusals_by_pair.values())))
