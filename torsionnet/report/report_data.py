"""What a report is about: a drivetrain in its configurations, and what is calculated from it once for all sections."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.model.report import Pair
from torsionnet.report.report_request import ReportRequest
from torsionnet.report.report_text import shared_choices
from torsionnet.response import Conventions, FrequencyResponse, Modes
from torsionnet.solve.dynamic_stiffness.transfer_request import usable_channels
from torsionnet.solve.responses.grid import Adaptive, vibration_range

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.response.frequency_response import FloatArray
    from torsionnet.response.limit_conclusion import LimitConclusion
    from torsionnet.response.order_response import OrderResponse
    from torsionnet.symbolic.symbolic_system import SymbolicSystem

MOST_CASES, MOST_JUDGED_CASES = 12, 200
"""Configurations in a report unless more are asked for by name, and those whose limits are judged."""
MOST_MODES = 10
LARGE_MODEL = 40
"""Coordinates from which on only the lowest modes are calculated."""
MOST_SYMBOLIC = 12
"""Coordinates of a system whose equations are written out."""
DEFAULT_PAIRS = 3
MOST_OUTPUTS = 6
"""Outputs shown over speed unless others are asked for."""
FEW_CASES = 3
"""Configurations whose modes and peaks are all listed one below the other; of more, a page folds them away."""


@dataclass(frozen=True)
class Case:
    """A drivetrain and the name of its configuration, empty for the model as written."""

    configuration: str
    drivetrain: Drivetrain


@dataclass(frozen=True, eq=False)
class SymbolicEquations:
    """Equations in symbols, and the cases they hold for."""

    cases: tuple[Case, ...]
    system: SymbolicSystem


@dataclass(frozen=True, eq=False)
class ReportData:
    """A drivetrain as the sections of a report see it.

    Attributes
    ----------
    model : Drivetrain
        As written, with the parameters changed for this report.
    cases : tuple of Case
    request : ReportRequest
    file, digest : str
        Name of the model's file and its SHA-256; of a model that has no file, those of its text.
    warning_messages : list of WarningMessage
        What the calculation warned of on the way.
    """

    model: Drivetrain
    cases: tuple[Case, ...]
    request: ReportRequest
    file: str = ""
    digest: str = ""
    warning_messages: list[warnings.WarningMessage] = field(default_factory=list)

    @property
    def conventions(self) -> Conventions:
        return Conventions(angle=self.request.plan.angle)

    @property
    def n_coordinates(self) -> int:
        """Coordinates."""
        return max(case.drivetrain.assembly.system.n_coordinates for case in self.cases)

    @property
    def is_large(self) -> bool:
        return self.n_coordinates > LARGE_MODEL

    @cached_property
    def modes(self) -> tuple[Modes, ...]:
        """The modes shown of every case."""
        return tuple(self._modes(case, None) for case in self.cases)

    def _modes(self, case: Case, measured: str | None, excitation: str | None = None) -> Modes:
        lowest = MOST_MODES if self.is_large and measured is None else None
        found = case.drivetrain.modes(measured_input=measured, excitation=excitation, lowest=lowest)
        return found.first(MOST_MODES) if len(found) > MOST_MODES else found

    def cut_modes(self, pair: Pair) -> tuple[Modes, ...] | None:
        """Poles of a transfer function against a measured input, None if the input is none or they are too many."""
        sensors = self.cases[0].drivetrain.sensors
        if pair.input not in sensors or self.is_large:
            return None
        return tuple(self._modes(case, pair.input, pair.excitation or None) for case in self.cases)

    @cached_property
    def symbolic_equations(self) -> tuple[SymbolicEquations, ...]:
        """The equations in symbols: cases with the same ones together."""
        found: list[tuple[list[Case], SymbolicSystem]] = []
        for case in self.cases:
            alike = next((cases for cases, _ in found if _same_structure(case.drivetrain, cases[0].drivetrain)), None)
            if alike is not None:
                alike.append(case)
                continue
            system = case.drivetrain.symbolic()
            alike = next((cases for cases, other in found if _alike(system, other)), None)
            if alike is None:
                found.append(([case], system))
            else:
                alike.append(case)
        return tuple(SymbolicEquations(tuple(cases), system) for cases, system in found)

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """The transfer functions asked for; else the first sensors over the first input."""
        if self.request.pairs:
            return self.request.pairs
        inputs, sensors = usable_channels(self.cases[0].drivetrain)
        return tuple(Pair(sensor, driven) for driven in inputs[:1] for sensor in sensors[:DEFAULT_PAIRS])

    @cached_property
    def has_excitations(self) -> bool:
        """Whether machinery runs in the model, over speeds that it names."""
        definition = self.model.definition
        return definition.speeds is not None and bool(definition.excitations)

    @cached_property
    def order_outputs(self) -> tuple[str, ...]:
        """What is shown over speed: as asked for, else the sensors of torque."""
        sensors = self.model.sensors
        torques = [name for name, sensor in sensors.items() if sensor.quantity == "torque"]
        return self.request.plan.orders or tuple(torques or sensors)[:MOST_OUTPUTS]

    @cached_property
    def order_responses(self) -> tuple[OrderResponse, ...]:
        """Of every case."""
        return tuple(case.drivetrain.order_response(list(self.order_outputs), refine=True) for case in self.cases)

    @cached_property
    def judged_cases(self) -> tuple[Case, ...]:
        """What verdicts are drawn from: all configurations, also those not shown; those asked for where some were."""
        if self.request.plan.configurations or not self.left_out:
            return self.cases
        known = {case.configuration: case for case in self.cases}
        names = self.model.configurations[:MOST_JUDGED_CASES]
        return tuple(known.get(name) or Case(name, self.model.configured(name)) for name in names)

    @cached_property
    def left_out(self) -> tuple[str, ...]:
        """Configurations of the model that are no case of this report."""
        others = [set(case.drivetrain.other_configurations) for case in self.cases]
        return tuple(name for name in self.model.configurations if all(name in missing for missing in others))

    @property
    def coverage_note(self) -> tuple[str, ...]:
        """A sentence on how many configurations a section is about, where those are not all."""
        if not self.left_out:
            return ()
        return (f" Of {len(self.model.configurations)} configurations {len(self.cases)} are examined here.",)

    @cached_property
    def limit_conclusion(self) -> LimitConclusion | None:
        """Verdicts on the limits in all configurations; None where the model has no limits."""
        if not self.has_excitations or not self.model.definition.limits:
            return None
        from torsionnet.response.limit_conclusion import LimitConclusion

        return LimitConclusion(tuple(case.drivetrain.check_limits() for case in self.judged_cases))

    @cached_property
    def by_drivetrain(self) -> ReportData:
        """The same with one case for all that differ by nothing but what runs: they have the same modes."""
        if len(self.distinct_drivetrains) == len(self.cases):
            return self
        cases = (
            Case(shared_choices([case.configuration for case in alike]), alike[0].drivetrain)
            for alike in self.distinct_drivetrains
        )
        return replace(self, cases=tuple(cases))

    @cached_property
    def distinct_drivetrains(self) -> tuple[tuple[Case, ...], ...]:
        """Cases by what vibrates: those that differ by nothing but what runs are one."""
        found: list[list[Case]] = []
        for case in self.cases:
            alike = next((cases for cases in found if _vibrate_alike(case.drivetrain, cases[0].drivetrain)), None)
            if alike is None:
                found.append([case])
            else:
                alike.append(case)
        return tuple(map(tuple, found))

    @cached_property
    def band(self) -> tuple[float, float]:
        """Hz."""
        return self.request.plan.band or vibration_range(*self.modes)

    @cached_property
    def _known(self) -> dict[Pair, tuple[FrequencyResponse, ...]]:
        return {}

    def responses(self, pair: Pair) -> tuple[FrequencyResponse, ...]:
        """Of every case, with as many frequencies as its peaks need."""
        if pair not in self._known:
            trios = zip(self.cases, self.modes, strict=True)
            self._known[pair] = tuple(self._response(case, pair, modes) for case, modes in trios)
        return self._known[pair]

    def for_pair(self, pair: Pair) -> ReportData:
        """The same, for the configurations that have what the transfer function is about."""
        kept = tuple(case for case in self.cases if self.refusal(case, pair) is None)
        if len(kept) in (0, len(self.cases)):
            return self
        names = tuple(case.configuration for case in kept)
        return self._parts.setdefault(names, replace(self, cases=kept))

    @cached_property
    def _parts(self) -> dict[tuple[str, ...], ReportData]:
        return {}

    def refusal(self, case: Case, pair: Pair) -> UsageError | None:
        """Why a case has no such transfer function: a name nobody has, or one that is switched off."""
        try:
            self.solver(case, pair)(Adaptive(1, 2, 2, 1).frequencies())
        except UsageError as error:
            return error
        return None

    def _response(self, case: Case, pair: Pair, modes: Modes) -> FrequencyResponse:
        """Undamped peaks are unbounded: nothing is gained by going near them."""
        grid = Adaptive(*self.band, points=160, per_peak=21) if is_damped(case) else Adaptive(*self.band, 600, 1)
        return self.solver(case, pair)(grid.frequencies(*([modes] if is_damped(case) else [])))

    def solver(self, case: Case, pair: Pair) -> Callable[[FloatArray], FrequencyResponse]:
        """The response of a case at frequencies in Hz."""

        def solve(frequencies: FloatArray) -> FrequencyResponse:
            return case.drivetrain.frequency_response(
                pair.output, pair.input, frequencies, excitation=pair.excitation or None
            )

        return solve


def is_damped(case: Case) -> bool:
    """Whether anything takes energy out."""
    system = case.drivetrain.assembly.system
    return bool(system.dynamic) or bool((system.damping > 0).any())


def _alike(system: SymbolicSystem, other: SymbolicSystem) -> bool:
    same = (system.coordinates, system.nodes, system.inputs) == (other.coordinates, other.nodes, other.inputs)
    return same and all(getattr(system, key) == getattr(other, key) for key in ("M", "C", "K", "H", "tables", "T"))


def _same_structure(rig: Drivetrain, other: Drivetrain) -> bool:
    """Whether two configurations differ by values only, and by none that makes a term vanish: one formula does."""
    if rig.definition.active != other.definition.active or _derived(rig) != _derived(other):
        return False
    pairs = ((rig.assembly.T, other.assembly.T), (rig.assembly.system.rows, other.assembly.system.rows))
    return all(np.array_equal(one != 0, two != 0) for one, two in pairs)


def _vibrate_alike(rig: Drivetrain, other: Drivetrain) -> bool:
    """Whether two configurations have the same laws and ratios, so that they differ by what runs alone."""
    one, two = rig.assembly, other.assembly
    if (one.nodes, one.laws, one.exact_rows) != (two.nodes, two.laws, two.exact_rows):
        return False
    return (
        one.node_rows.maps == two.node_rows.maps and rig.definition.operating_point == other.definition.operating_point
    )


def _derived(rig: Drivetrain) -> dict[str, str]:
    """Parameters that are expressions of others."""
    return {name: str(entry.value) for name, entry in rig.parameter_definitions.items() if entry.value.names}


def cases_of(model: Drivetrain, names: tuple[str, ...]) -> tuple[Case, ...]:
    """The model in these configurations, else in all it has, else as it is."""
    if model.configuration and not names:
        return (Case(model.configuration, model),)
    chosen = names or model.configurations[:MOST_CASES]
    if not chosen:
        return (Case("", model),)
    found = [model.configured(name) for name in chosen]
    cases = {rig.configuration: Case(rig.configuration, rig) for rig in found}
    return tuple(cases.values())


def digest_of(data: bytes) -> str:
    """SHA-256 in hexadecimal digits."""
    return hashlib.sha256(data).hexdigest()


def require_answers(subject: ReportData) -> None:
    """Ask every transfer function once, so that a wrong name is told before anything is written.

    Raises
    ------
    UsageError
        With all of them.
    """
    found = []
    for pair in subject.pairs:
        refusals = [subject.refusal(case, pair) for case in subject.cases]
        if all(refusals):
            found.append(f"{pair}: {refusals[0]}")
    if found:
        raise UsageError("\n".join(found))
